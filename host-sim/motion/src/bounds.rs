//! Bounds of the numbers in a motion file.

use files::document::Document;
use files::error::InputError;

/// Shortest line and smallest radius: 1 nm.
pub const SHORTEST_MM: f64 = 1e-6;
/// Largest distance from zero: 100 m. A larger one has a wrong unit.
pub const LONGEST_TRAVEL_MM: f64 = 1e5;
/// Longest motion. A longer one has a wrong unit, and its log would fill the memory.
pub const LONGEST_S: f64 = 3600.0;

/// The error for an axis that `start_mm` does not contain.
pub fn unknown_axis(names: &[&str], key: &str, document: &Document<'_>) -> InputError {
    document.refuse(key, &format!("an axis of start_mm ({})", names.join(", ")))
}

/// Refuses a value that is not above 0.
pub fn positive(value: f64, key: &str, document: &Document<'_>) -> Result<f64, InputError> {
    if value > 0.0 { Ok(value) } else { Err(document.refuse(key, "a number above 0")) }
}

/// Refuses a position too far from zero.
pub fn within_travel(value_mm: f64, key: &str, document: &Document<'_>) -> Result<(), InputError> {
    if value_mm.abs() <= LONGEST_TRAVEL_MM {
        return Ok(());
    }
    Err(document.refuse(key, &format!("a position within {LONGEST_TRAVEL_MM} mm of zero")))
}
