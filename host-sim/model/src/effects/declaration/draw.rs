//! What an effect is drawn from at random.

use crate::axis::Settings;

/// The axis, and random numbers.
pub struct Draw<'a> {
    /// As declared.
    pub axis: &'a Settings,
    /// Name of another axis; empty if there is none.
    pub other: &'a str,
    /// −1 or 1.
    pub sign: f64,
    /// −π to π.
    pub phase_rad: f64,
    /// A number between two.
    pub uniform: &'a mut dyn FnMut(f64, f64) -> f64,
}

impl Draw<'_> {
    /// A number between two.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        (self.uniform)(low, high)
    }

    /// A number between two, of either sign.
    pub fn signed(&mut self, low: f64, high: f64) -> f64 {
        self.sign * (self.uniform)(low, high)
    }

    /// Travel in one turn of the screw, mm; 10 where none is declared.
    #[must_use]
    pub fn lead_mm(&self) -> f64 {
        self.axis.mechanics.lead_mm.unwrap_or(10.0)
    }
}
