//! Random draw of an effect.

use crate::axis::Settings;

/// The axis and a source of random numbers.
pub struct Draw<'a> {
    /// Declared settings of the axis.
    pub axis: &'a Settings,
    /// Name of another axis; empty if there is none.
    pub other: &'a str,
    /// Random sign, −1 or 1.
    pub sign: f64,
    /// Random phase, −π to π.
    pub phase_rad: f64,
    /// Uniformly distributed number between two bounds.
    pub uniform: &'a mut dyn FnMut(f64, f64) -> f64,
}

impl Draw<'_> {
    /// Uniformly distributed number from `low` to `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        (self.uniform)(low, high)
    }

    /// Uniformly distributed magnitude from `low` to `high`, with the random sign.
    pub fn signed(&mut self, low: f64, high: f64) -> f64 {
        self.sign * (self.uniform)(low, high)
    }

    /// Travel per turn of the screw, mm; 10 if not declared.
    #[must_use]
    pub fn lead_mm(&self) -> f64 {
        self.axis.mechanics.lead_mm.unwrap_or(10.0)
    }
}
