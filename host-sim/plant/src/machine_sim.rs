//! The simulated machine: all axes, stepped together, with drives, sensors and logged channels.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;
use shared::units::Position;
use wide::f64x2;

use super::axis_motion::AxisMotion;
use super::coupled_axes::CoupledAxes;
use super::delay::{Delay, ForceDelay, ForcePath, LogDelay};
use super::following::Following;
use super::instruments::Instruments;
use super::mechanics::Stepper;
use super::parameters::AxisParameters;
use super::residuals::{Displacement, OtherAxis, ResidualInput};
use super::sensors::Sensor;
use super::tool_point::{self, Modes, Tables};
use model::bodies::StructureError;
use model::effects::Channel;
use model::machine::Machine;
use model::residual_law::Hysteresis;
use model::residual_table::first_other;

/// The position that a controller reads. One outside the number format occurs only in an unstable loop; the following error then
/// ends the run.
#[must_use]
pub fn position(m: f64) -> Position {
    Position::from_m(m).unwrap_or(Position(i64::MAX / 4))
}

/// What is logged of one axis besides command and motor, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Displacement of the motor by a table of residuals, which its encoder reads in the log.
    pub motor_offset_m: f64,
    /// Reading of the tool-point probe.
    pub tool_m: f64,
    /// Reading of the linear scale, with the latency of the log.
    pub table_m: f64,
    /// Force commanded for the last tick, with the latency of the log.
    pub force_n: f64,
}

struct SimulatedAxis {
    parameters: AxisParameters,
    stepper: Stepper<f64>,
    motion: AxisMotion,
    following: Option<Following>,
    modes: Modes,
    motor_delay: Option<Delay>,
    table_delay: Option<Delay>,
    table_log_delay: LogDelay,
    tool_log_delay: LogDelay,
    force_log_delay: Option<ForceDelay>,
    /// `None`: the drive has no dead time.
    force_path: ForcePath,
    /// Tool − table by the bodies of the structure, m.
    structure_offset_m: f64,
    /// Of the terms of the laws.
    hystereses: Vec<Vec<Hysteresis>>,
    /// Force that the controller commanded for the tick, N.
    commanded_n: f64,
    /// Force at the input of the drive, behind its dead time, N.
    drive_n: f64,
}

/// Independent axes that are stepped in one register.
enum Group {
    /// An axis, by its number.
    Single(usize),
    /// The number of the first of two neighbours, and their common stepper.
    Pair(usize, Box<Stepper<f64x2>>),
}

/// The simulated machine.
pub struct MachineSim {
    names: Vec<String>,
    axes: Vec<SimulatedAxis>,
    groups: Vec<Group>,
    /// `Some` if the machine file describes rigid bodies.
    coupled_axes: Option<CoupledAxes>,
    instruments: Instruments,
    random: ChaCha8Rng,
    step_s: f64,
    substeps: u32,
    /// Time of the session, s.
    time_s: f64,
}

impl MachineSim {
    /// A machine at rest with its motors at `start_m`, at time zero of the session. A tick is that of its velocity loop; its number of steps follows
    /// from [`AxisParameters::max_step_s`].
    ///
    /// # Errors
    /// If its structure is impossible.
    pub fn new(machine: &Machine, instruments: Instruments, start_m: &[f64]) -> Result<Self, StructureError> {
        let tick_s = 1.0 / machine.velocity_rate_hz();
        let steps_s = AxisParameters::of_machine(machine).into_iter().map(|axis| axis.max_step_s());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a handful of steps a tick"
        )]
        let steps = (tick_s / numerics::min(steps_s).min(tick_s)).ceil() as u32;
        Self::with_steps(machine, instruments, start_m, steps)
    }

    /// [`MachineSim::new`] with a given number of steps per tick; 0 is taken as 1.
    ///
    /// # Errors
    /// If its structure is impossible.
    pub fn with_steps(
        machine: &Machine,
        instruments: Instruments,
        start_m: &[f64],
        steps: u32,
    ) -> Result<Self, StructureError> {
        let substeps = steps.max(1);
        let timing = Timing::of(machine, substeps);
        let parameters = AxisParameters::of_machine(machine);
        let lag_s = instruments.drive_time_constant_s;
        let coupled_axes = match &machine.structure {
            Some(bodies) => Some(CoupledAxes::new(bodies, &parameters, start_m, lag_s, timing.step_s)?),
            None => None,
        };
        let axis = |((parameters, &start_m), axis)| {
            let following = Following::of(axis);
            SimulatedAxis { following, ..SimulatedAxis::at_rest(parameters, &instruments, start_m, timing) }
        };
        let declared = parameters.into_iter().zip(start_m).zip(machine.axis.values());
        let axes: Vec<SimulatedAxis> = declared.map(axis).collect();
        Ok(Self {
            names: machine.axis.keys().cloned().collect(),
            groups: groups(&axes),
            axes,
            coupled_axes,
            instruments,
            random: ChaCha8Rng::seed_from_u64(instruments.seed),
            step_s: timing.step_s,
            substeps,
            time_s: 0.0,
        })
    }

    /// This machine, whose run starts at this time of the session, s.
    #[must_use]
    pub fn starting_at(mut self, start_s: f64) -> Self {
        self.time_s = start_s;
        for axis in &mut self.axes {
            axis.motion.time_s = start_s;
        }
        self
    }

    /// Reads motor encoder and linear scale of each axis, with noise, quantisation and latency. To be called once a
    /// tick.
    pub fn read(&mut self, readings: &mut [Reading]) {
        for (axis, reading) in self.axes.iter_mut().zip(readings) {
            let AxisMotion { motor_m, motor_m_per_s, table_m, table_m_per_s, .. } = axis.motion;
            let (sensor, motor_delay) = match axis.following {
                // Steps are counted, not read: its reading has no noise, and is not late.
                Some(_) => (Sensor::default(), &mut None),
                None => (self.instruments.motor, &mut axis.motor_delay),
            };
            let delayed = |delay: &mut Option<Delay>, position_m, velocity| match delay {
                Some(delay) => delay.read(position_m, velocity),
                None => position_m,
            };
            let motor_m = delayed(motor_delay, motor_m, motor_m_per_s);
            let table_m = delayed(&mut axis.table_delay, table_m, table_m_per_s);
            let motor_m = motor_m + axis.parameters.resolver_error_m(motor_m);
            let table_m = table_m + axis.parameters.scale.error_m(table_m, self.time_s);
            reading.motor = position(sensor.read(motor_m, &mut self.random));
            reading.table = Some(position(self.instruments.table.read(table_m, &mut self.random)));
        }
    }

    /// The logged channels that the controller does not know, one value per axis: from its readings of this tick, the
    /// forces of the next tick (N) and the time of the session (s). To be called once per sample.
    pub fn measure(
        &mut self,
        readings: &[Reading],
        next_n: impl Iterator<Item = f64>,
        time_s: f64,
    ) -> Vec<Measurement> {
        let position_m: Vec<f64> = self.axes.iter().map(|a| a.motion.table_m).collect();
        let acceleration: Vec<f64> = self.axes.iter().map(|axis| self.table_m_per_s2(axis)).collect();
        let has_residuals = self.axes.iter().any(|axis| !axis.parameters.residuals.is_empty());
        let motions = self.axes.iter().zip(&acceleration).filter(|_| has_residuals);
        let others: Vec<OtherAxis> = motions
            .map(|(axis, &acceleration)| OtherAxis {
                position_m: axis.motion.table_m,
                velocity: axis.motion.table_m_per_s,
                acceleration,
            })
            .collect();
        let tables = Tables { names: &self.names, position_m: &position_m, acceleration: &acceleration };
        let mut measurements = Vec::with_capacity(self.axes.len());
        for ((i, axis), next_n) in self.axes.iter_mut().enumerate().zip(next_n) {
            let offset =
                axis.modes.offset_m() + tool_point::offset_m(&axis.parameters.tool, i, &tables, time_s);
            let AxisMotion { table_m, table_m_per_s, .. } = axis.motion;
            let lag_m =
                |delay: &mut LogDelay, position_m| delay.lag_m(position_m, table_m_per_s, acceleration[i]);
            let grown_m = axis.parameters.scale.displacement_m(table_m, time_s);
            let tool_m = table_m + grown_m + axis.structure_offset_m + offset;
            let tool_m = tool_m - lag_m(&mut axis.tool_log_delay, tool_m);
            let force_n =
                axis.force_log_delay.as_ref().map_or(axis.commanded_n, |delay| delay.logged_n(next_n));
            let residuals = &axis.parameters.residuals;
            let displaced = if residuals.is_empty() {
                Displacement::default()
            } else {
                let input = ResidualInput {
                    position_m: table_m,
                    velocity: table_m_per_s,
                    acceleration: acceleration[i],
                    force_n,
                    time_s,
                    other: others.get(first_other(i)).copied().unwrap_or_default(),
                };
                residuals.displacement(&input, &mut axis.hystereses)
            };
            measurements.push(Measurement {
                motor_offset_m: displaced.motor_m,
                tool_m: displaced.tool_m + self.instruments.tool.read(tool_m, &mut self.random),
                table_m: readings[i].table.map_or(table_m, Position::to_m)
                    - lag_m(&mut axis.table_log_delay, table_m)
                    + displaced.table_m,
                force_n: displaced.force_n + self.instruments.force.read(force_n, &mut self.random),
            });
        }
        measurements
    }

    fn table_m_per_s2(&self, axis: &SimulatedAxis) -> f64 {
        match &self.coupled_axes {
            None => axis.motion.table_m_per_s2(&axis.parameters),
            Some(coupled_axes) => coupled_axes.table_m_per_s2(&axis.motion),
        }
    }

    /// Moves the machine over one tick under the commanded forces, N.
    pub fn step(&mut self, forces_n: impl Iterator<Item = f64>) {
        for (axis, force_n) in self.axes.iter_mut().zip(forces_n) {
            if let Some(following) = axis.following {
                following.drive(&mut axis.motion, force_n);
                continue;
            }
            let [output_n, acting_n] = axis.force_path.output_and_acting_n(force_n);
            axis.commanded_n = output_n;
            axis.drive_n = axis.parameters.drive_asymmetry.acting_n(acting_n);
            if let Some(delay) = &mut axis.force_log_delay {
                delay.push(axis.commanded_n);
            }
        }
        self.time_s += f64::from(self.substeps) * self.step_s;
        match &mut self.coupled_axes {
            None => {
                for group in &self.groups {
                    match group {
                        Group::Single(axis) => {
                            let axis = &mut self.axes[*axis];
                            (0..self.substeps).for_each(|_| axis.step(self.step_s));
                        }
                        Group::Pair(first, stepper) => {
                            if let [a, b] = &mut self.axes[*first..*first + 2] {
                                step_pair(stepper, [a, b], self.substeps);
                            }
                        }
                    }
                }
            }
            Some(coupled_axes) => {
                (0..self.substeps).for_each(|_| step_coupled(coupled_axes, &mut self.axes, self.step_s));
            }
        }
    }
}

/// Periods of a machine, s.
#[derive(Clone, Copy)]
#[expect(clippy::struct_field_names, reason = "the unit")]
struct Timing {
    tick_s: f64,
    step_s: f64,
    sample_s: f64,
}

impl Timing {
    fn of(machine: &Machine, substeps: u32) -> Self {
        let tick_s = 1.0 / machine.velocity_rate_hz();
        Self { tick_s, step_s: tick_s / f64::from(substeps), sample_s: 1.0 / machine.sample_rate_hz }
    }
}

/// Pairs neighbours that may share a register, from the first axis on.
fn groups(axes: &[SimulatedAxis]) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut first = 0;
    while first < axes.len() {
        let pair = match &axes[first..] {
            [a, b, ..] if a.can_be_paired() && b.can_be_paired() => Stepper::pair([&a.stepper, &b.stepper]),
            _ => None,
        };
        let (group, axes) = match pair {
            Some(stepper) => (Group::Pair(first, Box::new(stepper)), 2),
            None => (Group::Single(first), 1),
        };
        groups.push(group);
        first += axes;
    }
    groups
}

fn step_pair(stepper: &Stepper<f64x2>, axes: [&mut SimulatedAxis; 2], steps: u32) {
    let [a, b] = axes;
    let mut motion = AxisMotion::pair([&a.motion, &b.motion]);
    let force_n = f64x2::new([a.drive_n, b.drive_n]);
    for _ in 0..steps {
        stepper.step([&a.parameters, &b.parameters], &mut motion, force_n);
    }
    (a.motion, b.motion) = (motion.axis(0), motion.axis(1));
}

fn step_coupled(coupled_axes: &mut CoupledAxes, axes: &mut [SimulatedAxis], step_s: f64) {
    for (i, axis) in axes.iter_mut().enumerate() {
        coupled_axes.drive(i, &axis.parameters, &mut axis.motion, axis.drive_n);
    }
    for (i, axis) in axes.iter_mut().enumerate() {
        coupled_axes.apply_guide(i, &axis.parameters, &mut axis.motion);
    }
    coupled_axes.step();
    for (i, axis) in axes.iter_mut().enumerate() {
        axis.structure_offset_m = coupled_axes.update(i, &mut axis.motion);
        let change = axis.motion.table_change;
        axis.oscillate(change, step_s);
    }
}

impl SimulatedAxis {
    fn at_rest(parameters: AxisParameters, instruments: &Instruments, start_m: f64, timing: Timing) -> Self {
        let Timing { tick_s, step_s, sample_s } = timing;
        let latency_s = |channel| parameters.latency_s(channel);
        let lag_s = parameters.servo.drive_time_constant_s(instruments.drive_time_constant_s);
        Self {
            stepper: Stepper::new(&parameters, lag_s, step_s),
            motion: AxisMotion::at_rest(&parameters, start_m),
            following: None,
            modes: Modes::at_rest(&parameters.tool.resonances, step_s),
            motor_delay: Delay::new(instruments.motor_latency_s, tick_s, start_m),
            table_delay: Delay::new(instruments.table_latency_s, tick_s, parameters.screw.nominal_m(start_m)),
            table_log_delay: LogDelay::new(latency_s(Channel::Table), sample_s, start_m),
            tool_log_delay: LogDelay::new(latency_s(Channel::Tool), sample_s, start_m),
            force_log_delay: ForceDelay::new(latency_s(Channel::Force), tick_s),
            force_path: ForcePath::new(&parameters.servo, tick_s, 0.0),
            structure_offset_m: 0.0,
            hystereses: parameters.residuals.hystereses(),
            commanded_n: 0.0,
            drive_n: 0.0,
            parameters,
        }
    }

    /// Whether it may share a register with another axis. An oscillation needs the acceleration of every step.
    fn can_be_paired(&self) -> bool {
        self.stepper.can_be_paired(&self.parameters) && self.modes.is_empty()
    }

    fn step(&mut self, step_s: f64) {
        let before = self.motion.table_m_per_s;
        self.stepper.step(&self.parameters, &mut self.motion, self.drive_n);
        self.oscillate(self.motion.table_m_per_s - before, step_s);
    }

    /// Oscillation of the tool over a step that has changed the velocity of the table by `change`, m/s.
    fn oscillate(&mut self, change: f64, step_s: f64) {
        self.modes.step(change / step_s, self.motion.table_m_per_s);
    }
}
