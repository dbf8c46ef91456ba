//! The whole machine: every axis, stepped together, and its instruments.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;
use shared::units::Position;
use wide::f64x2;

use super::delay::{Delay, Late, LateForce};
use super::instruments::Instruments;
use super::mechanics::Stepper;
use super::motion::{AxisMotion, Motion};
use super::parameters::AxisParameters;
use super::structure::{self, Swing, SwingStep, Tables};
use super::together::Together;
use model::bodies::StructureError;
use model::effects::Channel;
use model::machine::Machine;

/// One row of measurements of one axis, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Tool-point probe.
    pub tool_m: f64,
    /// Linear scale as logged, which may be later than the one that the controller reads.
    pub table_m: f64,
    /// Force that was asked for over the last tick; an effect may make that another time.
    pub force_n: f64,
}

struct DeskAxis {
    parameters: AxisParameters,
    stepper: Stepper<f64>,
    motion: AxisMotion,
    swing: Swing,
    swings: Option<SwingStep>,
    motor_delay: Option<Delay>,
    table_delay: Option<Delay>,
    /// Of the channels that are logged late.
    logged_table: Late,
    logged_tool: Late,
    logged_force: Option<LateForce>,
    /// Where the bodies of a structure have the tool, beyond the table, m.
    leaning_m: f64,
    commanded_n: f64,
}

/// Axes that are moved together: neighbours that have nothing that asks for more go beside each other.
enum Group {
    Alone(usize),
    /// The first of two, and how both move.
    Two(usize, Box<Stepper<f64x2>>),
}

/// The machine on the desk.
pub struct Desk {
    names: Vec<String>,
    axes: Vec<DeskAxis>,
    groups: Vec<Group>,
    /// The bodies of the structure, where the machine file has them.
    together: Option<Together>,
    instruments: Instruments,
    random: ChaCha8Rng,
    step_s: f64,
    substeps: u32,
}

impl Desk {
    /// A machine at rest with its motors at `start_m`, stepped by the tick of its velocity loop, with as many steps in
    /// it as what is not linear asks for ([`AxisParameters::step_s`]).
    ///
    /// # Errors
    /// Where its structure cannot be built.
    pub fn new(machine: &Machine, instruments: Instruments, start_m: &[f64]) -> Result<Self, StructureError> {
        let tick_s = 1.0 / machine.velocity_rate_hz();
        let steps_s = AxisParameters::of_all(machine).into_iter().map(|axis| axis.step_s());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a handful of steps a tick"
        )]
        let steps = (tick_s / numerics::min(steps_s).min(tick_s)).ceil() as u32;
        Self::with_steps(machine, instruments, start_m, steps)
    }

    /// The same with a number of steps in each tick, at least one.
    ///
    /// # Errors
    /// Where its structure cannot be built.
    pub fn with_steps(
        machine: &Machine,
        instruments: Instruments,
        start_m: &[f64],
        steps: u32,
    ) -> Result<Self, StructureError> {
        let substeps = steps.max(1);
        let tick_s = 1.0 / machine.velocity_rate_hz();
        let (step_s, sample_s) = (tick_s / f64::from(substeps), 1.0 / machine.sample_rate_hz);
        let parameters = AxisParameters::of_all(machine);
        let lag_s = instruments.drive_time_constant_s;
        let together = match &machine.structure {
            Some(bodies) => Some(Together::new(bodies, &parameters, start_m, lag_s, step_s)?),
            None => None,
        };
        let stand = |(parameters, &start): (AxisParameters, &f64)| DeskAxis {
            stepper: Stepper::new(&parameters, instruments.drive_time_constant_s, step_s),
            motion: AxisMotion::at_rest(&parameters, start),
            swing: Swing::default(),
            swings: parameters.tool.resonance.as_ref().map(|resonance| SwingStep::new(resonance, step_s)),
            motor_delay: Delay::new(instruments.motor_latency_s, tick_s, start),
            table_delay: Delay::new(instruments.table_latency_s, tick_s, parameters.screw.nominal_m(start)),
            logged_table: Late::new(parameters.late_s(Channel::Table), sample_s, start),
            logged_tool: Late::new(parameters.late_s(Channel::Tool), sample_s, start),
            logged_force: LateForce::new(parameters.late_s(Channel::Force), tick_s),
            leaning_m: 0.0,
            commanded_n: 0.0,
            parameters,
        };
        let axes: Vec<DeskAxis> = parameters.into_iter().zip(start_m).map(stand).collect();
        Ok(Self {
            names: machine.axis.keys().cloned().collect(),
            groups: groups(&axes),
            axes,
            together,
            instruments,
            random: ChaCha8Rng::seed_from_u64(instruments.seed),
            step_s,
            substeps,
        })
    }

    /// What motor encoder and linear scale of each axis show the controller.
    pub fn read(&mut self, readings: &mut [Reading]) {
        // A place beyond the format is a machine that ran away: the following error ends the run.
        let position = |m: f64| Position::from_m(m).unwrap_or(Position(i64::MAX / 4));
        for (axis, reading) in self.axes.iter_mut().zip(readings) {
            let AxisMotion { motor_m, motor_m_per_s, table_m, table_m_per_s, .. } = axis.motion;
            let late = |delay: &mut Option<Delay>, place_m, velocity| match delay {
                Some(delay) => delay.read(place_m, velocity),
                None => place_m,
            };
            let motor_m = late(&mut axis.motor_delay, motor_m, motor_m_per_s);
            let table_m = late(&mut axis.table_delay, table_m, table_m_per_s);
            let motor_m = motor_m + axis.parameters.dividing_m(motor_m);
            reading.motor = position(self.instruments.motor.read(motor_m, &mut self.random));
            reading.table = Some(position(self.instruments.table.read(table_m, &mut self.random)));
        }
    }

    /// What is logged beside the controller's readings, at a time of the session, when these forces (N) come next.
    pub fn row(
        &mut self,
        readings: &[Reading],
        coming_n: impl Iterator<Item = f64>,
        time_s: f64,
    ) -> Vec<Row> {
        let position_m: Vec<f64> = self.axes.iter().map(|a| a.motion.table_m).collect();
        let acceleration: Vec<f64> = self.axes.iter().map(|axis| self.table_m_per_s2(axis)).collect();
        let tables = Tables { names: &self.names, position_m: &position_m, acceleration: &acceleration };
        let mut rows = Vec::with_capacity(self.axes.len());
        for ((i, axis), coming_n) in self.axes.iter_mut().enumerate().zip(coming_n) {
            let offset = axis.swing.offset_m + structure::offset_m(&axis.parameters.tool, i, &tables, time_s);
            let AxisMotion { table_m, table_m_per_s, .. } = axis.motion;
            let behind =
                |channel: &mut Late, place_m| channel.behind_m(place_m, table_m_per_s, acceleration[i]);
            let tool_m = table_m + axis.leaning_m + offset;
            let tool_m = tool_m - behind(&mut axis.logged_tool, tool_m);
            let force_n = axis.logged_force.as_ref().map_or(axis.commanded_n, |late| late.logged_n(coming_n));
            rows.push(Row {
                tool_m: self.instruments.tool.read(tool_m, &mut self.random),
                table_m: readings[i].table.map_or(table_m, Position::to_m)
                    - behind(&mut axis.logged_table, table_m),
                force_n: self.instruments.force.read(force_n, &mut self.random),
            });
        }
        rows
    }

    fn table_m_per_s2(&self, axis: &DeskAxis) -> f64 {
        match &self.together {
            None => axis.motion.table_m_per_s2(&axis.parameters),
            Some(together) => together.table_m_per_s2(&axis.motion),
        }
    }

    /// Moves the machine for one tick under the forces that the controller asks for, N.
    pub fn step(&mut self, forces_n: impl Iterator<Item = f64>) {
        for (axis, force_n) in self.axes.iter_mut().zip(forces_n) {
            axis.commanded_n = force_n;
            if let Some(late) = &mut axis.logged_force {
                late.give(force_n);
            }
        }
        match &mut self.together {
            None => {
                for group in &self.groups {
                    match group {
                        Group::Alone(axis) => {
                            let axis = &mut self.axes[*axis];
                            (0..self.substeps).for_each(|_| axis.step(self.step_s));
                        }
                        Group::Two(first, stepper) => {
                            if let [a, b] = &mut self.axes[*first..*first + 2] {
                                step_two(stepper, [a, b], self.substeps);
                            }
                        }
                    }
                }
            }
            Some(together) => {
                (0..self.substeps).for_each(|_| step_together(together, &mut self.axes, self.step_s));
            }
        }
    }
}

/// Neighbours beside each other, from the first on, where they may go so.
fn groups(axes: &[DeskAxis]) -> Vec<Group> {
    let mut groups = Vec::new();
    let mut first = 0;
    while first < axes.len() {
        let two = match &axes[first..] {
            [a, b, ..] if a.is_smooth() && b.is_smooth() => Stepper::beside([&a.stepper, &b.stepper]),
            _ => None,
        };
        first += if two.is_some() { 2 } else { 1 };
        groups.push(two.map_or(Group::Alone(first - 1), |stepper| Group::Two(first - 2, Box::new(stepper))));
    }
    groups
}

fn step_two(stepper: &Stepper<f64x2>, axes: [&mut DeskAxis; 2], steps: u32) {
    let [a, b] = axes;
    let mut motion = Motion::beside([&a.motion, &b.motion]);
    let force_n = f64x2::new([a.commanded_n, b.commanded_n]);
    for _ in 0..steps {
        stepper.step([&a.parameters, &b.parameters], &mut motion, force_n);
    }
    (a.motion, b.motion) = (motion.axis(0), motion.axis(1));
}

fn step_together(together: &mut Together, axes: &mut [DeskAxis], step_s: f64) {
    for (i, axis) in axes.iter_mut().enumerate() {
        together.drive(i, &axis.parameters, &mut axis.motion, axis.commanded_n);
    }
    for (i, axis) in axes.iter_mut().enumerate() {
        together.slide(i, &axis.parameters, &mut axis.motion);
    }
    together.step();
    for (i, axis) in axes.iter_mut().enumerate() {
        axis.leaning_m = together.show(i, &mut axis.motion);
        let change = axis.motion.table_change;
        axis.swing_on(change, step_s);
    }
}

impl DeskAxis {
    /// Whether it may go beside another axis.
    fn is_smooth(&self) -> bool {
        self.stepper.is_smooth(&self.parameters) && self.parameters.tool.resonance.is_none()
    }

    fn step(&mut self, step_s: f64) {
        let before = self.motion.table_m_per_s;
        self.stepper.step(&self.parameters, &mut self.motion, self.commanded_n);
        self.swing_on(self.motion.table_m_per_s - before, step_s);
    }

    /// The tool's own swing, after the table's velocity has changed in a step.
    fn swing_on(&mut self, change: f64, step_s: f64) {
        if let Some(step) = &self.swings {
            self.swing.step(step, change / step_s, self.motion.table_m_per_s);
        }
    }
}
