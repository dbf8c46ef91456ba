//! A number for each point of a gain schedule.

use serde::{Deserialize, Serialize};

/// A number for each point of the gain schedule of an axis, in a file a list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct PerPoint(pub Vec<f64>);
