//! Figures of a contour error with limits.

use std::str::FromStr;

use schemars::JsonSchema;
use serde::Serialize;

use crate::sizes::Sizes;

/// A figure of the contour error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// Circular deviation of a full circle (ISO 230-4).
    #[serde(rename = "G")]
    Circular,
    /// Root mean square of the contour error over time.
    Rms,
    /// Greatest contour error.
    Greatest,
    /// Largest overshoot or rounding of a corner.
    Corner,
}

impl Figure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Circular, Self::Rms, Self::Greatest, Self::Corner];

    /// Its name on the command line and in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Circular => "G",
            Self::Rms => "rms",
            Self::Greatest => "greatest",
            Self::Corner => "corner",
        }
    }

    /// Its value, µm; `None`: no full circle, or no corner.
    #[must_use]
    pub const fn of(self, sizes: &Sizes) -> Option<f64> {
        match self {
            Self::Circular => sizes.circular,
            Self::Rms => Some(sizes.rms),
            Self::Greatest => Some(sizes.max),
            Self::Corner => sizes.corner,
        }
    }

    /// What a motion must have to show it.
    #[must_use]
    pub const fn needs(self) -> &'static str {
        match self {
            Self::Circular => "a full circle",
            Self::Rms | Self::Greatest => "a motion of two axes",
            Self::Corner => "a corner",
        }
    }
}

/// The largest value that a figure may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// The figure.
    pub figure: Figure,
    /// Its limit, µm, above 0.
    pub um: f64,
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = Figure::ALL.map(Figure::name).join(", ");
        let expected = || format!("expected NAME=µm, with NAME one of {names}, and a number of µm above 0");
        let (name, um) = text.split_once('=').ok_or_else(expected)?;
        let figure = Figure::ALL.into_iter().find(|figure| figure.name() == name).ok_or_else(expected)?;
        let um: f64 = um.parse().map_err(|_| expected())?;
        if um.is_finite() && um > 0.0 { Ok(Self { figure, um }) } else { Err(expected()) }
    }
}
