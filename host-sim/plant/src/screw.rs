//! The ball screw between motor and table: pitch errors, backlash, elasticity.
//!
//! Positions of the motor are reflected to the table (rotation times lead), m.

use model::effects::{Backlash, PeriodicError, PitchProgressive};

/// Geometric errors of the screw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screw {
    /// Dead zone between screw and nut.
    pub backlash: Backlash,
    /// Pitch error in proportion to the position.
    pub progressive: PitchProgressive,
    /// Periodic pitch errors.
    pub periodic: Vec<PeriodicError>,
}

/// Axial elasticity between motor and table, in series: screw shaft, nut, bearing, coupling.
#[derive(Clone, Debug, PartialEq)]
pub struct Spring {
    /// Stiffness.
    pub stiffness_n_per_m: f64,
    /// Viscous damping parallel to the stiffness.
    pub damping_n_s_per_m: f64,
}

impl Screw {
    /// Whether the screw has no pitch error. It may have backlash.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        // Without `..`, so that the compiler points here when a field is added.
        let Self { backlash: _, progressive, periodic } = self;
        progressive.slope_um_per_m == 0.0 && periodic.is_empty()
    }

    /// Position of the table without load and without backlash, m, for a true motor position (m): motor + pitch error.
    #[must_use]
    #[inline]
    pub fn nominal_m(&self, motor_m: f64) -> f64 {
        motor_m + self.error_m(motor_m)
    }

    /// Pitch error, m: table − motor without load, for a true motor position (m).
    #[must_use]
    #[inline]
    pub fn error_m(&self, motor_m: f64) -> f64 {
        let periodic: f64 = self.periodic.iter().map(|error| error.error_m(motor_m)).sum();
        self.progressive.error_m(motor_m) + periodic
    }

    /// Position of the table of a rigid screw, m, after the nut has come to `nominal_m` and before which the table
    /// stood at `table_m`: the table moves only when an edge of the backlash reaches it.
    #[must_use]
    #[inline]
    pub fn rigid_table_m(&self, nominal_m: f64, table_m: f64) -> f64 {
        nominal_m - self.backlash.absorbed_m(nominal_m - table_m)
    }
}
