//! The laps of the contributors: run by the machine on the desk, or drawn from a formula.
//!
//! The machine runs the circle under the controller, with tables of the paper's masses that nothing else disturbs.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::table_model::{RADIUS_M, SPEEDS_RAD_PER_S};
use crate::reproduce::ReproduceError;
use crate::reproduce::ballbar::{Ballbar, Lap};
use files::log::Log;
use link::controller::{Format, PathBlock, PathShape};
use model::effects::Effect;
use model::machine::Machine;
use plant::instruments::Instruments;
use plant::simulate::{self, Run};

/// The lower speed.
pub const SPEED_RAD_PER_S: f64 = SPEEDS_RAD_PER_S[0];

/// Two rigid tables without friction under proportional control, alike in everything but their masses, for which the
/// velocity gains make up.
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

/// Kp of that machine.
pub const POSITION_GAIN_PER_S: f64 = 50.0;

/// How far an axis at R·cos of an angle stands off, µm, behind a hysteresis: half the width against its motion, once
/// the distance from the reversal is long enough.
#[must_use]
pub fn lag_um(angle: f64, sense: f64, width_um: f64, distance_um: f64) -> f64 {
    // From the reversal at the outside (0) the axis moves in −, from that at the inside (π) in +.
    let side = if (sense * angle).rem_euclid(TAU) < TAU / 2.0 { 1.0 } else { -1.0 };
    let travelled_um = 1e6 * RADIUS_M * (side - angle.cos()).abs();
    side * 0.5 * width_um * (1.0 - 2.0 * (-travelled_um / distance_um).exp())
}

/// How far the axes stand off, µm, when the slower one is late.
#[must_use]
pub fn late_um(angle: f64, sense: f64, delay_s: f64) -> [f64; 2] {
    let path_um = 1e6 * RADIUS_M * SPEED_RAD_PER_S * delay_s * sense;
    // Within 45° of the first axis it is the slower one.
    let is_first_slower = (angle + FRAC_PI_4).rem_euclid(TAU / 2.0) < TAU / 4.0;
    if is_first_slower { [path_um * angle.sin(), 0.0] } else { [0.0, -path_um * angle.cos()] }
}

/// The circle with a deviation (µm) of the axes that an angle and a direction (1 or −1) give.
///
/// # Errors
/// When a deviation is no number.
pub fn drawn(deviation_um: impl Fn(f64, f64) -> [f64; 2]) -> Result<Ballbar, ReproduceError> {
    const SAMPLES: usize = 14_400;
    let lap = |sense: f64| {
        let place = |i: usize| {
            // Between the reversals, never on them.
            let angle = TAU * (i as f64 + 0.5) / SAMPLES as f64;
            let [x_um, y_um] = deviation_um(angle, sense);
            [RADIUS_M * angle.cos() + 1e-6 * x_um, RADIUS_M * angle.sin() + 1e-6 * y_um]
        };
        evaluated(&(0..SAMPLES).map(place).collect::<Vec<_>>())
    };
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

/// The circle on the machine with some effects on X and Y.
///
/// # Errors
/// When the loop does not hold.
pub fn on_desk(effects: [Vec<Effect>; 2]) -> Result<Ballbar, ReproduceError> {
    let broken = |error: files::error::InputError| ReproduceError::Numerics(error.to_string());
    let mut machine = Machine::parse(MACHINE, "the circular test").map_err(broken)?;
    for (axis, effects) in machine.axis.values_mut().zip(effects) {
        axis.effect = effects;
    }
    let lap = |sense: f64| evaluated(&middle_lap(&run(&machine, sense)?, sense));
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

/// A turn and a half from (R, 0).
fn run(machine: &Machine, sense: f64) -> Result<Log, ReproduceError> {
    let shape = PathShape::Arc { plane: [0, 1], centre_m: [0.0; 2], turns: 1.5 * sense };
    let blocks = [PathBlock::new(shape, RADIUS_M * SPEED_RAD_PER_S, 1.0)];
    let start_m = [RADIUS_M, 0.0];
    let mut controller = simulate::controller(machine, Format::Fixed, &start_m)?;
    let run = Run {
        machine,
        instruments: Instruments::default(),
        start_m: &start_m,
        blocks: &blocks,
        start_s: 0.0,
    };
    Ok(run.log(controller.as_mut(), |_, _, _| ())?)
}

/// Tool positions, m, of one whole turn, a quarter turn after the start and before the end.
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
        let angle = sense * y.atan2(*x);
        turned += (angle - last + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        last = angle;
        if (0.25 * TAU..1.25 * TAU).contains(&turned) {
            lap.push(tool);
        }
    }
    lap
}

fn evaluated(path_m: &[[f64; 2]]) -> Result<Lap, ReproduceError> {
    Lap::of(path_m, RADIUS_M).ok_or_else(|| ReproduceError::Numerics("a circle without points".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without an effect the machine's laps are round to the nanometres that the controller's number format leaves.
    #[test]
    fn an_undisturbed_machine_runs_circles() {
        let round = on_desk([vec![], vec![]]).unwrap();
        assert!(round.circular_deviation_um() < 0.03, "{}", round.circular_deviation_um());
        assert!(round.hysteresis_um() < 0.03, "{}", round.hysteresis_um());
    }

    /// The closed form of the hysteresis against Dahl's rule dz = (v̂·w/2 − z)/λ·ds, integrated in small steps along
    /// a lap from what the lap before leaves.
    #[test]
    fn the_hysteresis_is_that_of_dahl() {
        const STEPS: usize = 200_000;
        let (width_um, distance_um) = (5.0, 30.0);
        let mut lag = 0.0;
        for i in 0..2 * STEPS {
            let angle = |i: usize| TAU * i as f64 / STEPS as f64;
            let step_um = 1e6 * RADIUS_M * (angle(i + 1).cos() - angle(i).cos());
            // Stands off against the motion.
            lag += (-step_um.signum() * 0.5 * width_um - lag) * step_um.abs() / distance_um;
            if i > STEPS && i % 1000 == 500 {
                let closed = lag_um(angle(i + 1), 1.0, width_um, distance_um);
                assert!((lag - closed).abs() < 0.02, "{i}: {lag} {closed}");
            }
        }
    }
}
