//! Names of axes in machine files and in the columns of logs.

/// What [`is_axis_name`] accepts, in messages.
pub const AXIS_NAME: &str = "a name that starts with a letter and goes on with letters, digits or _";

/// Whether a text is an ASCII letter followed by ASCII letters, digits or underscores.
#[must_use]
pub fn is_axis_name(name: &str) -> bool {
    name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
}
