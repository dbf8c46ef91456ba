//! The whole machine: every axis, stepped together, and its instruments.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;
use shared::units::Position;

use super::mechanics::{AxisMotion, Stepper};
use super::parameters::AxisParameters;
use super::sensors::Sensor;
use super::structure::{self, Swing, Tables};
use crate::effects::Channel;
use crate::machine::Machine;

/// What reads the machine, the same for every axis, and what no declared model knows of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Motor encoder, m.
    pub motor: Sensor,
    /// Linear scale, m.
    pub table: Sensor,
    /// Tool-point probe, m.
    pub tool: Sensor,
    /// Force reading, N.
    pub force: Sensor,
    /// First-order lag of the drive's current loop, s; zero: none.
    pub drive_time_constant_s: f64,
    /// Seed of all noise.
    pub seed: u64,
}

impl Instruments {
    /// What a well-kept machine is measured with: encoders and scale of 10 nm, a grid encoder at the
    /// tool, and a drive whose current loop takes 0.1 ms.
    #[must_use]
    pub fn typical(seed: u64) -> Self {
        Self {
            motor: Sensor { resolution: 10e-9, noise: 10e-9 },
            table: Sensor { resolution: 10e-9, noise: 20e-9 },
            tool: Sensor { resolution: 10e-9, noise: 80e-9 },
            force: Sensor { resolution: 0.1, noise: 1.0 },
            drive_time_constant_s: 1e-4,
            seed,
        }
    }
}

/// One row of measurements of one axis, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Tool-point probe.
    pub tool_m: f64,
    /// Linear scale as logged, which may be later than the one that the controller reads.
    pub table_m: f64,
    /// Force that was asked for over the last tick.
    pub force_n: f64,
}

struct DeskAxis {
    parameters: AxisParameters,
    stepper: Stepper,
    motion: AxisMotion,
    swing: Swing,
    commanded_n: f64,
}

/// The machine on the desk.
pub struct Desk {
    names: Vec<String>,
    axes: Vec<DeskAxis>,
    instruments: Instruments,
    random: ChaCha8Rng,
    tick_s: f64,
    substeps: u32,
}

impl Desk {
    /// A machine at rest with its motors at `start_m`, stepped by the tick of its velocity loop, with as many steps in
    /// it as what is not linear asks for ([`AxisParameters::step_s`]).
    #[must_use]
    pub fn new(machine: &Machine, instruments: Instruments, start_m: &[f64]) -> Self {
        let tick_s = 1.0 / machine.velocity_rate_hz();
        let steps_s = machine.axis.values().map(|axis| AxisParameters::of(axis).step_s());
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a handful of steps a tick"
        )]
        let steps = (tick_s / steps_s.fold(tick_s, f64::min)).ceil() as u32;
        Self::with_steps(machine, instruments, start_m, steps)
    }

    /// The same with a number of steps in each tick, at least one.
    #[must_use]
    pub fn with_steps(machine: &Machine, instruments: Instruments, start_m: &[f64], steps: u32) -> Self {
        let substeps = steps.max(1);
        let tick_s = 1.0 / machine.velocity_rate_hz();
        let step_s = tick_s / f64::from(substeps);
        let parameters = machine.axis.values().map(AxisParameters::of);
        let stand = |(parameters, &start): (AxisParameters, &f64)| DeskAxis {
            stepper: Stepper::new(&parameters, instruments.drive_time_constant_s, step_s),
            motion: AxisMotion::at_rest(&parameters, start),
            swing: Swing::default(),
            commanded_n: 0.0,
            parameters,
        };
        let axes = parameters.zip(start_m).map(stand).collect();
        Self {
            names: machine.axis.keys().cloned().collect(),
            axes,
            instruments,
            random: ChaCha8Rng::seed_from_u64(instruments.seed),
            tick_s,
            substeps,
        }
    }

    /// What motor encoder and linear scale of each axis show the controller.
    pub fn read(&mut self, readings: &mut [Reading]) {
        // A place beyond the format is a machine that ran away: the following error ends the run.
        let position = |m: f64| Position::from_m(m).unwrap_or(Position(i64::MAX / 4));
        for (axis, reading) in self.axes.iter().zip(readings) {
            let motor = axis.motion.motor_m + axis.parameters.dividing_m(axis.motion.motor_m);
            reading.motor = position(self.instruments.motor.read(motor, &mut self.random));
            reading.table =
                Some(position(self.instruments.table.read(axis.motion.table_m, &mut self.random)));
        }
    }

    /// What is logged beside the controller's readings, at a time of the session.
    pub fn row(&mut self, readings: &[Reading], time_s: f64) -> Vec<Row> {
        let position_m: Vec<f64> = self.axes.iter().map(|a| a.motion.table_m).collect();
        let acceleration: Vec<f64> =
            self.axes.iter().map(|a| a.motion.table_m_per_s2(&a.parameters)).collect();
        let tables = Tables { names: &self.names, position_m: &position_m, acceleration: &acceleration };
        let mut rows = Vec::with_capacity(self.axes.len());
        for (i, axis) in self.axes.iter().enumerate() {
            let offset = axis.swing.offset_m + structure::offset_m(&axis.parameters.tool, i, &tables, time_s);
            let tool = axis.motion.table_m + offset - axis.behind_m(Channel::Tool);
            rows.push(Row {
                tool_m: self.instruments.tool.read(tool, &mut self.random),
                table_m: readings[i].table.map_or(axis.motion.table_m, Position::to_m)
                    - axis.behind_m(Channel::Table),
                force_n: self.instruments.force.read(axis.commanded_n, &mut self.random),
            });
        }
        rows
    }

    /// Moves the machine for one tick under the forces that the controller asks for, N.
    pub fn step(&mut self, forces_n: impl Iterator<Item = f64>) {
        let step_s = self.tick_s / f64::from(self.substeps);
        for (axis, force_n) in self.axes.iter_mut().zip(forces_n) {
            axis.commanded_n = force_n;
            for _ in 0..self.substeps {
                let before = axis.motion.table_m_per_s;
                axis.stepper.step(&axis.parameters, &mut axis.motion, force_n);
                if let Some(resonance) = &axis.parameters.tool.resonance {
                    let after = axis.motion.table_m_per_s;
                    axis.swing.step(resonance, (after - before) / step_s, after, step_s);
                }
            }
        }
    }
}

impl DeskAxis {
    /// How far the table moved while a late channel was on its way: v·τ − a·τ²/2.
    fn behind_m(&self, channel: Channel) -> f64 {
        let late_s =
            |late: &crate::effects::Latency| if late.channel == channel { 1e-3 * late.ms } else { 0.0 };
        let tau: f64 = self.parameters.late.iter().map(late_s).sum();
        tau * (self.motion.table_m_per_s - 0.5 * tau * self.motion.table_m_per_s2(&self.parameters))
    }
}
