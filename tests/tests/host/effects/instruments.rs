//! The `[instruments]` table: each key in its channel, with its size.

use files::log::Channel;
use model::machine::Machine;
use model::machine::instruments::InstrumentKeys;
use plant::instruments::Instruments;

use crate::effects::runs::{
    PLAIN, ROUNDING_N, ROUNDING_UM, RunLog, assert_all, assert_near, at, changed, declared, difference,
    lines, rms, run_with,
};

/// The machine without its spring: motor and table are one mass, so that each channel gives the truth of the other.
fn rigid() -> String {
    let machine = changed(PLAIN, "stiffness_n_per_um = 200.0", "# ");
    changed(&machine, "damping_n_s_per_m = 12000.0 ", "# ")
}

/// The run of a machine with instruments that are ideal except for one key.
fn run_key(machine: &str, motion: &str, key: &str, value: f64) -> RunLog {
    let mut keys: Vec<(&str, f64)> = InstrumentKeys::default().all().map(|(name, _)| (name, 0.0)).collect();
    keys.iter_mut().find(|(name, _)| *name == key).unwrap().1 = value;
    let lines: String = keys.iter().map(|(name, value)| format!("{name} = {value:?}\n")).collect();
    run_with(&format!("{machine}\n[instruments]\n{lines}"), motion, 0.0, |machine| {
        Instruments::of(machine, 1)
    })
}

/// The run of a machine with ideal instruments.
fn run_ideal(machine: &str, motion: &str) -> RunLog {
    run_key(machine, motion, "motor_noise_um", 0.0)
}

/// Error of a channel of the rigid machine, µm or N; that of the force is against a run with ideal instruments.
fn error(effect_run: &RunLog, ideal: &RunLog, channel: Channel) -> Vec<f64> {
    match channel {
        Channel::Motor => effect_run.difference_um(Channel::Motor, Channel::Table),
        Channel::Table => effect_run.difference_um(Channel::Table, Channel::Motor),
        Channel::Tool => effect_run.difference_um(Channel::Tool, Channel::Table),
        _ => difference(effect_run.force_n(), ideal.force_n()),
    }
}

/// An instrument that is not in the loop affects its channel alone; the motor reading affects all channels.
fn assert_others_are_the_same(effect_run: &RunLog, ideal: &RunLog, channel: Channel) {
    if channel != Channel::Motor {
        // Only x: the instruments of the other axis are the same.
        for other in [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool, Channel::Force] {
            let is_same = effect_run.channel("x", other) == ideal.channel("x", other);
            assert_eq!(is_same, other != channel, "{}", other.word());
        }
    }
}

/// White noise with the given standard deviation σ and mean 0. The standard errors of their estimates from n samples
/// are σ/√(2n) and σ/√n: the bounds are four of each.
#[test]
fn noise() {
    let cases = [
        ("motor_noise_um", 0.05, Channel::Motor),
        ("table_noise_um", 0.3, Channel::Table),
        ("tool_noise_um", 0.4, Channel::Tool),
        ("force_noise_n", 7.0, Channel::Force),
    ];
    let motion = lines(&[(30.0, 7.3)]);
    let ideal = run_ideal(&rigid(), &motion);
    for (key, sigma, channel) in cases {
        let effect_run = run_key(&rigid(), &motion, key, sigma);
        let error = error(&effect_run, &ideal, channel);
        let n = error.len() as f64;
        assert!(n > 4000.0);
        assert_near(rms(&error), sigma, 4.0 * sigma / (2.0 * n).sqrt(), key);
        let mean = error.iter().sum::<f64>() / n;
        assert_near(mean, 0.0, 4.0 * sigma / n.sqrt(), key);
        assert_others_are_the_same(&effect_run, &ideal, channel);
    }
}

/// Readings are multiples of the step q with uniform errors up to q/2: q/√12 rms.
#[test]
fn resolution() {
    let cases = [
        ("motor_resolution_um", 0.2, 1e3, Channel::Motor),
        ("table_resolution_um", 1.1, 1e3, Channel::Table),
        ("tool_resolution_um", 0.9, 1e3, Channel::Tool),
        ("force_resolution_n", 0.7, 1.0, Channel::Force),
    ];
    // Mostly accelerating, so that the force, too, passes through its steps.
    let motion = lines(&[(200.0, 330.0), (0.0, 330.0)]);
    let ideal = run_ideal(&rigid(), &motion);
    for (key, step, unit, channel) in cases {
        let effect_run = run_key(&rigid(), &motion, key, step);
        for reading in effect_run.channel("x", channel) {
            let steps = unit * reading / step;
            assert_near(steps, steps.round(), 1e-6, key);
        }
        let error = error(&effect_run, &ideal, channel);
        let max = error.iter().fold(0.0, |max: f64, error| max.max(error.abs()));
        assert!(max > 0.45 * step && max < 0.5001 * step, "{key}: {max}");
        // Where the truth passes through the steps; the standard error of the estimate is 0.45/√n, 1 %.
        let readings = effect_run.channel("x", channel);
        let truth: Vec<f64> = readings.iter().zip(&error).map(|(r, e)| unit * r - e).collect();
        let moves = |i: &usize| (truth[*i] - truth[i - 1]).abs() > 0.1 * step;
        let moving = at(&error, &(1..error.len()).filter(moves).collect::<Vec<_>>());
        assert!(moving.len() > 1000, "{key}: {}", moving.len());
        assert_near(rms(&moving), step / 12.0_f64.sqrt(), 0.03 * step, key);
        assert_others_are_the_same(&effect_run, &ideal, channel);
    }
}

/// At a constant velocity a delayed motor reading lags by v·τ. As it is fed back, the reading does not change and the
/// table is ahead.
///
/// 1.3 ms are more than five ticks of the velocity loop, and 0.35 rad of its phase at the crossover Kv/m = 270 rad/s.
#[test]
fn motor_latency() {
    let (late_ms, mm_s) = (1.3, 100.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let ideal = run_ideal(&rigid(), &motion);
    let effect_run = run_key(&rigid(), &motion, "motor_latency_ms", late_ms);
    for mm_s in [mm_s, -mm_s] {
        let (steady, ahead_um) = (effect_run.steady(mm_s), mm_s * late_ms);
        let bound_um = 1e-4 * ahead_um.abs();
        assert_all(
            &effect_run.difference_um(Channel::Table, Channel::Motor),
            &steady,
            ahead_um,
            bound_um,
            "lag",
        );
        assert_all(&effect_run.change(Channel::Table, &ideal), &steady, ahead_um, bound_um, "table");
        assert_all(&effect_run.change(Channel::Motor, &ideal), &steady, 0.0, bound_um, "motor");
        assert_all(&effect_run.change(Channel::Force, &ideal), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// At a constant velocity a delayed scale reading lags by v·τ behind the tool, whose position is that of the table. If
/// the scale is fed back, its reading does not change and the tool is ahead.
#[test]
fn table_latency() {
    let (late_ms, mm_s) = (1.7, 100.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let closed = changed(&rigid(), "feedback = \"motor\"", "feedback = \"table\"");
    for (machine, is_fed_back) in [(rigid(), false), (closed, true)] {
        let ideal = run_ideal(&machine, &motion);
        let effect_run = run_key(&machine, &motion, "table_latency_ms", late_ms);
        if !is_fed_back {
            assert_others_are_the_same(&effect_run, &ideal, Channel::Table);
        }
        for mm_s in [mm_s, -mm_s] {
            let (steady, late_um) = (effect_run.steady(mm_s), mm_s * late_ms);
            let bound_um = 1e-4 * late_um.abs();
            let offset_um = effect_run.difference_um(Channel::Tool, Channel::Table);
            assert_all(&offset_um, &steady, late_um, bound_um, "table behind tool");
            let ahead_um = if is_fed_back { late_um } else { 0.0 };
            assert_all(&effect_run.change(Channel::Tool, &ideal), &steady, ahead_um, bound_um, "tool");
        }
    }
}

/// Under a ramp of the force, a drive with the lag τ is low by τ·dF/dt. On a guideway with the viscous friction b a
/// constant acceleration a needs such a ramp, dF/dt = b·a: the commanded force is higher by τ·b·a, and unchanged at a
/// constant velocity.
#[test]
fn drive_time_constant() {
    let (lag_ms, m_per_s2, mm_s, viscous) = (1.0, 0.5, 300.0, 20_000.0);
    let declared = format!("viscous_n_s_per_m = {:?} ", declared().mechanics.viscous_n_s_per_m.unwrap());
    let machine = changed(&rigid(), &declared, &format!("viscous_n_s_per_m = {viscous:?} "));
    // Both loops at the same rate: a log of every fourth tick has one of the four forces between two steps of the
    // position loop, not their mean.
    let machine = changed(&machine, "sample_rate_hz = 1000.0 ", "sample_rate_hz = 4000.0 ");
    let motion = lines(&[(400.0, mm_s)]);
    let ideal = run_ideal(&machine, &motion);
    let effect_run = run_key(&machine, &motion, "drive_time_constant_ms", lag_ms);
    let more_n = 1e-3 * lag_ms * viscous * m_per_s2;
    let samples = effect_run.accelerating(m_per_s2);
    assert_all(&effect_run.change(Channel::Force, &ideal), &samples, more_n, 0.002 * more_n, "force");
    let steady = effect_run.steady(mm_s);
    assert_all(&effect_run.change(Channel::Force, &ideal), &steady, 0.0, ROUNDING_N, "force");
    assert_all(&effect_run.change(Channel::Table, &ideal), &steady, 0.0, ROUNDING_UM, "table");
}

/// Keys that a file does not give have their typical values.
#[test]
fn absent_keys_are_typical() {
    let read = |text: &str| Instruments::of(&Machine::parse(text, "machine.toml").unwrap(), 3);
    let typical = Instruments::typical(3);
    assert_eq!(read(PLAIN), typical);
    let given = read(&format!("{PLAIN}\n[instruments]\ntool_noise_um = 0.5\n"));
    let mut expected = typical;
    expected.tool.noise = 0.5e-6;
    assert_eq!(given, expected);
}
