//! Numbers in the tables that people hand in.

use crate::error::quoted;

/// More mm, degrees, N or N·m than that, or less, is a slip.
const MOST: f64 = 1e9;

/// A number of a field.
///
/// # Errors
/// What was expected.
pub fn finite(field: &[u8]) -> Result<f64, &'static str> {
    let parsed = str::from_utf8(field.trim_ascii()).ok().and_then(|text| text.parse().ok());
    parsed.filter(|value: &f64| value.is_finite()).ok_or("a finite number")
}

/// A number that somebody may have measured.
///
/// # Errors
/// What was expected.
pub fn measured(field: &[u8]) -> Result<f64, &'static str> {
    finite(field)
        .and_then(|value| if value.abs() > MOST { Err("a number from −1e9 to 1e9") } else { Ok(value) })
}

/// What a field holds instead, for a message.
#[must_use]
pub fn found(field: &[u8]) -> String {
    let text = String::from_utf8_lossy(field);
    if text.trim().is_empty() { "nothing".to_owned() } else { quoted(&text) }
}
