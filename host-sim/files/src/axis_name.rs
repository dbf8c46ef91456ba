//! Names of axes in machine files and in the columns of logs.

/// Description of [`is_axis_name`] for error messages.
pub const AXIS_NAME: &str = "a name that starts with a letter, followed by letters, digits or _";

/// Whether a text is an ASCII letter followed by ASCII letters, digits or underscores.
#[must_use]
pub fn is_axis_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
