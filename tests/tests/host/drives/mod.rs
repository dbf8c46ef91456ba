//! Drives that are not commanded by a force, of which the machine file declares next to nothing. The logs are those of simulators in this
//! folder, which integrate textbook equations and share no code with the plant.

mod from_cases;
mod only_tool;
mod stepper;
mod velocity;

pub use stepper::usual_logs as logs_of_a_stepper;
pub use velocity::usual_logs as logs_of_a_velocity_drive;

use files::log::{AxisLog, Log, Unit};
use model::machine::Machine;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use trace::Identification;
use trace::judge::found_effect::FoundEffect;

/// Sample time of all logs, s.
const SAMPLE_S: f64 = 1e-3;

/// Steps of the integration per sample.
const STEPS: u32 = 20;

/// What a simulator returns, at the samples, mm.
struct Simulated {
    command: Vec<f64>,
    motor: Vec<f64>,
    table: Vec<f64>,
}

/// A command, mm, over a time, s.
type Command = fn(f64) -> f64;

/// ±40 mm and ±6 mm at two frequencies: up to 110 mm/s and 0.6 m/s², with reversals at many positions.
fn swinging(t: f64) -> f64 {
    40.0 * (1.9 * t).sin() + 6.0 * (5.3 * t + 0.4).sin()
}

/// Ways of 5 to 35 mm, each in a second by a sine of the acceleration, with a rest of half a second between them.
fn stepping(t: f64) -> f64 {
    let ways_mm = [30.0, -12.0, 35.0, -25.0, 5.0, -28.0];
    let mut position_mm = 0.0;
    for i in 0..20 {
        let way_mm = ways_mm[i % ways_mm.len()];
        let share = ((t - 1.5 * i as f64 - 0.3) / 1.0).clamp(0.0, 1.0);
        let turn = std::f64::consts::TAU * share;
        position_mm += way_mm * (share - turn.sin() / std::f64::consts::TAU);
    }
    position_mm
}

/// The command and its acceleration, mm and mm/s², at a time.
fn command_and_acceleration(command: impl Fn(f64) -> f64, t: f64) -> [f64; 2] {
    let h = 1e-3;
    [command(t), (command(t + h) - 2.0 * command(t) + command(t - h)) / (h * h)]
}

/// What follows behind a gap of this width (mm): it stays until an end of the gap takes it along.
fn behind_gap(leading: &[f64], width: f64) -> Vec<f64> {
    let mut follower = leading[0];
    leading
        .iter()
        .map(|&x| {
            follower = follower.clamp(x - 0.5 * width, x + 0.5 * width);
            follower
        })
        .collect()
}

/// The log of one axis with noise of 50 nm; without the motor if it has no encoder.
fn log(name: &str, seed: u64, simulated: Simulated, has_encoder: bool) -> Log {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |values: Vec<f64>| -> Option<Vec<f64>> {
        let noisy = |mm| mm + 5e-5 * numerics::noise::sum_of_uniforms(&mut random);
        Some(values.into_iter().map(noisy).collect())
    };
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    axis.table = noisy(simulated.table);
    axis.motor = noisy(simulated.motor).filter(|_| has_encoder);
    axis.command = Some(simulated.command);
    Log::new(name, 0.0, SAMPLE_S, [axis])
}

/// A machine of one axis with these keys.
fn machine(keys: &str) -> Machine {
    Machine::parse(&format!("name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\n{keys}"), "m.toml").unwrap()
}

/// The effect of this name, and the half width of its first parameter.
fn found<'a>(trace: &'a Identification, name: &str) -> Option<(&'a FoundEffect, f64, f64)> {
    let found = trace.axes()[0].found.iter().find(|found| found.effect.name() == name)?;
    Some((found, found.effect.values()[0], found.half_widths[0]))
}

fn names(trace: &Identification) -> Vec<&'static str> {
    trace.axes()[0].found.iter().map(|found| found.effect.name()).collect()
}
