//! Motion of one axis: two masses and a screw, or one rigid mass.
//!
//! Half a step of drift, forces in the middle, half a step of drift (position Verlet): it keeps the
//! energy of the spring bounded, costs one force evaluation a step, and is of second order. A first
//! order shows: half a step of 30 µs between position and velocity is half a percent of mass.

use super::parameters::AxisParameters;

/// Positions (m) and velocities (m/s) of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisMotion {
    /// Motor, true position.
    pub motor_m: f64,
    /// Motor.
    pub motor_m_per_s: f64,
    /// Table.
    pub table_m: f64,
    /// Table.
    pub table_m_per_s: f64,
    /// Table, over the last step.
    pub table_m_per_s2: f64,
    /// Bend of the guide's bristles.
    pub bristle_m: f64,
}

impl AxisMotion {
    /// At rest with the motor at a place and no force anywhere.
    #[must_use]
    pub fn at_rest(parameters: &AxisParameters, motor_m: f64) -> Self {
        Self { motor_m, table_m: parameters.screw.nominal_m(motor_m), ..Self::default() }
    }

    /// One step under a drive force, N.
    pub fn step(&mut self, parameters: &AxisParameters, force_n: f64, step_s: f64) {
        let half_s = 0.5 * step_s;
        self.motor_m += self.motor_m_per_s * half_s;
        let drive =
            force_n + parameters.ripple_n(self.motor_m) - parameters.motor_friction_n(self.motor_m_per_s);
        match &parameters.spring {
            None => self.kick_rigid(parameters, drive, step_s),
            Some(spring) => {
                self.table_m += self.table_m_per_s * half_s;
                let nominal = parameters.screw.nominal_m(self.motor_m);
                let table = (self.table_m, self.table_m_per_s);
                let spring = parameters.screw.force_n(spring, nominal, self.motor_m_per_s, table);
                self.motor_m_per_s += (drive - spring) / parameters.motor_mass_kg * step_s;
                self.kick_table(parameters, spring, step_s);
                self.table_m += self.table_m_per_s * half_s;
            }
        }
        self.motor_m += self.motor_m_per_s * half_s;
        if parameters.spring.is_none() {
            self.follow_rigidly(parameters, step_s);
        }
    }

    fn kick_table(&mut self, parameters: &AxisParameters, spring_n: f64, step_s: f64) {
        let friction = parameters.friction.step(&mut self.bristle_m, self.table_m_per_s, step_s);
        let force = spring_n - friction - parameters.load.force_n;
        self.table_m_per_s2 = force / parameters.table_mass_kg;
        self.table_m_per_s += self.table_m_per_s2 * step_s;
    }

    fn kick_rigid(&mut self, parameters: &AxisParameters, drive_n: f64, step_s: f64) {
        let mass = parameters.motor_mass_kg + parameters.table_mass_kg;
        let friction = &parameters.friction;
        self.motor_m_per_s = if friction.has_bristles() {
            let resistance = friction.step(&mut self.bristle_m, self.motor_m_per_s, step_s);
            self.motor_m_per_s + (drive_n - resistance - parameters.load.force_n) / mass * step_s
        } else {
            let resistance = friction.viscous_n(self.motor_m_per_s) + parameters.load.force_n;
            let free = self.motor_m_per_s + (drive_n - resistance) / mass * step_s;
            friction.stopped(free, mass, step_s)
        };
    }

    /// Puts the table where a rigid screw carries it.
    fn follow_rigidly(&mut self, parameters: &AxisParameters, step_s: f64) {
        let table_m = parameters.screw.carried_m(parameters.screw.nominal_m(self.motor_m), self.table_m);
        let velocity = (table_m - self.table_m) / step_s;
        self.table_m_per_s2 = (velocity - self.table_m_per_s) / step_s;
        self.table_m_per_s = velocity;
        self.table_m = table_m;
    }
}
