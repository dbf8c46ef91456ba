//! The `[instruments]` table: each key in its channel, with its own size.

use files::log::Channel;
use model::machine::Machine;
use model::machine::instruments::InstrumentKeys;
use plant::instruments::Instruments;

use crate::bench::{
    PLAIN, ROUNDING_N, ROUNDING_UM, Seen, assert_all, assert_near, changed, declared, difference, lines, of,
    rms, run_with,
};

/// The machine without its spring: motor and table are one, so that one channel shows the truth of the other.
fn rigid() -> String {
    let machine = changed(PLAIN, "stiffness_n_per_um = 200.0", "# ");
    changed(&machine, "damping_n_s_per_m = 12000.0 ", "# ")
}

/// The run of a machine whose instruments are perfect but for one key.
fn run_key(machine: &str, motion: &str, key: &str, value: f64) -> Seen {
    let mut keys: Vec<(&str, f64)> =
        InstrumentKeys::default().all().iter().map(|(name, _)| (*name, 0.0)).collect();
    keys.iter_mut().find(|(name, _)| *name == key).unwrap().1 = value;
    let lines: String = keys.iter().map(|(name, value)| format!("{name} = {value:?}\n")).collect();
    run_with(&format!("{machine}\n[instruments]\n{lines}"), motion, 0.0, |machine| {
        Instruments::of(machine, 1)
    })
}

/// The same with all of them perfect.
fn run_perfect(machine: &str, motion: &str) -> Seen {
    run_key(machine, motion, "motor_noise_um", 0.0)
}

/// What a channel of the rigid machine shows beyond the truth, µm or N, beside its run with perfect instruments.
fn error(seen: &Seen, perfect: &Seen, channel: Channel) -> Vec<f64> {
    match channel {
        Channel::Motor => seen.beyond_um(Channel::Motor, Channel::Table),
        Channel::Table => seen.beyond_um(Channel::Table, Channel::Motor),
        Channel::Tool => seen.beyond_um(Channel::Tool, Channel::Table),
        _ => difference(seen.force_n(), perfect.force_n()),
    }
}

/// What is logged only, or not fed back, leaves the rest alone; the motor's reading moves everything.
fn assert_rest_is_the_same(seen: &Seen, perfect: &Seen, channel: Channel) {
    if channel != Channel::Motor {
        // The other axis is read by instruments of the same kind: x is looked at.
        for other in [Channel::Command, Channel::Motor, Channel::Table, Channel::Tool, Channel::Force] {
            let is_same = seen.channel("x", other) == perfect.channel("x", other);
            assert_eq!(is_same, other != channel, "{}", other.word());
        }
    }
}

/// White noise of the standard deviation that is written, about the truth. Of n samples its estimate has a standard
/// deviation of 1/√(2n), the mean one of σ/√n: four of each are allowed.
#[test]
fn noise() {
    let cases = [
        ("motor_noise_um", 0.05, Channel::Motor),
        ("table_noise_um", 0.3, Channel::Table),
        ("tool_noise_um", 0.4, Channel::Tool),
        ("force_noise_n", 7.0, Channel::Force),
    ];
    let motion = lines(&[(30.0, 7.3)]);
    let perfect = run_perfect(&rigid(), &motion);
    for (key, sigma, channel) in cases {
        let seen = run_key(&rigid(), &motion, key, sigma);
        let error = error(&seen, &perfect, channel);
        let n = error.len() as f64;
        assert!(n > 4000.0);
        assert_near(rms(&error), sigma, 4.0 * sigma / (2.0 * n).sqrt(), key);
        let mean = error.iter().sum::<f64>() / n;
        assert_near(mean, 0.0, 4.0 * sigma / n.sqrt(), key);
        assert_rest_is_the_same(&seen, &perfect, channel);
    }
}

/// Readings are whole steps, none further than half a step q from the truth, and evenly so: q/√12 on average.
#[test]
fn resolution() {
    let cases = [
        ("motor_resolution_um", 0.2, 1e3, Channel::Motor),
        ("table_resolution_um", 1.1, 1e3, Channel::Table),
        ("tool_resolution_um", 0.9, 1e3, Channel::Tool),
        ("force_resolution_n", 0.7, 1.0, Channel::Force),
    ];
    // Hardly at a steady speed, so that the force, too, moves through its steps.
    let motion = lines(&[(200.0, 330.0), (0.0, 330.0)]);
    let perfect = run_perfect(&rigid(), &motion);
    for (key, step, unit, channel) in cases {
        let seen = run_key(&rigid(), &motion, key, step);
        for reading in seen.channel("x", channel) {
            let steps = unit * reading / step;
            assert_near(steps, steps.round(), 1e-6, key);
        }
        let error = error(&seen, &perfect, channel);
        let most = error.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
        assert!(most > 0.45 * step && most < 0.5001 * step, "{key}: {most}");
        // Where the truth moves through the steps; of n samples the estimate has 0.45/√n, 1 %.
        let shown = seen.channel("x", channel);
        let truth: Vec<f64> = shown.iter().zip(&error).map(|(s, e)| unit * s - e).collect();
        let moves = |i: &usize| (truth[*i] - truth[i - 1]).abs() > 0.1 * step;
        let moving = of(&error, &(1..error.len()).filter(moves).collect::<Vec<_>>());
        assert!(moving.len() > 1000, "{key}: {}", moving.len());
        assert_near(rms(&moving), step / 12.0_f64.sqrt(), 0.03 * step, key);
        assert_rest_is_the_same(&seen, &perfect, channel);
    }
}

/// At a steady speed an old motor reading is v·τ behind. It is what is fed back: the reading keeps its place, and the
/// table goes ahead.
///
/// 1.3 ms are more than five ticks of the velocity loop, which crosses over at Kv/m, 270 rad/s: 0.35 rad of its phase.
#[test]
fn motor_latency() {
    let (late_ms, mm_s) = (1.3, 100.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let perfect = run_perfect(&rigid(), &motion);
    let seen = run_key(&rigid(), &motion, "motor_latency_ms", late_ms);
    for mm_s in [mm_s, -mm_s] {
        let (steady, ahead_um) = (seen.steady(mm_s), mm_s * late_ms);
        let bound_um = 1e-4 * ahead_um.abs();
        assert_all(&seen.beyond_um(Channel::Table, Channel::Motor), &steady, ahead_um, bound_um, "behind");
        assert_all(&seen.moved(Channel::Table, &perfect), &steady, ahead_um, bound_um, "table");
        assert_all(&seen.moved(Channel::Motor, &perfect), &steady, 0.0, bound_um, "motor");
        assert_all(&seen.moved(Channel::Force, &perfect), &steady, 0.0, ROUNDING_N, "force");
    }
}

/// An old scale reading is v·τ behind the tool, which is where the table is. Fed back or not decides which of the two
/// keeps its place.
#[test]
fn table_latency() {
    let (late_ms, mm_s) = (1.7, 100.0);
    let motion = lines(&[(100.0, mm_s), (0.0, mm_s)]);
    let closed = changed(&rigid(), "feedback = \"motor\"", "feedback = \"table\"");
    for (machine, is_fed_back) in [(rigid(), false), (closed, true)] {
        let perfect = run_perfect(&machine, &motion);
        let seen = run_key(&machine, &motion, "table_latency_ms", late_ms);
        if !is_fed_back {
            assert_rest_is_the_same(&seen, &perfect, Channel::Table);
        }
        for mm_s in [mm_s, -mm_s] {
            let (steady, late_um) = (seen.steady(mm_s), mm_s * late_ms);
            let bound_um = 1e-4 * late_um.abs();
            let lean_um = seen.beyond_um(Channel::Tool, Channel::Table);
            assert_all(&lean_um, &steady, late_um, bound_um, "table behind tool");
            let ahead_um = if is_fed_back { late_um } else { 0.0 };
            assert_all(&seen.moved(Channel::Tool, &perfect), &steady, ahead_um, bound_um, "tool");
        }
    }
}

/// Under a force that rises evenly a drive that lags by τ gives τ·dF/dt too little. On a guideway of the viscous
/// friction b an even acceleration a takes such a force, dF/dt = b·a: the command is higher by τ·b·a, and at a steady
/// speed as it was.
#[test]
fn drive_time_constant() {
    let (lag_ms, m_per_s2, mm_s, viscous) = (1.0, 0.5, 300.0, 20_000.0);
    let declared = format!("viscous_n_s_per_m = {:?} ", declared().mechanics.viscous_n_s_per_m.unwrap());
    let machine = changed(&rigid(), &declared, &format!("viscous_n_s_per_m = {viscous:?} "));
    // Both loops at one rate: a log at every fourth tick shows one of the four forces that answer a step of the
    // position loop, not their mean.
    let machine = changed(&machine, "sample_rate_hz = 1000.0 ", "sample_rate_hz = 4000.0 ");
    let motion = lines(&[(400.0, mm_s)]);
    let perfect = run_perfect(&machine, &motion);
    let seen = run_key(&machine, &motion, "drive_time_constant_ms", lag_ms);
    let more_n = 1e-3 * lag_ms * viscous * m_per_s2;
    let samples = seen.speeding_up(m_per_s2);
    assert_all(&seen.moved(Channel::Force, &perfect), &samples, more_n, 0.002 * more_n, "force");
    let steady = seen.steady(mm_s);
    assert_all(&seen.moved(Channel::Force, &perfect), &steady, 0.0, ROUNDING_N, "force");
    assert_all(&seen.moved(Channel::Table, &perfect), &steady, 0.0, ROUNDING_UM, "table");
}

/// A file that says nothing of its instruments has those of a well-kept machine; what it says takes their place alone.
#[test]
fn what_is_absent_is_typical() {
    let read = |text: &str| Instruments::of(&Machine::parse(text, "machine.toml").unwrap(), 3);
    let typical = Instruments::typical(3);
    assert_eq!(read(PLAIN), typical);
    let said = read(&format!("{PLAIN}\n[instruments]\ntool_noise_um = 0.5\n"));
    let mut expected = typical;
    expected.tool.noise = 0.5e-6;
    assert_eq!(said, expected);
}
