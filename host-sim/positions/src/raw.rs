//! What a row of a table says, before it is a reading.

use super::measured::Way;

/// What a row says, before its approach and its unit are sure.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Raw {
    pub run: String,
    pub way: Option<Way>,
    pub target_mm: f64,
    /// Position in mm, or deviation in µm.
    pub value: f64,
    pub time_s: Option<f64>,
    pub line: usize,
}
