//! The ball screw: carries the table along, with its pitch errors, its gap and its spring.

use model::effects::{Backlash, PitchCyclic, PitchProgressive};

/// The errors of the screw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screw {
    /// Dead zone between screw and table.
    pub backlash: Backlash,
    /// Slope of the lead.
    pub progressive: PitchProgressive,
    /// Wobble of the lead.
    pub cyclic: Vec<PitchCyclic>,
}

/// The elasticity between motor and table, SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Drive stiffness.
    pub stiffness_n_per_m: f64,
    /// In parallel with it.
    pub damping_n_s_per_m: f64,
}

impl Screw {
    /// Whether it has no pitch error.
    #[must_use]
    pub fn is_true(&self) -> bool {
        self.progressive.slope_um_per_m == 0.0 && self.cyclic.is_empty()
    }

    /// Where the screw would carry an unloaded table, for a motor position (both m).
    #[must_use]
    #[inline]
    pub fn nominal_m(&self, motor_m: f64) -> f64 {
        motor_m + self.error_m(motor_m)
    }

    /// Pitch error, m, at a motor position.
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        let cyclic: f64 = self.cyclic.iter().map(|cyclic| cyclic.error_m(motor_m)).sum();
        self.progressive.error_m(motor_m) + cyclic
    }

    /// Where a rigid screw leaves the table that stood at `table_m`: it takes it along at the edges of
    /// the gap.
    #[must_use]
    #[inline]
    pub fn carried_m(&self, nominal_m: f64, table_m: f64) -> f64 {
        nominal_m - self.backlash.swallowed_m(nominal_m - table_m)
    }
}
