//! Where the axes of a register are, and how they move.

use wide::f64x2;

use super::friction::Slide;
use super::lane::Lane;
use super::parameters::AxisParameters;

/// Positions (m) and velocities (m/s) of the axes of a register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<L> {
    /// Motor, true position.
    pub motor_m: L,
    /// Motor.
    pub motor_m_per_s: L,
    /// Table.
    pub table_m: L,
    /// Table.
    pub table_m_per_s: L,
    /// Bend of the guide's bristles.
    pub bristle_m: L,
    /// Speed that the guide's friction remembers.
    pub lately_m_per_s: L,
    /// Force of the drive, N.
    pub drive_n: L,
    /// Friction of the guide without its viscous part, mean of the last step, N.
    pub friction_n: L,
    /// Change of the motor's velocity over the last step, m/s.
    pub motor_change: L,
    /// Change of the table's velocity over the last step, m/s.
    pub table_change: L,
}

/// Of one axis.
pub type AxisMotion = Motion<f64>;

impl<L: Lane> Motion<L> {
    /// The same of other registers, value by value.
    #[inline]
    fn map<M>(of: impl Fn(fn(&Motion<L>) -> L) -> M) -> Motion<M> {
        Motion {
            motor_m: of(|motion| motion.motor_m),
            motor_m_per_s: of(|motion| motion.motor_m_per_s),
            table_m: of(|motion| motion.table_m),
            table_m_per_s: of(|motion| motion.table_m_per_s),
            bristle_m: of(|motion| motion.bristle_m),
            lately_m_per_s: of(|motion| motion.lately_m_per_s),
            drive_n: of(|motion| motion.drive_n),
            friction_n: of(|motion| motion.friction_n),
            motor_change: of(|motion| motion.motor_change),
            table_change: of(|motion| motion.table_change),
        }
    }
}

impl Motion<f64x2> {
    /// Two axes beside each other.
    #[must_use]
    #[inline]
    pub fn beside(axes: [&AxisMotion; 2]) -> Self {
        AxisMotion::map(|value| f64x2::new(axes.map(value)))
    }

    /// One of the two.
    #[must_use]
    #[inline]
    pub fn axis(&self, axis: usize) -> AxisMotion {
        Self::map(|value| value(self).lane(axis))
    }
}

impl AxisMotion {
    /// At rest with the motor at a place and no force anywhere.
    #[must_use]
    pub fn at_rest(parameters: &AxisParameters, motor_m: f64) -> Self {
        Self { motor_m, table_m: parameters.screw.nominal_m(motor_m), ..Self::default() }
    }

    /// Acceleration of the table at this moment, m/s².
    #[must_use]
    pub fn table_m_per_s2(&self, parameters: &AxisParameters) -> f64 {
        let friction = &parameters.friction;
        let v = self.table_m_per_s;
        let guide_n = if friction.has_bristles() {
            let slide = Slide { place_m: self.table_m, lately_m_per_s: self.lately_m_per_s };
            let relaxes = friction.relaxes_per_m(friction.level_n(v, slide)) * v.abs();
            friction.bristle_stiffness_n_per_m * self.bristle_m
                + friction.bristle_damping_n_s_per_m * (v - relaxes * self.bristle_m)
        } else {
            self.friction_n
        };
        let resistance_n = guide_n + friction.viscous_n(v) + parameters.load.force_n;
        let Some(spring) = &parameters.spring else {
            let drive_n = self.drive_n + parameters.ripple_n(self.motor_m)
                - parameters.motor_friction_n(self.motor_m_per_s);
            return (drive_n - resistance_n) / (parameters.motor_mass_kg + parameters.table_mass_kg);
        };
        let deflection_m = parameters.screw.nominal_m(self.motor_m) - self.table_m;
        let stretch_m = deflection_m - parameters.screw.backlash.swallowed_m(deflection_m);
        let touches = parameters.screw.backlash.width_um == 0.0 || stretch_m != 0.0;
        let damping_n = spring.damping_n_s_per_m * (self.motor_m_per_s - v);
        let screw_n = if touches { spring.stiffness_n_per_m * stretch_m + damping_n } else { 0.0 };
        (screw_n - resistance_n) / parameters.table_mass_kg
    }
}
