//! What a motion file may hold.

use files::document::Document;
use files::error::InputError;

/// Shorter lines and radii are refused: 1 nm.
pub const SHORTEST_MM: f64 = 1e-6;
/// 100 m: more is a slip of the unit.
pub const LONGEST_TRAVEL_MM: f64 = 1e5;
/// Longer motions are a slip of the unit, and would fill the memory with their log.
pub const LONGEST_S: f64 = 3600.0;

/// The error of an axis that the motion does not start with.
pub fn unknown_axis(names: &[&str], key: &str, document: &Document<'_>) -> InputError {
    document.refuse(key, &format!("an axis that start_mm names ({})", names.join(", ")))
}

/// A value above 0.
pub fn positive(value: f64, key: &str, document: &Document<'_>) -> Result<f64, InputError> {
    if value > 0.0 { Ok(value) } else { Err(document.refuse(key, "a number above 0")) }
}

/// Refuses a position too far from zero.
pub fn within_travel(value_mm: f64, key: &str, document: &Document<'_>) -> Result<(), InputError> {
    if value_mm.abs() <= LONGEST_TRAVEL_MM {
        return Ok(());
    }
    Err(document.refuse(key, &format!("a travel within {LONGEST_TRAVEL_MM} mm of zero")))
}
