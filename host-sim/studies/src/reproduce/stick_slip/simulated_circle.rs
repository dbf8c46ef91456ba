//! Circular tests of the simulated machine: tables of the paper's masses under the controller, with selected effects and
//! no other disturbance.

use std::f64::consts::TAU;

use super::table_model::{RADIUS_M, SPEEDS_RAD_PER_S};
use crate::reproduce::study::ReproduceError;
use contour::circular_test::Ballbar;
use files::log::Log;
use model::effects::Effect;
use model::machine::Machine;
use motion::{PathBlock, PathShape};
use plant::instruments::Instruments;
use plant::simulate::{Run, controller};
use shared::scalar::Format;

/// The lower speed of the paper.
pub const SPEED_RAD_PER_S: f64 = SPEEDS_RAD_PER_S[0];

/// Two rigid tables without friction under P control. The velocity gains are proportional to the masses, so that both
/// axes have the same dynamics.
const MACHINE: &str = "
name = \"circular test\"
sample_rate_hz = 2000.0
velocity_loop_rate_hz = 4000.0

[axis.x]
controller = \"p\"
position_gain_per_s = 50.0
velocity_gain_n_s_per_m = 45000.0
table_mass_kg = 90.0

[axis.y]
controller = \"p\"
position_gain_per_s = 50.0
velocity_gain_n_s_per_m = 60000.0
table_mass_kg = 120.0
";

/// Position gain Kp of both axes.
pub const POSITION_GAIN_PER_S: f64 = 50.0;

/// Simulates the circular test with effects on X and Y.
///
/// # Errors
/// If the simulation fails.
pub fn simulate(effects: [Vec<Effect>; 2]) -> Result<Ballbar, ReproduceError> {
    let invalid = |error: files::error::InputError| ReproduceError::Numerics(error.to_string());
    let mut machine = Machine::parse(MACHINE, "the circular test").map_err(invalid)?;
    for (axis, effects) in machine.axis.values_mut().zip(effects) {
        axis.effect = effects;
    }
    let lap = |sense: f64| super::lap::lap(&middle_lap(&run(&machine, sense)?, sense), RADIUS_M);
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

/// One and a half turns from (R, 0).
fn run(machine: &Machine, sense: f64) -> Result<Log, ReproduceError> {
    let shape = PathShape::Arc { plane: [0, 1], centre_m: [0.0; 2], turns: 1.5 * sense };
    let blocks = [PathBlock::new(shape, RADIUS_M * SPEED_RAD_PER_S, 1.0)];
    let start_m = [RADIUS_M, 0.0];
    let mut controller = controller(machine, Format::Fixed, &start_m)?;
    let run = Run {
        machine,
        instruments: Instruments::default(),
        start_m: &start_m,
        blocks: &blocks,
        start_s: 0.0,
    };
    Ok(run.log(controller.as_mut(), |_, _, _| ())?)
}

/// Tool positions, m, of one turn; the first and the last quarter turn are discarded.
fn middle_lap(log: &Log, sense: f64) -> Vec<[f64; 2]> {
    let [x, y] = &log.axes[..] else { return Vec::new() };
    let pairs = |x: &Option<Vec<f64>>, y: &Option<Vec<f64>>| -> Vec<[f64; 2]> {
        x.iter().flatten().zip(y.iter().flatten()).map(|(x, y)| [1e-3 * x, 1e-3 * y]).collect()
    };
    let (command_m, tool_m) = (pairs(&x.command, &y.command), pairs(&x.tool, &y.tool));
    let mut turned = 0.0;
    let mut last = 0.0;
    let mut lap = Vec::new();
    for ([x, y], tool) in command_m.iter().zip(tool_m) {
        let angle = sense * libm::atan2(*y, *x);
        turned += numerics::wrapped(angle - last, TAU);
        last = angle;
        if (0.25 * TAU..1.25 * TAU).contains(&turned) {
            lap.push(tool);
        }
    }
    lap
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without effects the laps are round to the resolution of the controller's number format, some nm.
    #[test]
    fn a_machine_without_effects_runs_circles() {
        let round = simulate([vec![], vec![]]).unwrap();
        assert!(round.circular_deviation_um() < 0.03, "{}", round.circular_deviation_um());
        assert!(round.hysteresis_um() < 0.03, "{}", round.hysteresis_um());
    }
}
