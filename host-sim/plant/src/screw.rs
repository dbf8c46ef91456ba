//! The ball screw between motor and table: pitch errors, backlash, elasticity.
//!
//! Positions of the motor are reflected to the table (rotation times lead), m.

use model::effects::{Backlash, GearHysteresis, PeriodicError, PitchProgressive, StiffnessMap};
use model::position_curve::PositionCurve;

/// Geometric errors of the screw.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Screw {
    /// Dead zone between screw and nut.
    pub backlash: Backlash,
    /// Pitch error in proportion to the position.
    pub progressive: PitchProgressive,
    /// Periodic pitch errors.
    pub periodic: Vec<PeriodicError>,
    /// Any other pitch error, m, over the motor position, m.
    pub map: PositionCurve,
    /// Width of the gap in addition to the backlash, m, over the motor position, m.
    pub gap_map: PositionCurve,
    /// Change of the compliance of the [`Spring`], as a part of it, over the motor position, m.
    pub compliance_map: PositionCurve,
    /// Loop of the force over the stretch of the [`Spring`].
    pub hysteresis: GearHysteresis,
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
        let Self { backlash: _, gap_map: _, compliance_map: _, hysteresis: _, progressive, periodic, map } =
            self;
        progressive.slope_um_per_m == 0.0 && periodic.is_empty() && map.is_empty()
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
        let map_m = if self.map.is_empty() { 0.0 } else { self.map.value(motor_m) };
        self.progressive.error_m(motor_m) + periodic + map_m
    }

    /// Whether there is a gap between screw and nut at any position.
    #[must_use]
    pub fn has_gap(&self) -> bool {
        self.backlash.width_um > 0.0 || !self.gap_map.is_empty()
    }

    /// Whether screw and nut are always in contact, with the same stiffness everywhere and always.
    #[must_use]
    pub fn is_coupling_constant(&self) -> bool {
        !self.has_gap() && self.compliance_map.is_empty() && !self.hysteresis.acts()
    }

    /// Half of the gap, m, at a true motor position (m).
    #[must_use]
    #[inline]
    pub fn half_gap_m(&self, motor_m: f64) -> f64 {
        // Finite differences at width 0 evaluate a negative width.
        self.half_difference_m(motor_m).max(0.0)
    }

    /// Half of the difference of the position errors in negative and in positive direction, m, at a true motor position (m): half of the
    /// gap, or below zero where a positioning test shows a table that is ahead in the direction of motion, which no gap does.
    #[must_use]
    #[inline]
    pub fn half_difference_m(&self, motor_m: f64) -> f64 {
        let half_m = self.backlash.half_m();
        if self.gap_map.is_empty() { half_m } else { half_m + 0.5 * self.gap_map.value(motor_m) }
    }

    /// Part of a deflection (nut − table, m) within the gap at a true motor position (m). It does not strain the spring
    /// of the screw.
    #[must_use]
    #[inline]
    pub fn absorbed_m(&self, motor_m: f64, deflection_m: f64) -> f64 {
        let half_m = self.half_gap_m(motor_m);
        deflection_m.clamp(-half_m, half_m)
    }

    /// Compliance of the spring at a true motor position (m), as a part of that of [`Spring`].
    #[must_use]
    #[inline]
    pub fn compliance(&self, motor_m: f64) -> f64 {
        if self.compliance_map.is_empty() {
            1.0
        } else {
            StiffnessMap::compliance(self.compliance_map.value(motor_m))
        }
    }

    /// Least and greatest compliance of the spring, as parts of that of [`Spring`].
    #[must_use]
    pub fn compliance_range(&self) -> [f64; 2] {
        /// Steps between the ends of the map: a spline bends at most once between two knots, and a map has at most 25.
        const STEPS: u32 = 400;
        let Some([from_m, to_m]) = self.compliance_map.range() else { return [1.0; 2] };
        let at = |i: u32| self.compliance(from_m + (to_m - from_m) * f64::from(i) / f64::from(STEPS));
        (0..=STEPS)
            .map(at)
            .fold([f64::INFINITY, 0.0], |[least, most], value| [least.min(value), most.max(value)])
    }

    /// Part of a deflection (nut − table, m) at a true motor position (m) that does not strain [`Spring`] with its constant stiffness: the
    /// gap, and by what a more compliant spring yields more.
    #[must_use]
    #[inline]
    pub fn yielded_m(&self, motor_m: f64, deflection_m: f64) -> f64 {
        let gap_m = self.absorbed_m(motor_m, deflection_m);
        gap_m + (deflection_m - gap_m) * (1.0 - self.compliance(motor_m).recip())
    }

    /// Position of the table of a rigid screw, m, after the motor has come to `motor_m` and the nut to `nominal_m`, and
    /// before which the table stood at `table_m`: the table moves only when an edge of the gap reaches it.
    #[must_use]
    #[inline]
    pub fn rigid_table_m(&self, motor_m: f64, nominal_m: f64, table_m: f64) -> f64 {
        nominal_m - self.absorbed_m(motor_m, nominal_m - table_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gap_absorbs_a_deflection_up_to_half_its_width() {
        let absorbed = |width_um: f64, deflection_m: f64| {
            let screw = Screw { backlash: Backlash { width_um }, ..Screw::default() };
            screw.absorbed_m(0.0, deflection_m)
        };
        assert!((absorbed(8.0, 3e-6) - 3e-6).abs() < 1e-18);
        assert!((absorbed(8.0, -9e-6) + 4e-6).abs() < 1e-18);
        // Finite differences at width 0 evaluate a negative width.
        assert!(absorbed(-0.2, 3e-6).abs() < 1e-18);
    }

    /// Where the compliance is 25 % higher, a spring under the same deflection carries 1/1.25 of the force: a fifth of what the gap leaves of
    /// the deflection does not strain it.
    #[test]
    fn a_more_compliant_spring_yields_more() {
        let compliance_map = PositionCurve::new(&[0.0, 0.1], &[0.25, -2.0]);
        let screw = Screw { backlash: Backlash { width_um: 4.0 }, compliance_map, ..Screw::default() };
        assert!((screw.yielded_m(0.0, 7e-6) - 3e-6).abs() < 1e-15);
        assert!((screw.yielded_m(0.0, -7e-6) + 3e-6).abs() < 1e-15);
        // No map makes a spring of negative compliance.
        assert!((screw.compliance(0.1) - 0.1).abs() < 1e-15);
        let [least, most] = screw.compliance_range();
        assert!((least - 0.1).abs() < 1e-15 && (most - 1.25).abs() < 1e-15);
        assert!((Screw::default().yielded_m(0.0, 7e-6)).abs() < 1e-15);
    }

    /// 8 µm of backlash, and a map from 2 µm at 0 to −10 µm at 100 mm: 10 µm, 4 µm in the middle, none at the end.
    #[test]
    fn the_width_of_a_gap_map_adds_to_that_of_the_backlash() {
        let gap_map = PositionCurve::new(&[0.0, 0.1], &[2e-6, -10e-6]);
        let screw = Screw { backlash: Backlash { width_um: 8.0 }, gap_map, ..Screw::default() };
        for (motor_m, half_m) in [(0.0, 5e-6), (0.05, 2e-6), (0.1, 0.0)] {
            assert!((screw.half_gap_m(motor_m) - half_m).abs() < 1e-15, "{motor_m}");
        }
        assert!((screw.absorbed_m(0.05, 7e-6) - 2e-6).abs() < 1e-15);
    }
}
