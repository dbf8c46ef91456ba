//! The closed loop about the structure: cascaded position and velocity control by `shared`, section 3.2 of the paper.
//!
//! The velocity loop closes on the motor, the position loop on the scale; the probe at the tool (the paper's R-Test)
//! reads what the loop does not see.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;
use shared::config::{AxisSettings, Rates, Sensors};
use shared::interpolate::Block;
use shared::machine::{Machine, MachineError};
use shared::safety::Power;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use crate::reproduce::ReproduceError;
use link::controller::ControllerError;
use model::bodies::{Assembly, Structure};
use plant::bodies::{Moving, Push};
use plant::sensors::Sensor;
use plant::simulate::SimulationError;

/// x, y, z.
pub const AXES: usize = 3;

/// One tick for both loops, so that a force is kept as it acts: between two ticks of a slower position loop it would not be
/// even.
pub const RATES: Rates = Rates { velocity_loop_hz: 4_000.0, position_loop_divider: 1 };

/// Between the rows of a record, s.
pub const SAMPLE_S: f64 = 1.0 / RATES.velocity_loop_hz;

/// Longest run, s: a path that does not end is a fault.
const LONGEST_S: f64 = 30.0;

/// Of the drives, N: five times what the movements take.
const FORCE_LIMIT_N: f64 = 40_000.0;

/// What reads the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Motors and scales, m: what the paper calls internal.
    pub internal: Sensor,
    /// At the tool, m: what it calls external.
    pub external: Sensor,
    /// Drive force, N.
    pub force: Sensor,
    /// Of all noise.
    pub seed: u64,
}

/// A machine with its control.
#[derive(Clone, Debug)]
pub struct Bench {
    assembly: Assembly,
    settings: [AxisSettings; AXES],
    instruments: Instruments,
}

/// One row: what was seen of the three axes at one time, SI.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Where the path was.
    pub command_m: [f64; AXES],
    /// Internal.
    pub scale_m: [f64; AXES],
    /// External.
    pub tool_m: [f64; AXES],
    /// Of the drives.
    pub force_n: [f64; AXES],
}

impl Row {
    /// External less internal: the structure's error, m.
    #[must_use]
    pub fn error_m(&self, axis: usize) -> f64 {
        self.tool_m[axis] - self.scale_m[axis]
    }
}

impl Bench {
    /// A structure with control about it.
    ///
    /// # Errors
    /// Where it cannot be built.
    pub fn new(
        structure: &Structure,
        gains: Gains,
        instruments: Instruments,
    ) -> Result<Self, ReproduceError> {
        let assembly = Assembly::of(structure)?;
        let felt_kg = assembly.talk_at_rest()?.force_kg;
        let settings = std::array::from_fn(|axis| gains.settings(felt_kg[(axis, axis)]));
        Ok(Self { assembly, settings, instruments })
    }

    /// The same machine with other noise, by a number.
    #[must_use]
    pub fn reseeded(&self, number: u64) -> Self {
        let seed = self.instruments.seed.wrapping_mul(1000).wrapping_add(number);
        Self { instruments: Instruments { seed, ..self.instruments }, ..self.clone() }
    }

    /// Runs a path from a start to its end.
    ///
    /// # Errors
    /// When the control refuses it, the drives go off, or it does not end.
    pub fn run(&self, start_m: [f64; AXES], blocks: &[Block<AXES>]) -> Result<Vec<Row>, ReproduceError> {
        let tick_s = RATES.velocity_loop_hz.recip();
        let mut moving = Moving::new(&self.assembly, tick_s)?;
        let mut random = ChaCha8Rng::seed_from_u64(self.instruments.seed);
        let start = start_m.map(place);
        let mut machine = Machine::<Fixed, AXES>::new(RATES, &self.settings, start).map_err(refused)?;
        for block in blocks {
            machine.push(block).map_err(MachineError::from).map_err(refused)?;
        }
        machine.enable();
        let mut rows = Vec::new();
        for tick in 0u32.. {
            let time_s = f64::from(tick) * tick_s;
            let mut read = |middle: f64, m: f64| self.instruments.internal.read(middle + m, &mut random);
            let (motors, scales) = (moving.motors_m(), moving.scales_m());
            let motor_m: [f64; AXES] = std::array::from_fn(|axis| read(start_m[axis], motors[axis]));
            let scale_m: [f64; AXES] = std::array::from_fn(|axis| read(start_m[axis], scales[axis]));
            let reading =
                |axis: usize| Reading { motor: place(motor_m[axis]), table: Some(place(scale_m[axis])) };
            let output = machine.tick(&std::array::from_fn(reading));
            if let Power::Faulted(fault) = machine.power() {
                let what = format!("the drives went off ({fault:?})");
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
            if time_s > LONGEST_S {
                break;
            }
            for (axis, motor_n) in force_n.into_iter().enumerate() {
                moving.push(axis, Push { motor_n, ..Push::default() });
            }
            moving.step();
        }
        Err(SimulationError::Endless.into())
    }
}

/// Gains of the cascade, by what they make of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Kp of the position loop.
    pub position_per_s: f64,
    /// Gain of the velocity loop over the mass (its bandwidth), in Kp.
    pub velocity_ratio: f64,
    /// Ti of the velocity loop, in the inverse of that bandwidth.
    pub integral_ratio: f64,
}

impl Gains {
    /// Settings of an axis whose drive feels a mass.
    fn settings(self, felt_kg: f64) -> AxisSettings {
        let velocity_per_s = self.velocity_ratio * self.position_per_s;
        AxisSettings {
            position_gain_per_s: self.position_per_s,
            velocity_gain_n_s_per_m: velocity_per_s * felt_kg,
            velocity_integral_time_s: Some(self.integral_ratio / velocity_per_s),
            sensors: Sensors::Table,
            force_limit_n: FORCE_LIMIT_N,
            ..AxisSettings::default()
        }
    }
}

/// A place beyond the format is a machine that ran away: the following error ends the run.
fn place(m: f64) -> Position {
    Position::from_m(m).unwrap_or(Position(i64::MAX / 4))
}

fn refused(error: MachineError) -> ReproduceError {
    SimulationError::from(ControllerError::from(error)).into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::acceleration::machines;

    fn run(gains: Gains, block: Block<AXES>) -> Result<Vec<Row>, ReproduceError> {
        Bench::new(&machines::catalogue().unwrap(), gains, Instruments::default())
            .unwrap()
            .run([0.0; AXES], &[block])
    }

    /// At an even speed a P loop lags by v/Kp, and the drive of an axis feels its viscous friction alone.
    #[test]
    fn at_speed_the_scale_lags_by_the_speed_over_kp() {
        let rows = run(machines::GAINS, Block::line([0.0, 0.0, 0.1], 0.1, 5.0)).unwrap();
        let row = &rows[rows.len() / 2];
        let lag = row.command_m[2] - row.scale_m[2];
        assert!((lag / (0.1 / machines::GAINS.position_per_s) - 1.0).abs() < 0.01, "{lag}");
        // Four carriages of 0.1 N·s/mm; the mean, as the feet still swing a little.
        let middle = &rows[2 * rows.len() / 5..3 * rows.len() / 5];
        let force_n = numerics::mean(middle.iter().map(|row| row.force_n[2]));
        assert!((force_n / (400.0 * 0.1) - 1.0).abs() < 0.02, "{force_n}");
        // Nothing accelerates, and only the 40 N bend the ram: as much as 0.07 m/s² of its 550 kg, and −0.55 µm per
        // m/s² are −0.04 µm in x.
        let bent_m = row.error_m(0);
        assert!((-80e-9..-20e-9).contains(&bent_m), "{bent_m}");
    }

    /// A loop that does not hold is stopped with the reason, and no number that is none comes out of it.
    #[test]
    fn gains_beyond_the_structure_end_in_a_fault() {
        let gains = Gains { position_per_s: 2000.0, ..machines::GAINS };
        let error = run(gains, Block::line([0.0, 0.0, 0.1], 0.1, 5.0)).unwrap_err().to_string();
        assert!(error.starts_with("a drive is at its limit") && error.contains(" after 0."), "{error}");
    }
}
