//! Positions, velocities and internal states of the axes while they move.

use model::effects::LoopState;
use wide::f64x2;

use super::friction::SlidingState;
use super::lane::Lane;
use super::parameters::AxisParameters;

/// The mechanical state of the axes of a register: of one axis, where no other [`Lane`] is given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisMotion<L = f64> {
    /// True position of the motor, m.
    pub motor_m: L,
    /// Velocity of the motor, m/s.
    pub motor_m_per_s: L,
    /// Position of the table, m.
    pub table_m: L,
    /// Velocity of the table, m/s.
    pub table_m_per_s: L,
    /// Deflection of the guide's bristles, m.
    pub bristle_m: L,
    /// Low-pass filtered speed of the table, on which friction with memory depends, m/s.
    pub filtered_speed_m_per_s: L,
    /// Time on the session clock, s; it advances only where the friction of the guide depends on it.
    pub time_s: L,
    /// Force of the drive behind its lag, N.
    pub drive_n: L,
    /// Friction of the guide without its viscous part, mean of the last step, N.
    pub friction_n: L,
    /// Direction of the motor's friction that turns over with the travel, −1 to 1.
    pub motor_direction: L,
    /// State of the drive train's hysteresis. Axes that have one are not joined in a register.
    pub hysteresis: LoopState,
    /// Stretch of the drive train that this state has followed, m.
    pub stretch_m: f64,
    /// Change of the motor's velocity over the last step, m/s.
    pub motor_change: L,
    /// Change of the table's velocity over the last step, m/s.
    pub table_change: L,
}

impl<L: Lane> AxisMotion<L> {
    /// Moves every value into other registers.
    #[inline]
    fn map<M>(convert: impl Fn(fn(&AxisMotion<L>) -> L) -> M) -> AxisMotion<M> {
        AxisMotion {
            motor_m: convert(|motion| motion.motor_m),
            motor_m_per_s: convert(|motion| motion.motor_m_per_s),
            table_m: convert(|motion| motion.table_m),
            table_m_per_s: convert(|motion| motion.table_m_per_s),
            bristle_m: convert(|motion| motion.bristle_m),
            filtered_speed_m_per_s: convert(|motion| motion.filtered_speed_m_per_s),
            time_s: convert(|motion| motion.time_s),
            drive_n: convert(|motion| motion.drive_n),
            friction_n: convert(|motion| motion.friction_n),
            motor_direction: convert(|motion| motion.motor_direction),
            hysteresis: LoopState::default(),
            stretch_m: 0.0,
            motor_change: convert(|motion| motion.motor_change),
            table_change: convert(|motion| motion.table_change),
        }
    }
}

impl AxisMotion<f64x2> {
    /// Two axes in one register.
    #[must_use]
    #[inline]
    pub fn pair(axes: [&AxisMotion; 2]) -> Self {
        AxisMotion::<f64>::map(|value| f64x2::new(axes.map(value)))
    }

    /// One of the two, 0 or 1.
    #[must_use]
    #[inline]
    pub fn axis(&self, axis: usize) -> AxisMotion {
        Self::map(|value| value(self).lane(axis))
    }
}

impl AxisMotion {
    /// An axis at rest with its motor at a true position (m) and no force anywhere.
    #[must_use]
    pub fn at_rest(parameters: &AxisParameters, motor_m: f64) -> Self {
        Self { motor_m, table_m: parameters.screw.nominal_m(motor_m), ..Self::default() }
    }

    /// Acceleration of the table at this instant, m/s², from all forces on it.
    #[must_use]
    pub fn table_m_per_s2(&self, parameters: &AxisParameters) -> f64 {
        let friction = &parameters.friction;
        let v = self.table_m_per_s;
        let guide_n = if friction.has_bristles() {
            let sliding = SlidingState {
                position_m: self.table_m,
                filtered_speed_m_per_s: self.filtered_speed_m_per_s,
                time_s: self.time_s,
            };
            friction.bristles().force_n(self.bristle_m, v, friction.level_n(v, sliding))
        } else {
            self.friction_n
        };
        let resistance_n =
            guide_n + friction.viscous_n(v, self.time_s) + parameters.load.force_n(self.table_m);
        let Some(spring) = &parameters.spring else {
            let drive_n = self.drive_n + parameters.torque_ripple_n(self.motor_m)
                - parameters.motor_friction_n(self.motor_m_per_s);
            return (drive_n - resistance_n) / (parameters.motor_mass_kg + parameters.table_mass_kg);
        };
        let deflection_m = parameters.screw.nominal_m(self.motor_m) - self.table_m;
        let stretch_m = deflection_m - parameters.screw.yielded_m(self.motor_m, deflection_m);
        let in_contact = !parameters.screw.has_gap() || stretch_m != 0.0;
        let damping_n = spring.damping_n_s_per_m * (self.motor_m_per_s - v);
        let loop_n = parameters.screw.hysteresis.carried_n(self.hysteresis);
        let screw_n =
            if in_contact { spring.stiffness_n_per_m * stretch_m + loop_n + damping_n } else { 0.0 };
        (screw_n - resistance_n) / parameters.table_mass_kg
    }
}
