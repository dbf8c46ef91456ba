//! The observer of the velocity against its equations: tracking loop, step, ramp, frequency response; its sums and its end at standstill
//! in fixed point; start, change, new origin.

use std::f64::consts::{PI, TAU};

use proptest::prelude::*;
use shared::axis::{AxisState, Reading};
use shared::compensate::Correction;
use shared::config::{AxisConfig, AxisSettings, ConfigError, Rates, VelocitySource};
use shared::control::velocity::State;
use shared::feedback::OriginShift;
use shared::machine::Machine;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_M, Position, VELOCITY_M_PER_S};

const RATE_HZ: f64 = 20_000.0;
const RATES: Rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };

/// One nm/s: a step of the fixed-point velocity.
const STEP_M_PER_S: f64 = VELOCITY_M_PER_S / 16_384.0;

/// Kv of the board: an encoder count of 0.25 µm is 15 N with the difference.
const KV: f64 = 3000.0;
const COUNT_M: f64 = 0.25e-6;

fn observed(bandwidth_hz: f64) -> AxisSettings {
    AxisSettings {
        velocity_gain_n_s_per_m: KV,
        velocity_source: VelocitySource::Observer { bandwidth_hz },
        ..AxisSettings::default()
    }
}

/// r of a bandwidth.
fn pole(bandwidth_hz: f64) -> f64 {
    (-TAU * bandwidth_hz / RATE_HZ).exp()
}

/// The velocity that a loop without an integral part has for each reading, velocity units: Kv is the unit of a force per velocity.
fn velocities<S: Scalar>(bandwidth_hz: f64, readings: impl IntoIterator<Item = Position>) -> Vec<f64> {
    let settings = AxisSettings {
        velocity_gain_n_s_per_m: 1.0 / VELOCITY_M_PER_S,
        velocity_integral_time_s: None,
        force_limit_n: 1.3e5,
        ..observed(bandwidth_hz)
    };
    let law = AxisConfig::<S>::new(&settings, RATES).unwrap().velocity;
    let mut state = State::at(Position(0));
    readings.into_iter().map(|motor| -law.force(&mut state, S::ZERO, motor).value()).collect()
}

/// In m/s. A force is rounded towards −∞, so that its negative is not below the velocity, which is exact in fixed point with this Kv.
fn m_per_s<S: Scalar>(bandwidth_hz: f64, readings: impl IntoIterator<Item = Position>) -> Vec<f64> {
    velocities::<S>(bandwidth_hz, readings).into_iter().map(|v| v * VELOCITY_M_PER_S).collect()
}

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// Velocities in steps of 1 nm/s.
fn steps(bandwidth_hz: f64, readings: impl IntoIterator<Item = Position>) -> Vec<i64> {
    let steps = |v: f64| {
        assert!((v * 16_384.0).fract() == 0.0, "{v}");
        #[expect(clippy::cast_possible_truncation, reason = "a whole number of 31 bits")]
        return (v * 16_384.0) as i64;
    };
    velocities::<Fixed>(bandwidth_hz, readings).into_iter().map(steps).collect()
}

/// A step q of the reading gives (q/T)(1 − r)²(k + 1)r^k, and a ramp of speed v gives v·(1 − r^(k+1)·(1 + (k + 1)(1 − r))), k ticks after the
/// first that has moved. In fixed point a stage is less than a step of 1 nm/s above or below, and the second has the error of the
/// first, too: 2 nm/s, and one for the rounding of the gain.
fn responds_as_its_closed_form<S: Scalar>(tolerance_m_per_s: f64, relative_step: f64) {
    for bandwidth_hz in [20.0, 200.0, 300.0, 400.0, 5000.0] {
        let r = pole(bandwidth_hz);
        let ticks = 2000u32;
        let step = m_per_s::<S>(bandwidth_hz, (0..ticks).map(|_| position(COUNT_M)));
        let speed = 0.1;
        let ramp =
            m_per_s::<S>(bandwidth_hz, (0..ticks).map(|k| position(speed / RATE_HZ * f64::from(k + 1))));
        for ((k, step), ramp) in (0..ticks).zip(step).zip(ramp) {
            let n = f64::from(k + 1);
            let left = (n * r.ln()).exp();
            let expected = COUNT_M * RATE_HZ * (1.0 - r).powi(2) * n * left / r;
            let context = format!("{}, {bandwidth_hz} Hz, tick {k}", S::NAME);
            assert!((step - expected).abs() < tolerance_m_per_s, "{context}: {step}, not {expected}");
            let expected = speed * (1.0 - left * (1.0 + n * (1.0 - r)));
            // The rounding of a gain, or of the velocity, in a part 1 − r of it for each stage.
            let tolerance = tolerance_m_per_s + 2.0 * speed * relative_step / (1.0 - r);
            assert!((ramp - expected).abs() < tolerance, "{context}: {ramp}, not {expected}");
        }
    }
}

#[test]
fn step_and_ramp_have_their_closed_form() {
    responds_as_its_closed_form::<Fixed>(3.0 * STEP_M_PER_S, Fixed::GAIN_STEP);
    responds_as_its_closed_form::<f32>(1e-7, f64::from(f32::EPSILON));
    // Half a position unit per tick is 1e-11 m/s.
    responds_as_its_closed_form::<f64>(2.1e-11, f64::EPSILON);
}

/// The tracking loop as it is written in books: e = y − p − v, p += v + a·e, v += b·e.
fn tracking_loop(bandwidth_hz: f64, readings: &[Position]) -> Vec<f64> {
    let r = pole(bandwidth_hz);
    let (mut p, mut v) = (0.0, 0.0);
    let estimate = |reading: &Position| {
        let e = reading.to_m() - p - v;
        p += v + (1.0 - r * r) * e;
        v += (1.0 - r).powi(2) * e;
        v * RATE_HZ
    };
    readings.iter().map(estimate).collect()
}

/// Readings that move by up to 10 µm a tick and stand at times, in position units.
fn motion() -> impl Strategy<Value = Vec<Position>> {
    let stretch = (-10_000_000_000i64..10_000_000_000, 1usize..60, any::<bool>());
    prop::collection::vec(stretch, 1..12).prop_map(|stretches| {
        let mut at = 0;
        let ticks =
            |(increment, ticks, stands): (i64, usize, bool)| vec![if stands { 0 } else { increment }; ticks];
        stretches
            .into_iter()
            .flat_map(ticks)
            .map(|increment| {
                at += increment;
                Position(at)
            })
            .collect()
    })
}

proptest! {
    #[test]
    fn the_estimate_is_that_of_the_tracking_loop(readings in motion(), bandwidth_hz in 20.0..5000.0f64) {
        let expected = tracking_loop(bandwidth_hz, &readings);
        let fastest = 10e9 / PER_M * RATE_HZ;
        let r = pole(bandwidth_hz);
        for (format, found, tolerance) in [
            // p is a position: its rounding, 2⁻⁵³ of up to 7 mm, is differentiated.
            ("f64", m_per_s::<f64>(bandwidth_hz, readings.clone()), 1e-11),
            // Three steps, and two gains that are rounded by half a step of theirs.
            ("fixed", m_per_s::<Fixed>(bandwidth_hz, readings.clone()),
                3.0 * STEP_M_PER_S + 2.0 * fastest * Fixed::GAIN_STEP / (1.0 - r)),
            ("f32", m_per_s::<f32>(bandwidth_hz, readings.clone()), 1e-6 * fastest / (1.0 - r)),
        ] {
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                prop_assert!((found - expected).abs() < tolerance, "{}, tick {}: {}, not {}", format, k, found, expected);
            }
        }
    }

    /// With 1 − r = g, the sum of the estimates is below that of the velocities by what is kept: less than a step of an increment, less than
    /// a step of a velocity, and less than a step over g in each stage. It does not grow with the motion. A stage comes within a step of 0
    /// from 2³¹ steps in 21.5/g ticks and to 0 in 1/g further ones, one after the other.
    #[test]
    fn fixed_point_ends_at_zero_and_loses_no_distance(mut readings in motion(), bandwidth_hz in 20.0..5000.0f64) {
        let g = 1.0 - pole(bandwidth_hz);
        let end = *readings.last().unwrap();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to 7200")]
        let settling = (2.0 * (21.5 + 1.0) / g) as usize + 2;
        let moving = readings.len();
        readings.extend(vec![end; settling + 100]);
        let steps = steps(bandwidth_hz, readings);
        prop_assert!(steps[moving + settling..].iter().all(|&step| step == 0));
        // 20 kHz are 625/32 steps of a velocity for one of an increment, 2¹⁰ position units.
        let per_increment = 625.0 / 32.0;
        let distance = end.0 as f64 / 1024.0 * per_increment;
        let lost = distance - steps.iter().sum::<i64>() as f64;
        prop_assert!((-1e-3..per_increment + 1.0 + 2.0 / g).contains(&lost), "{} steps", lost);
    }
}

/// 1001 position units a tick are less than a step of an increment, 19.1 nm/s: a difference rounded by itself has 0. After 50 s the sum of
/// the estimates is that of the speed, less what it was late by, 2r/(1 − r) ticks, and what is kept.
#[test]
fn the_mean_at_constant_speed_is_exact() {
    for (bandwidth_hz, units) in
        [(20.0, 1001), (300.0, 1001), (300.0, -1001), (300.0, 1), (400.0, -1_234_567)]
    {
        let ticks = 1_000_000;
        let steps = steps(bandwidth_hz, (1..=ticks).map(|k| Position(k * units)));
        let r = pole(bandwidth_hz);
        let speed = units as f64 / 1024.0 * 625.0 / 32.0;
        let late = (ticks as f64 - 2.0 * r / (1.0 - r)) * speed - steps.iter().sum::<i64>() as f64;
        let kept = 625.0 / 32.0 + 1.0 + 2.0 / (1.0 - r);
        let of_gain = speed.abs() * 2.0 * Fixed::GAIN_STEP / (1.0 - r).powi(2);
        assert!(
            (-of_gain - 1e-2..kept + of_gain + 1e-2).contains(&late),
            "{bandwidth_hz} Hz, {units}: {late} steps"
        );
    }
}

/// (1 − 1/z)·((1 − r)/(1 − r/z))²/T at z = e^(jωT), as magnitude over ω and phase before 90°.
fn response(bandwidth_hz: f64, frequency_hz: f64) -> (f64, f64) {
    let (r, x) = (pole(bandwidth_hz), TAU * frequency_hz / RATE_HZ);
    let stage = (1.0 - r) / (1.0 - 2.0 * r * x.cos() + r * r).sqrt();
    let lag = (r * x.sin()).atan2(1.0 - r * x.cos());
    let difference = 2.0 * (x / 2.0).sin();
    (difference / x * stage * stage, -(x / 2.0 + 2.0 * lag))
}

/// Magnitude over ω, and phase before 90°, of the estimate for a sine of the reading, from ten periods after it has settled.
fn measured<S: Scalar>(bandwidth_hz: f64, frequency_hz: f64) -> (f64, f64) {
    let amplitude_m = 0.02 / (TAU * frequency_hz);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number")]
    let (period, settled) = ((RATE_HZ / frequency_hz).round() as usize, 20_000);
    let x = |k: usize| TAU * frequency_hz * k as f64 / RATE_HZ;
    let found =
        m_per_s::<S>(bandwidth_hz, (0..settled + 10 * period).map(|k| position(amplitude_m * x(k).sin())));
    let (mut re, mut im) = (0.0, 0.0);
    for (k, v) in found.iter().enumerate().skip(settled) {
        (re, im) = (re + v * x(k).cos(), im + v * x(k).sin());
    }
    let scale = 2.0 / (10 * period) as f64 / 0.02;
    (re.hypot(im) * scale, -im.atan2(re))
}

#[test]
fn the_frequency_response_is_that_of_the_transfer_function() {
    for bandwidth_hz in [200.0, 300.0, 400.0] {
        for frequency_hz in [20.0, 50.0, 200.0, 400.0, 1000.0] {
            let (gain, phase) = response(bandwidth_hz, frequency_hz);
            for (format, found, tolerance) in [
                ("f64", measured::<f64>(bandwidth_hz, frequency_hz), 1e-8),
                ("f32", measured::<f32>(bandwidth_hz, frequency_hz), 1e-5),
                ("fixed", measured::<Fixed>(bandwidth_hz, frequency_hz), 1e-6),
            ] {
                let context = format!("{format}, {bandwidth_hz} Hz at {frequency_hz} Hz");
                assert!((found.0 - gain).abs() < tolerance, "{context}: {}, not {gain}", found.0);
                let turned = (found.1 - phase + PI).rem_euclid(TAU) - PI;
                assert!(turned.abs() < tolerance / gain, "{context}: {}, not {phase}", found.1);
            }
            // Far below the tick rate: 1/(1 + (f/f₀)²) and −2·arctan(f/f₀), but for half a tick of the difference and one tick less in
            // the two stages.
            let ratio = frequency_hz / bandwidth_hz;
            if frequency_hz <= 400.0 {
                assert!(
                    (gain * (1.0 + ratio * ratio) - 1.0).abs() < 0.03,
                    "{bandwidth_hz} {frequency_hz} {gain}"
                );
                let expected = -2.0 * ratio.atan() + PI * frequency_hz / RATE_HZ;
                assert!((phase - expected).abs() < 0.01, "{bandwidth_hz} {frequency_hz} {phase}");
            }
        }
    }
}

/// The force for one encoder count, and the phase of the velocity at 32 Hz, the bandwidth of the velocity loop of the board.
/// `--nocapture` prints what docs/controller.md has.
#[test]
fn figures() {
    let forces = |velocity_source| {
        let settings = AxisSettings { velocity_source, velocity_integral_time_s: None, ..observed(300.0) };
        let law = AxisConfig::<Fixed>::new(&settings, RATES).unwrap().velocity;
        let mut state = State::at(Position(0));
        let force_n = |_| law.force(&mut state, Fixed::ZERO, position(COUNT_M)).value().abs();
        (0..400).map(force_n).fold(0.0, f64::max)
    };
    let difference_n = forces(VelocitySource::Difference);
    assert!((difference_n - 15.0).abs() < 1e-3, "{difference_n}");
    println!("difference: {difference_n:.2} N a count, {:.1}°", (-PI * 32.0 / RATE_HZ).to_degrees());
    for bandwidth_hz in [200.0, 300.0, 400.0] {
        let found_n = forces(VelocitySource::Observer { bandwidth_hz });
        // q·ω/e, the greatest of a continuous loop: less than 4 % off.
        let expected_n = KV * COUNT_M * TAU * bandwidth_hz / 1f64.exp();
        assert!((found_n / expected_n - 1.0).abs() < 0.04, "{found_n}, not {expected_n}");
        let (_, phase) = response(bandwidth_hz, 32.0);
        println!("{bandwidth_hz} Hz: {found_n:.2} N a count, {:.1}°", phase.to_degrees());
    }
}

fn at(motor: Position) -> Reading {
    Reading { motor, table: None }
}

/// An axis that has been stopped in motion and comes on again, at rest, has the forces of one that has never moved: nothing of its velocity
/// is left. Its reading stands at a place that is no whole number of increments.
fn starts_anew<S: Scalar>() {
    let settings = [observed(300.0)];
    let there = Position(123_456_789_123);
    let mut moved = Machine::<S, 1>::new(RATES, &settings, [Position(0)]).unwrap();
    moved.enable();
    for k in 0..400 {
        moved.tick(&[at(Position(there.0 / 400 * k))]);
    }
    moved.disable();
    moved.tick(&[at(there)]);
    let mut fresh = Machine::<S, 1>::new(RATES, &settings, [there]).unwrap();
    moved.enable();
    fresh.enable();
    for k in 0..400 {
        // It is held, and pushed from the tenth tick on.
        let reading = [at(there + 1_000_000 * (k - 10).max(0))];
        let [moved, fresh] = [&mut moved, &mut fresh].map(|machine| machine.tick(&reading).forces[0]);
        assert!(moved.bits() == fresh.bits(), "{}, tick {k}: {moved:?}, not {fresh:?}", S::NAME);
        assert!(k > 10 || moved.value() == 0.0, "{}: {moved:?}", S::NAME);
    }
}

#[test]
fn an_axis_that_comes_on_has_no_velocity() {
    starts_anew::<Fixed>();
    starts_anew::<f32>();
    starts_anew::<f64>();
}

/// The forces of an axis in motion at constant speed, N. In the middle it is changed by `event`, which also gives by how much its command
/// and its reading are shifted from then on.
fn forces<S: Scalar>(
    [before, after]: [&AxisSettings; 2],
    event: impl Fn(&mut AxisState<S>, [&AxisConfig<S>; 2], Position) -> i64,
) -> Vec<f64> {
    let configs = [before, after].map(|settings| AxisConfig::<S>::new(settings, RATES).unwrap());
    // 0.1 m/s in position units a tick, and the command by 3 µm ahead.
    let place = |k: i64| Position(5_242_879_877 * k);
    let mut state = AxisState::at_rest(place(-1), at(place(-1)));
    if configs[0].velocity.observer.is_some() {
        state = state.moving(0.1);
    }
    let mut shift = 0;
    let tick = |k: i64| {
        if k == 1000 {
            shift = event(&mut state, [&configs[0], &configs[1]], place(k - 1) + 3_145_728_000);
        }
        let config = &configs[usize::from(k >= 1000)];
        let reading = at(place(k) + shift);
        state.position_tick(config, place(k) + 3_145_728_000 + shift, Correction::NONE, reading);
        state.velocity_tick(config, reading, S::ZERO).0.value()
    };
    (0..2000).map(tick).collect()
}

/// A new origin does not change a bit of a force in fixed point; it is metres away and no whole number of increments.
#[test]
fn a_new_origin_is_no_velocity() {
    let settings = observed(300.0);
    let unchanged = forces::<Fixed>([&settings; 2], |_, _, _| 0);
    for shift in [1, -777, 3_141_592_653_589_793] {
        let shifted = forces::<Fixed>([&settings; 2], |state, _, command| {
            let origin = OriginShift { motor: shift, table: 0 };
            *state = state.shifted(command + shift, shift, origin);
            shift
        });
        assert_eq!(unchanged, shifted, "{shift}");
    }
}

/// The forces without a change of the settings, but for the transfer that every change starts.
fn changed<S: Scalar>(settings: [&AxisSettings; 2]) -> Vec<f64> {
    forces::<S>(settings, |state, [from, to], _| {
        state.change(from, to);
        0
    })
}

fn changes_without_a_step<S: Scalar>(tolerance_n: f64) {
    let [other, observer] = [200.0, 300.0].map(observed);
    let difference = AxisSettings { velocity_source: VelocitySource::Difference, ..observer };
    let unchanged = changed::<S>([&difference; 2]);
    for settings in [[&difference, &observer], [&observer, &difference], [&observer, &other]] {
        for (k, (unchanged, changed)) in unchanged.iter().zip(changed::<S>(settings)).enumerate() {
            let context = format!("{}, tick {k}", S::NAME);
            assert!((unchanged - changed).abs() < tolerance_n, "{context}: {changed}, not {unchanged} N");
        }
    }
}

/// An observer that is declared in motion begins with the velocity of the difference: the forces are those of the axis without it, but for
/// the rounding of the difference, up to 20.6 nm/s, times Kv, its integral over 0.1 s, and the rounding of two forces. Begun at standstill it would be off by up to
/// Kv·0.1 m/s = 300 N for 1 ms, which leaves 300 N·1 ms/Ti = 15 N in the integral.
#[test]
fn an_observer_that_is_declared_in_motion_begins_with_its_velocity() {
    changes_without_a_step::<Fixed>(KV * 20.6e-9 * (1.0 + 0.1 / 0.02) + 2.0 * Fixed::SIGNAL_STEP);
    // The observer of the start has 0.1 m/s, the readings 2.4 nm/s less.
    changes_without_a_step::<f64>(KV * 2.4e-9 * (1.0 + 0.1 / 0.02));
}

#[test]
fn a_bandwidth_beyond_its_range_is_refused_with_it() {
    let name = "velocity_observer_hz";
    for bandwidth_hz in [0.0, -300.0, 19.9, 5001.0] {
        let refused = AxisConfig::<Fixed>::new(&observed(bandwidth_hz), RATES).unwrap_err();
        assert_eq!(refused, ConfigError::OutOfRange { name, min: 20.0, max: 5000.0 });
        assert_eq!(refused.to_string(), "velocity_observer_hz: expected a number from 20 to 5000");
    }
    let refused = AxisConfig::<f64>::new(&observed(f64::NAN), RATES).unwrap_err();
    assert_eq!(refused, ConfigError::NotFinite(name));
    for bandwidth_hz in [20.0, 5000.0] {
        assert!(AxisConfig::<Fixed>::new(&observed(bandwidth_hz), RATES).is_ok());
    }
}
