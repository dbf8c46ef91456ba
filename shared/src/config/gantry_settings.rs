//! A gantry: two motors, one at each end of a beam, with one command.
//!
//! Each motor is an axis with loops, limits and compensation of its own. The axis of the second motor names that of the first, and has
//! the command of that axis. Skew is the position of the second less that of the first, on a square beam 0.

use serde::{Deserialize, Serialize};

/// The settings of the second motor of a gantry.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GantrySettings {
    /// Axis of the first motor, counted from 0.
    pub first: u8,
    /// Greatest skew, m, above 0 and at most [`GantrySettings::MOST_SKEW_M`]: beyond it the drives go off.
    pub skew_limit_m: f64,
    /// Position of the reference of the second motor less that of the first on a square beam, m, at most
    /// [`GantrySettings::MOST_OFFSET_M`] in either direction.
    pub reference_offset_m: f64,
}

impl GantrySettings {
    /// Greatest skew limit: 10 mm.
    pub const MOST_SKEW_M: f64 = 10e-3;

    /// Greatest offset of the references: 0.1 m, more than the lead of a screw, as index pulses are at any angle of it.
    pub const MOST_OFFSET_M: f64 = 0.1;

    /// Speed at which the second motor is moved to a square beam, m/s: 1 mm/s.
    pub const SQUARING_M_PER_S: f64 = 1e-3;
}
