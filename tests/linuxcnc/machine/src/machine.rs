//! The machine of a machine file over one servo period.

use std::path::Path;

use files::error::InputError;
use model::machine::Machine;
use plant::instruments::Instruments;
use plant::machine_sim::MachineSim;
use plant::parameters::AxisParameters;
use shared::axis::Reading;
use shared::units::Position;

use crate::drive::{Command, Drive};

/// Axes of the component's pins.
pub const AXES: usize = 2;

/// Seed of the noise of all sensors.
const SEED: u64 = 1;

/// The pins of one axis.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisPins {
    /// Position (mm), velocity (mm/s) or force (N) of the motor that is commanded.
    pub command: f64,
    /// Reading of the motor encoder, mm.
    pub motor: f64,
    /// Change of that reading over the last servo period, mm/s.
    pub velocity: f64,
    /// Reading of the linear scale, mm.
    pub scale: f64,
    /// Reading of a probe at the tool, mm.
    pub tool: f64,
    /// Force at the end of the last servo period, N.
    pub force: f64,
}

/// A machine with its drives.
pub struct SimulatedMachine {
    sim: MachineSim,
    command: Command,
    drives: Vec<Drive>,
    readings: Vec<Reading>,
    forces_n: Vec<f64>,
    period_s: f64,
    ticks: u32,
    time_s: f64,
}

impl SimulatedMachine {
    /// The machine of a file, at rest with all axes at zero. A servo period is that of its `sample_rate_hz`.
    ///
    /// # Errors
    /// A machine file that is not one, has another number of axes, or lacks a key of its drives.
    pub fn read(path: &Path, command: Command) -> Result<Self, InputError> {
        let machine = Machine::read(path)?;
        let source = path.display().to_string();
        if machine.axis.len() != AXES {
            let found = format!("{} axes", machine.axis.len());
            return Err(InputError::expected(&source, "a machine of 2 axes", found));
        }
        let sim = MachineSim::new(&machine, Instruments::of(&machine, SEED), &[0.0; AXES])
            .map_err(|error| InputError::new(&source, error.to_string()))?;
        let rates = machine.rates();
        let drive = |((name, axis), parameters): ((&String, &model::machine::Axis), AxisParameters)| {
            Drive::at_rest(command, &axis.settings, &parameters, rates, Position(0))
                .map_err(|key| InputError::new(&source, format!("axis.{name}.{key}: expected for its drive")))
        };
        let parameters = AxisParameters::of_machine(&machine);
        let drives = machine.axis.iter().zip(parameters).map(drive).collect::<Result<_, InputError>>()?;
        let mut machine = Self {
            sim,
            command,
            drives,
            readings: vec![Reading { motor: Position(0), table: None }; AXES],
            forces_n: vec![0.0; AXES],
            period_s: 1.0 / machine.sample_rate_hz,
            ticks: rates.position_loop_divider,
            time_s: 0.0,
        };
        machine.sim.read(&mut machine.readings);
        Ok(machine)
    }

    /// A servo period, s.
    #[must_use]
    pub const fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Moves the machine over one servo period by the commands of its pins, and sets the others. `false`: a reading is not finite.
    pub fn step(&mut self, pins: &mut [AxisPins; AXES]) -> bool {
        let unit = self.command.unit();
        let before: [Position; AXES] = std::array::from_fn(|i| self.readings[i].motor);
        for tick in 0..self.ticks {
            let timing = [f64::from(tick) / f64::from(self.ticks), self.period_s];
            for (i, drive) in self.drives.iter_mut().enumerate() {
                self.forces_n[i] = drive.force_n(unit * pins[i].command, timing, self.readings[i].motor);
            }
            self.sim.step(self.forces_n.iter().copied());
            self.sim.read(&mut self.readings);
        }
        self.time_s += self.period_s;
        let measured = self.sim.measure(&self.readings, self.forces_n.iter().copied(), self.time_s);
        for (i, drive) in self.drives.iter_mut().enumerate() {
            drive.end_period(unit * pins[i].command);
            let (motor, measured) = (self.readings[i].motor, &measured[i]);
            pins[i] = AxisPins {
                command: pins[i].command,
                motor: 1e3 * (motor.to_m() + measured.motor_offset_m),
                velocity: 1e3 * (motor.to_m() - before[i].to_m()) / self.period_s,
                scale: 1e3 * measured.table_m,
                tool: 1e3 * measured.tool_m,
                force: measured.force_n,
            };
        }
        pins.iter().all(|pins| [pins.motor, pins.scale, pins.tool].iter().all(|value| value.is_finite()))
    }
}

#[cfg(test)]
mod tests;
