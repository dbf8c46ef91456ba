//! The axes of a machine whose structure is given as rigid bodies: each moves the others.
//!
//! Masses and springs between motor and tool are those of the structure ([`super::multibody`]). An axis adds what is
//! not linear, as forces: friction of motor and guide, load and ripple, errors and backlash of the screw.

use nalgebra::Vector3;

use model::bodies::{Assembly, Structure, StructureError};

use super::axis_motion::AxisMotion;
use super::guide::Guide;
use super::multibody::{AxisForces, Multibody};
use super::parameters::AxisParameters;
use super::presliding::StepTime;
use super::screw::Spring;

/// A structure and the axes that drive it.
pub struct CoupledAxes {
    multibody: Multibody,
    axes: Vec<CoupledAxis>,
    forces: Vec<AxisForces>,
    step: StepTime,
}

/// The constants of an axis.
struct CoupledAxis {
    motor_start_m: f64,
    table_start_m: f64,
    spring: Spring,
    /// Unit vector along which the axis moves the tool against the workpiece.
    direction: Vector3<f64>,
    guide: Guide<f64>,
    /// Fraction of the difference between drive and command that is left after a step, and its mean over the step.
    lag_left: f64,
    lag_mean: f64,
}

impl CoupledAxes {
    /// At rest with the motors at `start_m`, one an axis; `parameters` from [`AxisParameters::of_machine`]. Time
    /// constant 0: a drive without lag, unless the axis has a [`model::effects::DriveLag`].
    ///
    /// # Errors
    /// If the structure is impossible, see [`Assembly::of`].
    pub fn new(
        structure: &Structure,
        parameters: &[AxisParameters],
        start_m: &[f64],
        drive_time_constant_s: f64,
        step_s: f64,
    ) -> Result<Self, StructureError> {
        let mut structure = structure.clone();
        for (axis, parameters) in structure.axis.values_mut().zip(parameters) {
            if let Some(spring) = &parameters.spring {
                axis.stiffness_n_per_um = 1e-6 * spring.stiffness_n_per_m;
            }
        }
        let mut assembly = Assembly::of(&structure)?;
        for (number, parameters) in parameters.iter().enumerate() {
            let guide = assembly.guides.row(number).into_owned();
            assembly.damping += guide.transpose() * guide * parameters.friction.viscous_n_s_per_m;
        }
        let (ways, multibody) = (assembly.ways()?, Multibody::new(&assembly, step_s)?);
        let axis = |(number, (axis, parameters)): (usize, (&model::bodies::Axis, &AxisParameters))| {
            let lag_s = parameters.servo.drive_time_constant_s(drive_time_constant_s);
            let lag_left = if lag_s > 0.0 { libm::exp(-step_s / lag_s) } else { 0.0 };
            CoupledAxis {
                motor_start_m: start_m[number],
                table_start_m: parameters.screw.nominal_m(start_m[number]),
                spring: Spring {
                    stiffness_n_per_m: 1e6 * axis.stiffness_n_per_um,
                    damping_n_s_per_m: 1e3 * axis.damping_n_s_per_mm,
                },
                direction: ways.column(number).normalize(),
                guide: Guide::new(parameters),
                lag_left,
                lag_mean: if lag_s > 0.0 { (1.0 - lag_left) * lag_s / step_s } else { 0.0 },
            }
        };
        Ok(Self {
            axes: structure.axis.values().zip(parameters).enumerate().map(axis).collect(),
            multibody,
            forces: vec![AxisForces::default(); start_m.len()],
            step: StepTime::new(step_s),
        })
    }

    /// Sets the forces of motor and screw of an axis for the next step, from the commanded force of its drive, N.
    pub fn drive(
        &mut self,
        axis: usize,
        parameters: &AxisParameters,
        motion: &mut AxisMotion,
        commanded_n: f64,
    ) {
        let lag_n = motion.drive_n - commanded_n;
        let CoupledAxis { lag_left, lag_mean, .. } = self.axes[axis];
        motion.drive_n = commanded_n + lag_left * lag_n;
        let drive_n = commanded_n + lag_mean * lag_n;
        // What depends on positions and velocities is evaluated in the middle of the step, by extrapolation.
        let half_s = 0.5 * self.step.seconds;
        let middle_m = motion.motor_m + half_s * motion.motor_m_per_s;
        let about = motion.motor_m_per_s + 0.5 * motion.motor_change;
        let resistance_n = parameters.motor_friction_n(about) - parameters.torque_ripple_n(middle_m);
        let stretch_change_m = half_s * (motion.table_m_per_s - motion.motor_m_per_s);
        let stretch_m = self.multibody.stretches_m()[axis] + stretch_change_m;
        let screw_n = self.axes[axis].screw_n(parameters, motion, middle_m, stretch_m);
        let forces = &mut self.forces[axis];
        (forces.motor_n, forces.screw_n) = (drive_n - resistance_n, screw_n);
        self.multibody.set_forces(axis, *forces);
    }

    /// Sets the force of the guide of an axis for the next step, after [`CoupledAxes::drive`] of every axis.
    pub fn apply_guide(&mut self, axis: usize, parameters: &AxisParameters, motion: &mut AxisMotion) {
        let free = self.multibody.free_step(axis);
        self.forces[axis].guide_n = self.axes[axis].guide.force_n(&[parameters], motion, free, self.step);
        self.multibody.set_forces(axis, self.forces[axis]);
    }

    /// One step of the whole structure under the forces that are set.
    pub fn step(&mut self) {
        self.multibody.step();
    }

    /// Updates the motion of an axis after a step; gives tool − table along the axis, m.
    pub fn update(&self, axis: usize, motion: &mut AxisMotion) -> f64 {
        let constants = &self.axes[axis];
        let moved_m = self.multibody.scales_m()[axis];
        let motor_m = constants.motor_start_m + self.multibody.motors_m()[axis];
        let table_m = constants.table_start_m + moved_m;
        let (motor_before, table_before) = (motion.motor_m_per_s, motion.table_m_per_s);
        motion.motor_m_per_s = self.multibody.motors_m_per_s()[axis];
        motion.table_m_per_s = self.multibody.scales_m_per_s()[axis];
        motion.motor_change = motion.motor_m_per_s - motor_before;
        motion.table_change = motion.table_m_per_s - table_before;
        (motion.motor_m, motion.table_m) = (motor_m, table_m);
        let tool_m = self.multibody.tool_m();
        let along_m: f64 = constants.direction.iter().zip(tool_m.iter()).map(|(a, b)| a * b).sum();
        along_m - moved_m
    }

    /// Mean acceleration of the table over the last step, m/s².
    #[must_use]
    pub fn table_m_per_s2(&self, motion: &AxisMotion) -> f64 {
        motion.table_change * self.step.per_second
    }
}

impl CoupledAxis {
    /// Force of the screw on the nut, N, that pitch errors and backlash add to its spring and damper, at a true motor
    /// position (m) and a stretch of the structure's spring (m).
    fn screw_n(&self, parameters: &AxisParameters, motion: &AxisMotion, motor_m: f64, stretch_m: f64) -> f64 {
        let screw = &parameters.screw;
        // Both are relative to the start, where the spring has no force.
        let error_m = screw.error_m(motor_m) - screw.error_m(self.motor_start_m);
        let deflection_m = error_m - stretch_m;
        let in_gap = deflection_m.abs() < screw.half_gap_m(motor_m);
        let rate = motion.table_m_per_s - motion.motor_m_per_s;
        // Within the gap nothing damps: the structure's damper is cancelled.
        let damper_n = if in_gap { self.spring.damping_n_s_per_m * rate } else { 0.0 };
        self.spring.stiffness_n_per_m * (error_m - screw.yielded_m(motor_m, deflection_m)) + damper_n
    }
}

#[cfg(test)]
mod tests;
