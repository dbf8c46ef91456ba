//! The table driven by the measured motor.

use std::sync::Arc;

use crate::input::motor_path::{MotorPath, Point};
use crate::input::smoothing::Smooth;
use crate::input::table_motions::TableMotion;
use model::servo::ServoParameters;
use plant::driven::{DrivenStep, DrivenTable, ScrewMotion};
use plant::parameters::AxisParameters;
use plant::residuals::Residuals;
use plant::screw::Spring;
use plant::tool_parameters::ToolParameters;

/// The measured motion of a motor.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredMotor<'a> {
    /// Motor encoder.
    pub motor: &'a Smooth,
    /// Position of the motor between the samples.
    pub path: &'a MotorPath,
    /// Time of the first sample on the session's clock, s.
    pub start_s: f64,
}

/// The motion of the table of an axis, which may be known.
#[must_use]
pub fn of(parameters: &AxisParameters, measured: MeasuredMotor<'_>) -> Arc<TableMotion> {
    let simulate = |parameters: &AxisParameters| simulated(parameters, measured);
    measured.path.table_motions.get(of_table(parameters), simulate)
}

/// The parameters without those that do not act on the table: what the motion of the table depends on.
fn of_table(parameters: &AxisParameters) -> AxisParameters {
    AxisParameters {
        motor_mass_kg: 0.0,
        motor_coulomb_n: 0.0,
        motor_stribeck: Default::default(),
        forced_windup: None,
        drive_asymmetry: Default::default(),
        ripple: Vec::new(),
        tool: ToolParameters::default(),
        servo: ServoParameters::default(),
        latency: Vec::new(),
        residuals: Residuals::default(),
        ..parameters.clone()
    }
}

fn simulated(parameters: &AxisParameters, measured: MeasuredMotor<'_>) -> TableMotion {
    let MeasuredMotor { motor, path, .. } = measured;
    let mut table = SimulatedTable::new(parameters, measured);
    let mut steps = path.points[1..].chunks_exact(path.steps);
    let mut point = path.points[0];
    for i in 0..motor.value.len() {
        for &next in if i == 0 { &[][..] } else { steps.next().unwrap_or(&[]) } {
            point = next;
            table.step(point, path.step_s);
        }
        table.sample(point);
    }
    table.filtered(motor)
}

/// A table and what has been recorded of its motion.
struct SimulatedTable<'a> {
    parameters: &'a AxisParameters,
    step: DrivenStep<'a>,
    /// Stretch of the spring per acceleration of the table, m per m/s².
    stretch_s2: f64,
    motor_m: f64,
    screw: ScrewMotion,
    dividing_error: Differentiated,
    screw_error: Differentiated,
    table: DrivenTable,
    motion: TableMotion,
}

impl<'a> SimulatedTable<'a> {
    fn new(parameters: &'a AxisParameters, measured: MeasuredMotor<'_>) -> Self {
        let MeasuredMotor { motor, path, start_s } = measured;
        let first_m = path.points[0].reading_m;
        let motor_m = parameters.motor_of_reading_m(first_m);
        let screw = ScrewMotion {
            velocity: motor.velocity[0],
            acceleration: motor.acceleration[0],
            time_s: start_s,
            ..ScrewMotion::at(&parameters.screw, motor_m)
        };
        let of_spring = |spring: &Spring| parameters.table_mass_kg / spring.stiffness_n_per_m;
        Self {
            parameters,
            step: DrivenStep::new(parameters, path.step_s),
            stretch_s2: parameters.spring.as_ref().map_or(0.0, of_spring),
            motor_m,
            screw,
            dividing_error: Differentiated::new(motor_m - first_m),
            screw_error: Differentiated::new(screw.nominal_m - motor_m),
            table: DrivenTable::settled(parameters, screw),
            motion: TableMotion::with_capacity(motor.value.len()),
        }
    }

    /// Moves to the next point of the motor's path.
    #[inline]
    fn step(&mut self, point: Point, step_s: f64) {
        let Self { parameters, dividing_error, screw_error, .. } = self;
        let per_step = self.step.per_second();
        self.motor_m = parameters.motor_of_reading_m(point.reading_m);
        let at_rest = ScrewMotion::at(&parameters.screw, self.motor_m);
        dividing_error.advance(self.motor_m - point.reading_m, per_step);
        screw_error.advance(at_rest.nominal_m - self.motor_m, per_step);
        self.screw = ScrewMotion {
            velocity: (at_rest.nominal_m - self.screw.nominal_m) * per_step,
            acceleration: point.acceleration + dividing_error.acceleration + screw_error.acceleration,
            error_velocity: screw_error.rate,
            time_s: self.screw.time_s + step_s,
            ..at_rest
        };
        self.table.step(&self.step, self.screw);
    }

    /// Records a sample, without the linear parts: position − stretch·acceleration of the motor, mass·acceleration.
    fn sample(&mut self, point: Point) {
        let Self { parameters, table, motion, .. } = self;
        let table_m = table.position_m(parameters, self.screw);
        motion.table_m.push(table_m - point.reading_m + self.stretch_s2 * point.acceleration);
        motion.transmitted_n.push(table.transmitted_n - parameters.table_mass_kg * point.acceleration);
        motion.motor_m.push(self.motor_m);
        motion.dividing_acceleration.push(self.dividing_error.acceleration);
    }

    /// The recorded motion, with the table filtered and its linear part added.
    fn filtered(self, motor: &Smooth) -> TableMotion {
        let stretch_s2 = self.stretch_s2 + self.parameters.inertial_windup.stretch_s2();
        let linear_m = |i: usize| motor.value[i] - stretch_s2 * motor.acceleration[i];
        let nonlinear_m = motor.filtered(&self.motion.table_m).into_iter().enumerate();
        TableMotion { table_m: nonlinear_m.map(|(i, m)| m + linear_m(i)).collect(), ..self.motion }
    }
}

/// A quantity with its first and second backward differences over time.
struct Differentiated {
    value: f64,
    rate: f64,
    acceleration: f64,
}

impl Differentiated {
    fn new(value: f64) -> Self {
        Self { value, rate: 0.0, acceleration: 0.0 }
    }

    fn advance(&mut self, value: f64, per_step: f64) {
        let rate = (value - self.value) * per_step;
        self.acceleration = (rate - self.rate) * per_step;
        (self.value, self.rate) = (value, rate);
    }
}
