//! The mechanisms of the kinds beyond the textbook, each compared with a closed form.

use std::f64::consts::TAU;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::joint;
use super::machine::Axis;
use super::motion::{Pace, Segment, sampled};
use super::plant::{Mechanics, SLIPPING, Sinusoid, State};
use super::sensors::Sensors;
use super::servo::SAMPLE_S;
use super::simulation;
use super::tests::{SPEED_MM_PER_S, axis, line, mechanics};
use files::log::{Channel, Log};

/// Steps of 1 s of simulated time.
const STEPS_PER_S: u32 = 20_000;

/// An axis without noise.
fn ideal(change: impl Fn(&mut Axis)) -> Axis {
    let mut axis = Axis { sensors: Sensors::ideal(), ..axis(false) };
    change(&mut axis);
    axis
}

/// Difference of two channels of x over samples, mm.
fn difference(log: &Log, of: [Channel; 2], at: std::ops::Range<usize>) -> Vec<f64> {
    let [a, b] = of.map(|channel| &log.axes[0].channel(channel).unwrap()[at.clone()]);
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Mean force over samples of a log of x, N.
fn mean_force(log: &Log, at: &std::ops::Range<usize>) -> f64 {
    numerics::mean(log.axes[0].force.as_ref().unwrap()[at.clone()].iter().copied())
}

#[test]
fn waves_of_the_screw_move_the_table_and_their_sum_is_that_of_each() {
    let waves = [(6.0, 55.0, 0.3), (3.0, 130.0, 2.0), (1.5, 37.0, 4.0)].map(|(um, mm, phase)| Sinusoid {
        amplitude: 1e-6 * um,
        period: 1e-3 * mm,
        phase,
    });
    let [(plain, [forth, _]), (shaped, _)] =
        [ideal(|_| {}), ideal(|axis| axis.mechanics.screw_waves = waves.to_vec())].map(|axis| line(&axis));
    let lost = |log: &Log| difference(log, [Channel::Table, Channel::Motor], forth.clone());
    let motor = &shaped.axes[0].motor.as_ref().unwrap()[forth.clone()];
    for ((with, without), motor_mm) in lost(&shaped).iter().zip(lost(&plain)).zip(motor) {
        let expected_mm: f64 = waves
            .iter()
            .map(|wave| 1e3 * wave.amplitude * (TAU * 1e-3 * motor_mm / wave.period + wave.phase).sin())
            .sum();
        // The table accelerates by A·(2πv/period)² < 1e-3 m/s² of 150 kg: 0.2 N of 200 N/µm; the friction b·v changes by
        // still less.
        assert!((with - without - expected_mm).abs() < 5e-6, "{} {expected_mm}", with - without);
    }
}

/// Spring and elements carry the friction together: k·stretch + 60 N·z is what the spring alone carries without them. z follows from the stretch that the log has: each
/// element sticks until it carries its part, and slips then.
#[test]
fn a_gear_carries_what_the_history_of_its_stretch_says() {
    let travel_m = 3e-7;
    let gear = |axis: &mut Axis| axis.mechanics.slipping = joint::slipping(60.0, travel_m);
    let [(plain, _), (with_gear, [forth, back])] = [ideal(|_| {}), ideal(gear)].map(|axis| line(&axis));
    let stretch_mm = |log: &Log, at| difference(log, [Channel::Motor, Channel::Table], at);
    let (mut carried, mut before_mm) = ([0.0_f64; SLIPPING], 0.0);
    let mut z_of = |stretch_mm: f64| {
        for (carried, slips_at) in carried.iter_mut().zip(joint::SLIPS_AT) {
            *carried = (*carried + (stretch_mm - before_mm) / (1e3 * travel_m * slips_at)).clamp(-1.0, 1.0);
        }
        before_mm = stretch_mm;
        numerics::mean(carried)
    };
    let z: Vec<f64> = stretch_mm(&with_gear, 0..with_gear.len()).into_iter().map(&mut z_of).collect();
    for at in [forth, back] {
        let of_samples = stretch_mm(&with_gear, at.clone()).into_iter().zip(stretch_mm(&plain, at.clone()));
        for ((with, without), z) in of_samples.zip(&z[at]) {
            // 200 N/µm. Between two samples of a stretch of 1.5 µm that swings at 250 Hz it turns some nm further: 1 % of the travel.
            let expected_mm = without - 60.0 / 200e3 * z;
            assert!(z.abs() > 0.1 && (with - expected_mm).abs() < 5e-6, "{with} {expected_mm} {z}");
        }
    }
}

#[test]
fn a_varying_gap_is_as_wide_as_its_place_says() {
    let (width_m, variation, period_m) = (8e-6, 0.6, 0.16);
    let gap = |axis: &mut Axis| {
        axis.mechanics.backlash_m = width_m;
        axis.mechanics.backlash_wave = Sinusoid { amplitude: variation, period: period_m, phase: 0.0 };
    };
    let [(plain, _), (with_gap, [forth, back])] = [ideal(|_| {}), ideal(gap)].map(|axis| line(&axis));
    for (at, sign) in [(forth, 1.0), (back, -1.0)] {
        let lost = |log: &Log| difference(log, [Channel::Motor, Channel::Table], at.clone());
        let motor = &with_gap.axes[0].motor.as_ref().unwrap()[at.clone()];
        for ((with, without), motor_mm) in lost(&with_gap).iter().zip(lost(&plain)).zip(motor) {
            let half_mm = 0.5e3 * width_m * (1.0 + variation * (TAU * 1e-3 * motor_mm / period_m).sin());
            // The flank of the gap moves the table as a wave of 2.4 µm does: see above.
            assert!((with - without - sign * half_mm).abs() < 5e-6, "{} {half_mm}", with - without);
        }
    }
}

#[test]
fn a_load_that_grows_along_the_travel_stretches_the_spring_by_load_over_stiffness() {
    let slope_n_per_m = 2000.0;
    let [(plain, [forth, _]), (dragged, _)] =
        [ideal(|_| {}), ideal(|axis| axis.mechanics.load_n_per_m = slope_n_per_m)].map(|axis| line(&axis));
    let stretch = |log: &Log| difference(log, [Channel::Motor, Channel::Table], forth.clone());
    let table = &dragged.axes[0].table.as_ref().unwrap()[forth.clone()];
    for ((with, without), table_mm) in stretch(&dragged).iter().zip(stretch(&plain)).zip(table) {
        let expected_mm = 1e3 * slope_n_per_m * 1e-3 * table_mm / 200e6;
        assert!((with - without - expected_mm).abs() < 1e-6, "{} {expected_mm}", with - without);
    }
    // The motor gives the force: over 400 samples at 40 mm/s around the middle of the range.
    let middle_mm = numerics::mean(table.iter().copied());
    let extra_n = mean_force(&dragged, &forth) - mean_force(&plain, &forth);
    assert!((extra_n - slope_n_per_m * 1e-3 * middle_mm).abs() < 0.5, "{extra_n} {middle_mm}");
}

/// Speed to which a plant settles under a force, and the friction that is not viscous there, F − b·v, at a time.
fn settled(plant: &Mechanics, force_n: f64, start_s: f64, seconds: u32) -> (f64, State) {
    let mut state = State { time_s: start_s, ..State::resting(0.0) };
    for _ in 0..seconds * STEPS_PER_S {
        plant.step(&mut state, force_n);
    }
    (force_n - plant.viscous_n_s_per_m * state.table_m_per_s, state)
}

#[test]
fn friction_that_warms_up_has_its_value_at_the_time_of_the_session() {
    let (warm_up_n, warm_up_s) = (60.0, 40.0);
    let plant = Mechanics { warm_up_n, warm_up_s, ..mechanics() };
    for start_s in [0.0, 80.0] {
        let (friction_n, state) = settled(&plant, 500.0, start_s, 3);
        assert!((state.time_s - start_s - 3.0).abs() < 1e-6);
        // While the friction falls at W/τ·exp(−t/τ), the speed lags by m/b = 0.28 s: m·dv/dt = m/b·dF/dt.
        let now_n = warm_up_n * (-state.time_s / warm_up_s).exp();
        let lag_n = 250.0 / 900.0 * now_n / warm_up_s;
        // 40 N and 150 N are the other friction; the speed has settled to e^(−3/0.28) of some 0.3 m/s.
        assert!((friction_n - 190.0 - now_n - lag_n).abs() < 0.05, "{friction_n} {now_n} {lag_n}");
    }
}

#[test]
fn friction_over_the_position_is_that_of_the_place() {
    let wave = Sinusoid { amplitude: 40.0, period: 0.12, phase: 0.5 };
    let [(plain, [forth, back]), (uneven, _)] =
        [ideal(|_| {}), ideal(|axis| axis.mechanics.friction_waves = vec![wave])].map(|axis| line(&axis));
    for (at, sign) in [(forth, 1.0), (back, -1.0)] {
        let stretch = |log: &Log| difference(log, [Channel::Motor, Channel::Table], at.clone());
        let table = &uneven.axes[0].table.as_ref().unwrap()[at.clone()];
        for ((with, without), table_mm) in stretch(&uneven).iter().zip(stretch(&plain)).zip(table) {
            let expected_mm = sign * 1e3 * wave.at(1e-3 * table_mm) / 200e6;
            // A bristle of 150 N/40 N/µm follows after some 4 µm of travel, 0.1 ms: 40 N·2π/0.12 m·4 µm = 0.01 N.
            assert!((with - without - expected_mm).abs() < 2e-6, "{} {expected_mm}", with - without);
        }
    }
}

#[test]
fn friction_of_the_motor_near_standstill_loads_the_motor_but_not_the_spring() {
    let (motor_stribeck_n, speed) = (50.0, 0.12);
    let plant = Mechanics { motor_stribeck_n, motor_stribeck_m_per_s: speed, ..mechanics() };
    let (friction_n, state) = settled(&plant, 300.0, 0.0, 10);
    let ratio = state.motor_m_per_s / speed;
    // tanh(v/0.2 mm/s) is 1 at the settled speed of some cm/s. There the friction falls by less than half of b·v, so that
    // the speed settles with a time constant below 0.6 s: e^(−17) is left.
    let expected_n = 40.0 + 150.0 + motor_stribeck_n * (-ratio * ratio).exp();
    assert!(
        (friction_n - expected_n).abs() < 1e-4 && (0.5..1.0).contains(&ratio),
        "{friction_n} {expected_n} {ratio}"
    );
    // The spring carries the friction of the table only.
    let stretch_m = (150.0 + 900.0 * state.table_m_per_s) / 200e6;
    assert!((state.motor_m - state.table_m - stretch_m).abs() < 1e-9);
}

#[test]
fn an_encoder_with_steps_reads_whole_steps_and_the_loop_follows_them() {
    let step_m = 0.5e-6;
    let coarse = ideal(|axis| {
        axis.encoder_step_m = step_m;
        axis.sensors.motor.steps_per_unit = 1e-3 / step_m;
    });
    let (log, [forth, _]) = line(&coarse);
    let steps = log.axes[0].motor.as_ref().unwrap().iter().map(|mm| 1e-3 * mm / step_m);
    assert!(steps.clone().all(|step| (step - step.round()).abs() < 1e-6));
    // One step in one tick of the velocity loop is Kv·q/0.25 ms = 120 N; at 40 mm/s the number of steps per tick, 20,
    // rarely differs by more than one.
    let force = &log.axes[0].force.as_ref().unwrap()[forth.clone()];
    let mean_n = numerics::mean(force.iter().copied());
    let scatter_n = numerics::rms(force.iter().map(|force| force - mean_n));
    let step_n = 60e3 * step_m / 0.25e-3;
    assert!(scatter_n > 0.05 * step_n && scatter_n < step_n, "{scatter_n}");
    // On average the loop follows as without steps.
    let following = numerics::mean(difference(&log, [Channel::Command, Channel::Motor], forth));
    assert!((following - SPEED_MM_PER_S / 50.0 * (1.0 - 0.6)).abs() < 2e-4, "{following}");
}

#[test]
fn an_averaged_speed_has_a_jerk_of_acceleration_over_its_time_and_ends_that_much_later() {
    let path = [Segment::Line([30.0, 40.0])];
    let pace = Pace { speed: 50.0, acceleration: 1000.0, averaged_samples: 0 };
    let averaged = Pace { averaged_samples: 25, ..pace };
    let [sharp, smooth] = [pace, averaged].map(|pace| sampled([0.0; 2], &path, pace));
    assert_eq!(smooth.len(), sharp.len() + 24);
    assert_eq!(smooth[smooth.len() - 1].map(f64::to_bits), [30.0_f64, 40.0].map(f64::to_bits));
    let differences = |values: &[f64]| -> Vec<f64> {
        values.windows(2).map(|pair| (pair[1] - pair[0]) / SAMPLE_S).collect()
    };
    let jerk = |positions: &[[f64; 2]]| {
        let lengths: Vec<f64> = positions.iter().map(|[x, y]| x.hypot(*y)).collect();
        numerics::max_abs(differences(&differences(&differences(&lengths))))
    };
    // 1000 mm/s² in 25 ms; without the average, in one sample.
    assert!((jerk(&smooth) / (1000.0 / 25e-3) - 1.0).abs() < 0.01, "{}", jerk(&smooth));
    assert!(jerk(&sharp) > 0.4 * 1000.0 / SAMPLE_S, "{}", jerk(&sharp));
}

#[test]
fn declared_settings_that_are_not_the_true_ones_change_the_following_error_as_in_theory() {
    use super::effect;
    use super::truth::Truth;
    let apply = |axis: &mut Axis, name: &'static str, parameters: Vec<(&'static str, f64)>| {
        effect::apply(&Truth { name, axis: "x", parameters, reference: None, phase_rad: 0.0 }, axis);
    };
    // v/Kp·(1 − Kf), with Kf of 60 % and 12 percentage points more.
    let (log, [forth, _]) = line(&ideal(|axis| apply(axis, "feedforward_mismatch", vec![("percent", 12.0)])));
    let following = numerics::mean(difference(&log, [Channel::Command, Channel::Motor], forth));
    assert!((following - SPEED_MM_PER_S / 50.0 * (1.0 - 0.72)).abs() < 5e-6, "{following}");
    let changed = ideal(|axis| {
        apply(axis, "velocity_gain_mismatch", vec![("percent", -10.0)]);
        apply(axis, "integral_time_mismatch", vec![("percent", 25.0)]);
        apply(axis, "drive_lag", vec![("ms", 0.3)]);
    });
    let expected = [54e3, 0.025, 0.3e-3];
    let servo = [changed.servo.velocity_gain_n_s_per_m, changed.servo.integral_s, changed.servo.lag_s];
    for (value, expected) in servo.into_iter().zip(expected) {
        assert!((value / expected - 1.0).abs() < 1e-12, "{value} {expected}");
    }
}

#[test]
fn every_effect_changes_the_axis_and_a_scaled_one_its_size() {
    use super::{draw, effect, truth};
    let mut random = ChaCha8Rng::seed_from_u64(9);
    let machine = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
    for name in truth::NAMES {
        let drawn = effect::draw(name, 0, &machine, &mut random);
        let mut changed = machine.axes[0].clone();
        effect::apply(&drawn, &mut changed);
        assert!(changed != machine.axes[0], "{name}");
        let half = effect::scaled(&drawn, 0.5, 300.0);
        let ratio = half.parameters[0].1 / drawn.parameters[0].1;
        let expected = match name {
            // 1/k = 1/300 + 0.5·(1/k − 1/300).
            "windup" => 2.0 / (1.0 + drawn.parameters[0].1 / 300.0),
            "resonance" => 2_f64.sqrt(),
            _ => 0.5,
        };
        assert!((ratio / expected - 1.0).abs() < 1e-12, "{name} {ratio} {expected}");
    }
    for seed in 0..20 {
        let controller = effect::draw_controller(1, &mut ChaCha8Rng::seed_from_u64(seed));
        let mut changed = machine.axes[1].clone();
        effect::apply(&controller, &mut changed);
        assert!(changed.servo != machine.axes[1].servo, "{controller:?}");
    }
}

#[test]
fn logs_at_rest_have_the_noise_and_steps_of_the_coarse_sensors() {
    let coarse = Axis { sensors: Sensors::coarse(), encoder_step_m: 0.5e-6, ..axis(false) };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let positions = vec![[0.0; 2]; 2000];
    let log = simulation::run(&[coarse, axis(false)], &positions, 0.0, &mut random);
    let tool = log.axes[0].tool.as_ref().unwrap();
    // 2000 values: the scatter is known to 1.6 %.
    assert!((numerics::rms(tool.iter().copied()) / 215e-6 - 1.0).abs() < 0.07);
    let table = log.axes[0].table.as_ref().unwrap();
    assert!(table.iter().all(|mm| (1e4 * mm - (1e4 * mm).round()).abs() < 1e-6));
}
