//! The errors of the measuring chain and of the loop, each compared with a closed form in a whole log.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::machine::Axis;
use super::motion::{Pace, Segment, sampled};
use super::pickup::Filter;
use super::plant::Sinusoid;
use super::recording::{Recorder, Recording};
use super::sensors::Sensors;
use super::tests::{SPEED_MM_PER_S, axis, line};
use super::{chain, chain_size, draw, gap, simulation};
use files::log::{Channel, Log};

/// Kp of the axis, 1/s, and its feed-forward.
const KP: f64 = 50.0;
const KF: f64 = 0.6;

/// An axis without noise.
fn ideal(change: impl Fn(&mut Axis)) -> Axis {
    let mut axis = Axis { sensors: Sensors::ideal(), ..axis(false) };
    change(&mut axis);
    axis
}

fn mean(log: &Log, channel: Channel, at: &std::ops::Range<usize>) -> f64 {
    numerics::mean(log.axes[0].channel(channel).unwrap()[at.clone()].iter().copied())
}

/// Mean of the difference of two channels of x on the way forth, mm.
fn difference(axis: &Axis, [a, b]: [Channel; 2]) -> f64 {
    let (log, [forth, _]) = line(axis);
    mean(&log, a, &forth) - mean(&log, b, &forth)
}

#[test]
fn a_late_feedback_lets_the_motor_lead_by_speed_times_its_lag() {
    let omega = chain_size::omega(60.0);
    for (filter, lag_s) in
        [(Filter::None, 0.0), (Filter::LowPass(1e-3), 1e-3), (Filter::Notch([omega, 0.4]), 0.8 / omega)]
    {
        let delay_s = 1.4e-3;
        let late = ideal(|axis| {
            axis.servo.pickup.delay_s = delay_s;
            axis.servo.pickup.filter = filter;
        });
        // v = Kp·(command + Kf/Kp·v − (motor − v·lag)).
        let expected_mm = SPEED_MM_PER_S * ((1.0 - KF) / KP - delay_s - lag_s);
        let found_mm = difference(&late, [Channel::Command, Channel::Motor]);
        // The one-sided steps of the filters are at most half a step of 50 µs: 1 µm at 40 mm/s.
        assert!((found_mm - expected_mm).abs() < 1.1e-3, "{filter:?}: {found_mm} {expected_mm}");
    }
}

#[test]
fn delays_of_velocity_and_force_leave_the_steady_motion_as_it_is() {
    let expected_mm = SPEED_MM_PER_S * (1.0 - KF) / KP;
    let changes: [fn(&mut Axis); 4] = [
        |axis| axis.servo.velocity_filter_s = 0.45e-3,
        |axis| axis.servo.delay_ticks = 1,
        |axis| axis.servo.dead_s = 0.5e-3,
        |axis| axis.servo.velocity_window_s = Some(0.1e-3),
    ];
    let plain = line(&ideal(|_| {})).0;
    for change in changes {
        let axis = ideal(change);
        let found_mm = difference(&axis, [Channel::Command, Channel::Motor]);
        assert!((found_mm - expected_mm).abs() < 5e-6, "{found_mm} {expected_mm}");
        // The way to it differs.
        let motor = |log: &Log| log.axes[0].motor.as_ref().unwrap()[10..60].to_vec();
        let apart = motor(&line(&axis).0).into_iter().zip(motor(&plain)).map(|(a, b)| a - b);
        assert!(numerics::max_abs(apart) > 1e-5);
    }
}

#[test]
fn a_weak_drive_is_commanded_more_in_its_direction_only() {
    let (plain, [forth, back]) = line(&ideal(|_| {}));
    let (weak, _) = line(&ideal(|axis| axis.servo.weakness = 0.1));
    let ratio = |at| mean(&weak, Channel::Force, at) / mean(&plain, Channel::Force, at);
    // The integral has settled: see `line`.
    assert!(
        (ratio(&forth) - 1.0 / 0.9).abs() < 1e-4 && (ratio(&back) - 1.0).abs() < 1e-4,
        "{}",
        ratio(&forth)
    );
}

#[test]
fn a_wrong_torque_constant_changes_the_logged_force_alone() {
    let (plain, [forth, _]) = line(&ideal(|_| {}));
    let (scaled, _) = line(&ideal(|axis| axis.recording.force_gain = 0.12));
    assert!(
        (mean(&scaled, Channel::Force, &forth) / mean(&plain, Channel::Force, &forth) - 1.12).abs() < 1e-6
    );
    assert_eq!(plain.axes[0].motor, scaled.axes[0].motor);
}

#[test]
fn a_turned_probe_reads_the_angle_times_the_other_axis() {
    let turn_rad = 0.4e-3;
    let turned = |sign: f64| Axis {
        sensors: Sensors::ideal(),
        recording: Recording { probe_turn_rad: sign * turn_rad, ..Recording::default() },
        ..axis(false)
    };
    // x stands at −10 mm while y moves to 30 mm.
    let pace = Pace { speed: SPEED_MM_PER_S, acceleration: 2000.0, ..Pace::default() };
    let positions = sampled([-10.0, 0.0], &[Segment::Line([-10.0, 30.0]), Segment::Dwell(0.5)], pace);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let log = simulation::run(&[turned(1.0), turned(-1.0)], &positions, 0.0, &mut random);
    let last = |axis: usize, channel| *log.axes[axis].channel(channel).unwrap().last().unwrap();
    let shift = |axis: usize| last(axis, Channel::Tool) - last(axis, Channel::Table);
    // 0.4 mrad of 30 mm and of 10 mm.
    assert!((shift(0) - 12e-3).abs() < 1e-5 && (shift(1) - 4e-3).abs() < 1e-5, "{} {}", shift(0), shift(1));
}

#[test]
fn a_long_scale_reads_more_and_moves_the_motor_only_where_it_is_in_the_loop() {
    let gain = 50e-6;
    for dual in [false, true] {
        let of = |gain: f64| {
            line(&ideal(|axis| {
                axis.scale.gain = gain;
                axis.servo.dual_s = dual.then_some(0.05);
            }))
        };
        let [(plain, [forth, _]), (long, _)] = [0.0, gain].map(of);
        let table_mm = mean(&plain, Channel::Table, &forth);
        let shift = |channel| mean(&long, channel, &forth) - mean(&plain, channel, &forth);
        // With dual feedback, the scale reads the same and the motor stands short by the gain; the filter of 50 ms follows a ramp
        // of 50 µm/m · 40 mm/s with a lag of 0.1 µm.
        let (expected_scale, expected_motor) =
            if dual { (0.0, -gain * table_mm) } else { (gain * table_mm, 0.0) };
        assert!((shift(Channel::Table) - expected_scale).abs() < 2e-4, "{dual}: {}", shift(Channel::Table));
        assert!((shift(Channel::Motor) - expected_motor).abs() < 2e-4, "{dual}: {}", shift(Channel::Motor));
    }
}

#[test]
fn a_stiffness_that_varies_stretches_by_the_force_over_that_of_the_place() {
    let wave = Sinusoid { amplitude: 0.4, period: 0.3, phase: 0.7 };
    let [(plain, [forth, _]), (varied, _)] =
        [ideal(|_| {}), ideal(|axis| axis.mechanics.stiffness_wave = wave)].map(|axis| line(&axis));
    let of = |log: &Log, channel| log.axes[0].channel(channel).unwrap()[forth.clone()].to_vec();
    let stretch = |log: &Log| {
        of(log, Channel::Motor)
            .into_iter()
            .zip(of(log, Channel::Table))
            .map(|(m, t)| m - t)
            .collect::<Vec<_>>()
    };
    let motor = of(&varied, Channel::Motor);
    for ((with, without), motor_mm) in stretch(&varied).into_iter().zip(stretch(&plain)).zip(motor) {
        let expected_mm = without / (1.0 + wave.at(1e-3 * motor_mm));
        // The stretch is 0.93 µm; its change moves the table by less than 0.1 µm in 50 ms.
        assert!((with - expected_mm).abs() < 2e-6, "{with} {expected_mm}");
    }
}

#[test]
fn drifts_add_up() {
    let drifting = Axis {
        slow_drift: Some([10e-6, 400.0]),
        drift_m_per_s: 50e-9,
        drift_m: 5e-6,
        drift_s: 8.0,
        sensors: Sensors::ideal(),
        ..axis(false)
    };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let start_s = 20.0;
    let log = simulation::run(&[drifting, axis(false)], &[[0.0; 2]; 10], start_s, &mut random);
    let [tool, table] =
        [Channel::Tool, Channel::Table].map(|channel| log.axes[0].channel(channel).unwrap()[0]);
    let expected_um = 10.0 * (1.0 - (-start_s / 400.0_f64).exp())
        + 0.05 * start_s
        + 5.0 * (1.0 - (-start_s / 8.0_f64).exp());
    assert!((1e3 * (tool - table) - expected_um).abs() < 1e-6, "{} {expected_um}", 1e3 * (tool - table));
}

#[test]
fn lost_rows_repeat_the_row_before() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let positions: Vec<[f64; 2]> = (0..5000).map(|i| [1e-3 * f64::from(i), -1e-3 * f64::from(i)]).collect();
    let mut log = simulation::run(&[axis(false), axis(false)], &positions, 0.0, &mut random);
    let recorder = Recorder { jitter_s: 0.0, repeated: 0.01 };
    recorder.lose_rows(&mut log, &mut random);
    let rows = |axis: usize| {
        let command = log.axes[axis].command.as_ref().unwrap();
        (1..command.len())
            .filter(|&row| command[row].to_bits() == command[row - 1].to_bits())
            .collect::<Vec<_>>()
    };
    // 50 of 5000, with a standard deviation of 7; of both axes at once.
    assert!((22..=78).contains(&rows(0).len()), "{}", rows(0).len());
    assert_eq!(rows(0), rows(1));
    let motor = log.axes[0].motor.as_ref().unwrap();
    assert!(rows(0).iter().all(|&row| motor[row].to_bits() == motor[row - 1].to_bits()));
}

#[test]
fn every_error_changes_the_machine_and_says_what_it_is() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    for name in chain::NAMES {
        let mut machine = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
        let before = machine.clone();
        let extras = chain::draw(name, &mut machine, &mut random);
        assert!(machine != before, "{name}");
        assert!(extras.iter().any(|extra| extra.name == name && !extra.parameters.is_empty()), "{extras:?}");
        assert_eq!(machine.declared, before.declared);
    }
    for name in gap::NAMES {
        let positions = vec![[0.0; 2]; 5];
        let mut logs = [simulation::run(&[axis(false), axis(false)], &positions, 0.0, &mut random)];
        gap::thin(name, &mut logs);
        let left =
            Channel::ALL.into_iter().filter(|&channel| logs[0].axes[1].channel(channel).is_some()).count();
        let expected = match name {
            "motor_and_force" | "coarse_log" | "motor_and_tool" | "no_drive" => 3,
            "tool_alone" => 2,
            "no_force" | "no_table" => 4,
            _ => 5,
        };
        assert_eq!(left, expected, "{name}");
    }
}
