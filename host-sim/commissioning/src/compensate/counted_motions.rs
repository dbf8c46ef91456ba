//! The motions whose contour error counts if the user gives none: a circle and corners.

use files::error::InputError;

use crate::compensate::prediction::TestMotion;

/// Time for which another control has compensated before a motion, s.
pub const SETTLE_S: f64 = 1.0;

const MOTIONS: [(&str, &str); 2] = [
    ("motions/circle.toml", include_str!("../../../motions/circle.toml")),
    ("motions/corner.toml", include_str!("../../../motions/corner.toml")),
];

/// The motions, which start at `start_s` on the session clock.
///
/// # Errors
/// Never: the files are tested.
pub fn default(start_s: f64) -> Result<Vec<TestMotion>, InputError> {
    MOTIONS.into_iter().map(|(source, text)| TestMotion::parse(text, source, start_s)).collect()
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_default_motions_are_motions() {
        assert_eq!(super::default(0.0).unwrap().len(), super::MOTIONS.len());
    }
}
