//! A found effect, as the kinds see it that may have been taken for it.

use shared::config::Rates;

use super::coordinate::Coordinate;
use super::mode::Mode;
use crate::axis::Settings;

/// An effect that was found on an axis.
#[derive(Clone, Debug)]
pub struct Found<'a> {
    /// [`EffectModel::NAME`](super::EffectModel::NAME).
    pub name: &'static str,
    /// Keys and values of its parameters.
    pub parameters: Vec<(&'static str, f64)>,
    /// Its fitted coordinates.
    pub coordinates: Vec<Coordinate>,
    /// The mode of the tool that it is.
    pub mode: Option<Mode>,
    /// Declared settings of the axis.
    pub axis: &'a Settings,
    /// Rates of the loops.
    pub rates: Rates,
    /// Length of the logged travel, mm.
    pub travel_mm: f64,
}

impl Found<'_> {
    /// The value of a parameter; `None` if the effect has no such parameter.
    #[must_use]
    pub fn value(&self, key: &str) -> Option<f64> {
        self.parameters.iter().find(|(other, _)| *other == key).map(|(_, value)| *value)
    }

    /// Period of the velocity loop, ms.
    #[must_use]
    pub fn tick_ms(&self) -> f64 {
        1e3 / self.rates.velocity_loop_hz
    }
}

/// What is tried in place of a found effect, with the values at which the fit starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Substitute<E> {
    /// The other effect.
    pub effect: E,
    /// Coordinates with which the found effect stays beside the other one; `None`: it does not stay.
    pub beside: Option<Vec<f64>>,
}

impl<E> Substitute<E> {
    /// An effect that is tried alone.
    #[must_use]
    pub const fn alone(effect: E) -> Self {
        Self { effect, beside: None }
    }
}
