//! The permitted range of a declared number, and its description in an error message.

use files::document::Document;
use files::error::InputError;

/// Upper bound of every number of a machine file, in its own unit. A larger number is a typing error.
const LARGEST: f64 = 1e12;

/// The range of a declared number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Above 0, up to 1e12.
    Positive,
    /// From 0 to 1e12.
    NotNegative,
    /// From −1e12 to 1e12.
    Signed,
    /// From 0 to this.
    UpTo(f64),
    /// From minus this to plus this.
    Within(f64),
    /// Above this, up to 1e12.
    Above(f64),
}

impl Range {
    /// Whether a value lies in the range.
    #[must_use]
    pub fn contains(self, value: f64) -> bool {
        match self {
            Self::Positive => value > 0.0 && value <= LARGEST,
            Self::NotNegative => (0.0..=LARGEST).contains(&value),
            Self::Signed => value.abs() <= LARGEST,
            Self::UpTo(max) => (0.0..=max).contains(&value),
            Self::Within(max) => value.abs() <= max,
            Self::Above(min) => value > min && value <= LARGEST,
        }
    }

    /// Checks the value of a key of a document.
    ///
    /// # Errors
    /// If the value is out of range. The error contains the range and the value.
    pub fn check(self, key: &str, value: f64, document: &Document<'_>) -> Result<(), InputError> {
        if self.contains(value) {
            return Ok(());
        }
        let at_most = if value > LARGEST { format!(", at most {LARGEST:e}") } else { String::new() };
        Err(document.refuse(key, &(self.description() + &at_most)))
    }

    /// The range in words, for an error.
    #[must_use]
    pub fn description(self) -> String {
        match self {
            Self::Positive => "a number above 0".to_owned(),
            Self::NotNegative => "a number not below 0".to_owned(),
            Self::Signed => format!("a number within ±{LARGEST:e}"),
            Self::UpTo(max) => format!("a number from 0 to {max}"),
            Self::Within(max) => format!("a number within ±{max}"),
            Self::Above(min) => format!("a number above {min}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Range;

    #[test]
    fn ranges_include_closed_ends_and_exclude_open_ends() {
        assert!(Range::Above(-100.0).contains(-99.9) && !Range::Above(-100.0).contains(-100.0));
        assert!(Range::NotNegative.contains(0.0) && !Range::Positive.contains(0.0));
        assert!(Range::Within(3.0).contains(-3.0) && !Range::Within(3.0).contains(-3.1));
        assert!(Range::UpTo(3.0).contains(3.0) && !Range::UpTo(3.0).contains(-0.1));
        assert!(!Range::Signed.contains(1e13) && !Range::Positive.contains(1e13));
    }
}
