//! The settings of a board, as an upload has them.

use serde::{Deserialize, Serialize};

use super::packet::AXES;
use crate::config::{AxisSettings, Rates};

/// The settings of the controller on a board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoardSettings {
    /// Rates of the loops; the tick rate has to be that of the board.
    pub rates: Rates,
    /// Axes.
    pub axes: [AxisSettings; AXES],
}
