//! What the user says of a file.

use std::str::FromStr;

use crate::format::Format;

/// What the user says of a file.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Which column is which channel.
    pub mappings: Vec<Mapping>,
    /// Units that the file does not say, or says wrongly.
    pub units: Vec<UnitOf>,
    /// Samples per second, if the file has no times.
    pub rate_hz: Option<f64>,
    /// The format, if it is not to be recognised by content.
    pub preset: Option<Format>,
}

impl Request {
    /// Whether the user says nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.mappings.is_empty() && self.units.is_empty() && self.rate_hz.is_none() && self.preset.is_none()
    }
}

/// A channel and the column that holds it: `x_command_mm=X cmd`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mapping {
    /// Our name.
    pub ours: String,
    /// Name in the file.
    pub theirs: String,
}

impl FromStr for Mapping {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (ours, theirs) = pair(text, "OURS=THEIRS")?;
        Ok(Self { ours, theirs })
    }
}

/// The unit of a column of the file: `x_command_mm=inch`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitOf {
    /// Our name.
    pub ours: String,
    /// The unit of its column.
    pub unit: String,
}

impl FromStr for UnitOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (ours, unit) = pair(text, "OURS=UNIT")?;
        Ok(Self { ours, unit })
    }
}

fn pair(text: &str, expected: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').map(|(ours, theirs)| (ours.trim(), theirs.trim()));
    match parts {
        Some((ours, theirs)) if !ours.is_empty() && !theirs.is_empty() => {
            Ok((ours.to_owned(), theirs.to_owned()))
        }
        _ => Err(format!("expected {expected}")),
    }
}
