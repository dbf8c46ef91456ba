//! A structure under cascaded position and velocity control by `shared` (section 3.2 of the paper).
//!
//! The velocity loop is closed on the motor, the position loop on the scale. A probe at the tool (the paper's R-Test)
//! measures the errors outside the loops.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;
use shared::config::{AxisSettings, Rates, ScaleLimits, Sensors};
use shared::interpolate::Block;
use shared::machine::{Machine, MachineError};
use shared::safety::Power;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use super::machines::{Gains, Instruments};
use crate::reproduce::study::ReproduceError;
use model::bodies::{Assembly, Structure};
use plant::controller::ControllerError;
use plant::machine_sim::position;
use plant::multibody::{AxisForces, Multibody};
use plant::simulate::SimulationError;

/// Number of axes: x, y, z.
pub const AXES: usize = 3;

/// Index of x.
pub const X: usize = 0;

/// Index of y.
pub const Y: usize = 1;

/// Index of z.
pub const Z: usize = 2;

/// Both loops run at the same rate, so that the logged force is constant over each row. With a slower position loop it
/// would change between two rows.
pub const RATES: Rates = Rates { velocity_loop_hz: 4_000.0, position_loop_divider: 1 };

/// Time between two rows of a record, s.
pub const SAMPLE_S: f64 = 1.0 / RATES.velocity_loop_hz;

/// Time limit of a run, s: a path that takes longer is a fault.
const TIME_LIMIT_S: f64 = 30.0;

/// Force limit of each drive, N: five times the force that the movements take.
const FORCE_LIMIT_N: f64 = 40_000.0;

/// A machine with its controller and instruments.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    assembly: Assembly,
    settings: [AxisSettings; AXES],
    instruments: Instruments,
}

/// One row of a record: the three axes at one time, in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Commanded position.
    pub command_m: [f64; AXES],
    /// Reading of the scales.
    pub scale_m: [f64; AXES],
    /// Reading of the probe.
    pub tool_m: [f64; AXES],
    /// Drive forces.
    pub force_n: [f64; AXES],
}

impl Row {
    /// Error of the structure: external minus internal reading, m.
    #[must_use]
    pub fn error_m(&self, axis: usize) -> f64 {
        self.tool_m[axis] - self.scale_m[axis]
    }
}

impl ClosedLoop {
    /// A structure under control.
    ///
    /// # Errors
    /// If the structure is invalid.
    pub fn new(
        structure: &Structure,
        gains: Gains,
        instruments: Instruments,
    ) -> Result<Self, ReproduceError> {
        let assembly = Assembly::of(structure)?;
        let effective_kg = assembly.talk_at_rest()?.force_kg;
        let settings = std::array::from_fn(|axis| axis_settings(gains, effective_kg[(axis, axis)]));
        Ok(Self { assembly, settings, instruments })
    }

    /// This machine with different noise, selected by `number`.
    #[must_use]
    pub fn reseeded(&self, number: u64) -> Self {
        let seed = self.instruments.seed.wrapping_mul(1000).wrapping_add(number);
        Self { instruments: Instruments { seed, ..self.instruments }, ..self.clone() }
    }

    /// Runs a path from `start_m` to its end.
    ///
    /// # Errors
    /// If the controller rejects the path, a drive faults or reaches its force limit, or the path takes longer than 30 s.
    pub fn run(&self, start_m: [f64; AXES], blocks: &[Block<AXES>]) -> Result<Vec<Row>, ReproduceError> {
        let tick_s = RATES.velocity_loop_hz.recip();
        let mut moving = Multibody::new(&self.assembly, tick_s)?;
        let mut random = ChaCha8Rng::seed_from_u64(self.instruments.seed);
        let start = start_m.map(position);
        let mut machine = Machine::<Fixed, AXES>::new(RATES, &self.settings, start).map_err(rejected)?;
        for block in blocks {
            machine.push(block).map_err(MachineError::from).map_err(rejected)?;
        }
        machine.enable();
        let mut rows = Vec::new();
        for tick in 0u32.. {
            let time_s = f64::from(tick) * tick_s;
            let mut read = |origin: f64, m: f64| self.instruments.internal.read(origin + m, &mut random);
            let (motors, scales) = (moving.motors_m(), moving.scales_m());
            let motor_m: [f64; AXES] = std::array::from_fn(|axis| read(start_m[axis], motors[axis]));
            let scale_m: [f64; AXES] = std::array::from_fn(|axis| read(start_m[axis], scales[axis]));
            let reading = |axis: usize| Reading {
                motor: position(motor_m[axis]),
                table: Some(position(scale_m[axis])),
            };
            let output = machine.tick(&std::array::from_fn(reading));
            if let Power::Faulted(fault) = machine.power() {
                let what = format!("the drives were switched off ({fault:?})");
                return Err(SimulationError::Fault { what, time_s, hint: "" }.into());
            }
            let force_n = output.forces.map(Scalar::value);
            if force_n.iter().any(|force| force.abs() >= FORCE_LIMIT_N) {
                let what =
                    "a drive is at its limit, where nothing is proportional to acceleration".to_owned();
                return Err(SimulationError::Fault { what, time_s, hint: "" }.into());
            }
            let tool = moving.tool_m();
            rows.push(Row {
                command_m: output.commands.map(Position::to_m),
                scale_m,
                tool_m: std::array::from_fn(|axis| {
                    self.instruments.external.read(start_m[axis] + tool[axis], &mut random)
                }),
                force_n: force_n.map(|force| self.instruments.force.read(force, &mut random)),
            });
            if output.done {
                return Ok(rows);
            }
            if time_s > TIME_LIMIT_S {
                break;
            }
            for (axis, motor_n) in force_n.into_iter().enumerate() {
                moving.set_forces(axis, AxisForces { motor_n, ..AxisForces::default() });
            }
            moving.step();
        }
        Err(SimulationError::Endless { limit_s: TIME_LIMIT_S }.into())
    }
}

/// Settings of an axis with the given effective mass at its drive.
fn axis_settings(gains: Gains, effective_kg: f64) -> AxisSettings {
    let velocity_per_s = gains.velocity_ratio * gains.position_per_s;
    AxisSettings {
        position_gain_per_s: gains.position_per_s,
        velocity_gain_n_s_per_m: velocity_per_s * effective_kg,
        velocity_integral_time_s: Some(gains.integral_ratio / velocity_per_s),
        sensors: Sensors::Table(ScaleLimits::DEFAULT),
        force_limit_n: FORCE_LIMIT_N,
        ..AxisSettings::default()
    }
}

fn rejected(error: MachineError) -> ReproduceError {
    SimulationError::from(ControllerError::from(error)).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::acceleration::machines;

    fn run(gains: Gains, block: Block<AXES>) -> Result<Vec<Row>, ReproduceError> {
        ClosedLoop::new(&machines::catalogue().unwrap(), gains, Instruments::default())
            .unwrap()
            .run([0.0; AXES], &[block])
    }

    /// At constant speed a P loop lags by v/Kp, and the drive force is the viscous friction of the axis.
    #[test]
    fn at_constant_speed_the_scale_lags_by_v_over_kp() {
        let rows = run(machines::GAINS, Block::line([0.0, 0.0, 0.1], 0.1, 5.0)).unwrap();
        let row = &rows[rows.len() / 2];
        let lag = row.command_m[2] - row.scale_m[2];
        assert!((lag / (0.1 / machines::GAINS.position_per_s) - 1.0).abs() < 0.01, "{lag}");
        // Four carriages of 0.1 N·s/mm each; mean, because the machine feet still vibrate.
        let middle = &rows[2 * rows.len() / 5..3 * rows.len() / 5];
        let force_n = numerics::mean(middle.iter().map(|row| row.force_n[2]));
        assert!((force_n / (400.0 * 0.1) - 1.0).abs() < 0.02, "{force_n}");
        // Without acceleration only the 40 N of friction deflect the ram, like 0.07 m/s² on its 550 kg:
        // −0.55 µm per m/s² give −0.04 µm in x.
        let deflection_m = row.error_m(0);
        assert!((-80e-9..-20e-9).contains(&deflection_m), "{deflection_m}");
    }

    /// An unstable loop ends the run with an error that names the reason, not with NaN.
    #[test]
    fn an_unstable_loop_ends_in_a_fault() {
        let gains = Gains { position_per_s: 2000.0, ..machines::GAINS };
        let error = run(gains, Block::line([0.0, 0.0, 0.1], 0.1, 5.0)).unwrap_err().to_string();
        assert!(error.starts_with("a drive is at its limit") && error.contains(" after 0."), "{error}");
    }
}
