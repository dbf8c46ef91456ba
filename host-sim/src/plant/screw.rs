//! The ball screw: carries the table along, with its pitch errors, its gap and its spring.

use crate::effects::{Backlash, PitchCyclic, PitchProgressive};

/// The errors of the screw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screw {
    /// Dead zone between screw and table.
    pub backlash: Backlash,
    /// Slope of the lead.
    pub progressive: PitchProgressive,
    /// Wobble of the lead.
    pub cyclic: Option<PitchCyclic>,
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
    /// Where the screw would carry an unloaded table, for a motor position (both m).
    #[must_use]
    pub fn nominal_m(&self, motor_m: f64) -> f64 {
        let cyclic = self.cyclic.as_ref().map_or(0.0, |cyclic| cyclic.error_m(motor_m));
        motor_m + self.progressive.error_m(motor_m) + cyclic
    }

    /// Where a rigid screw leaves the table that stood at `table_m`: it takes it along at the edges of
    /// the gap.
    #[must_use]
    pub fn carried_m(&self, nominal_m: f64, table_m: f64) -> f64 {
        nominal_m - self.backlash.swallowed_m(nominal_m - table_m)
    }

    /// Force of the screw on the table, N, for its nominal place and the table's, and their velocities.
    #[must_use]
    pub fn force_n(&self, spring: &Spring, nominal_m: f64, nominal_velocity: f64, table: (f64, f64)) -> f64 {
        let (table_m, table_velocity) = table;
        let deflection = nominal_m - table_m;
        let stretch = deflection - self.backlash.swallowed_m(deflection);
        // In the gap nothing touches: no spring, no damping.
        let touching = if self.backlash.width_um > 0.0 && stretch == 0.0 { 0.0 } else { 1.0 };
        spring.stiffness_n_per_m * stretch
            + touching * spring.damping_n_s_per_m * (nominal_velocity - table_velocity)
    }
}
