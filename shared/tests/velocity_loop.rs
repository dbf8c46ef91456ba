//! The velocity loop against its equations: F = Kv·(e + Σe·T/Ti), rounded once, and an integral that does not wind up
//! while the force is at its limit.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::control::velocity::{State, VelocityControl};
use shared::scalar::{Fixed, Scalar};
use shared::units::{Position, VELOCITY_M_PER_S};

const RATE_HZ: f64 = 20_000.0;
const RATES: Rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };

fn law<S: Scalar>(settings: &AxisSettings) -> VelocityControl<S> {
    AxisConfig::new(settings, RATES).unwrap().velocity
}

fn signal<S: Scalar>(m_per_s: f64) -> S {
    S::signal(m_per_s / VELOCITY_M_PER_S)
}

/// The nearest integer to a number of 2⁻²⁴ steps: floor(x + ½).
fn nearest(bits: i128) -> i128 {
    (bits + (1 << 23)) >> 24
}

proptest! {
    /// A signal has 14 fraction bits and a gain 24, so that every product is a whole number of 2⁻³⁸ and the sum of
    /// them is known exactly in integers. The force is the signal nearest to that sum: half a step off at most, in every
    /// tick, whatever was integrated before. The increments are whole steps of theirs, 2¹⁰ position units.
    #[test]
    fn fixed_point_is_within_half_a_step_of_exact_arithmetic(
        kv in 1e4..1e6f64,
        integral_time_s in 0.005..0.5f64,
        lag in 0.0..1.0f64,
        ticks in prop::collection::vec((-1000.0..1000.0f64, -20_000i64..20_000), 1..100),
    ) {
        let law = law::<Fixed>(&AxisSettings {
            velocity_gain_n_s_per_m: kv,
            velocity_integral_time_s: Some(integral_time_s),
            velocity_lag_s: lag / RATE_HZ,
            force_limit_n: 131_000.0,
            ..AxisSettings::default()
        });
        let [proportional, integral, rate, before] =
            [law.proportional, law.integral, law.rate, law.previous_rate].map(|gain| i128::from(gain.to_bits()));
        let mut state = State::at(Position(0));
        let (mut motor, mut last, mut sum) = (0, 0, 0);
        for (command, increment) in ticks {
            let command = Fixed::signal(command);
            motor += increment << 10;
            let increment = i128::from(increment);
            let velocity = nearest(increment * rate + last * before);
            last = increment;
            let error = i128::from(command.to_bits()) - velocity;
            sum += error * integral;
            let exact = error * proportional + sum;
            // Below the limit, or this tick says nothing of rounding.
            prop_assume!(exact.abs() < 131_000 << 38);
            let force = i128::from(law.force(&mut state, command, Position(motor)).to_bits());
            prop_assert!(2 * ((force << 24) - exact).abs() <= 1 << 24, "{} for {}·2⁻²⁴", force, exact);
        }
    }
}

const KV: f64 = 10_000.0;
const LIMIT_N: f64 = 800.0;
const INTEGRAL_TIME_S: f64 = 0.02;

fn limited<S: Scalar>() -> VelocityControl<S> {
    law(&AxisSettings {
        velocity_gain_n_s_per_m: KV,
        velocity_integral_time_s: Some(INTEGRAL_TIME_S),
        force_limit_n: LIMIT_N,
        ..AxisSettings::default()
    })
}

/// On a locked motor: the force in the ticks after a command of `m_per_s` that stood for `ticks` has turned over.
fn turned_over<S: Scalar>(m_per_s: f64, ticks: u32) -> Vec<f64> {
    let law = limited::<S>();
    let mut state = State::at(Position(0));
    for _ in 0..ticks {
        law.force(&mut state, signal(m_per_s), Position(0));
    }
    (0..1000).map(|_| law.force(&mut state, signal(-m_per_s), Position(0)).value()).collect()
}

/// With e = c held the force is Kv·c·(1 + n·T/Ti) until it is at its limit F. The last integral that was kept is the
/// greatest one within F − Kv·c, less than a step Kv·c·T/Ti below it. So the first force for −c lies between
/// F − 2·Kv·c less one step and less two, however long the force stood at its limit; from there it falls by a step a
/// tick. An integral that winds up would hold the force at +F for as long as it had stood there.
fn recovers_at_once<S: Scalar>() {
    let c = 0.05;
    let step = KV * c / RATE_HZ / INTEGRAL_TIME_S;
    for sign in [1.0, -1.0] {
        // 12 ms until it is at the limit: 8 ms there, and 10 s.
        let short = turned_over::<S>(sign * c, 400);
        let first = sign * short[0];
        let most = LIMIT_N - 2.0 * KV * c - step;
        // 240 sums of up to 300 N in f32, each rounded to 2⁻²⁵ of it, make 2 mN.
        assert!(first <= most + 0.01 && first > most - step - 0.01, "{}: {first} of {most} N", S::NAME);
        for (n, force) in (0u32..).zip(&short) {
            let falls = (first - f64::from(n) * step).max(-LIMIT_N);
            assert!((sign * force - falls).abs() < 0.02, "{}, tick {n}: {force} for {falls} N", S::NAME);
        }
        let long = turned_over::<S>(sign * c, 200_000);
        assert!(short.iter().zip(&long).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", S::NAME);
    }
}

#[test]
fn the_time_at_the_limit_does_not_wind_the_integral_up() {
    recovers_at_once::<Fixed>();
    recovers_at_once::<f32>();
    recovers_at_once::<f64>();
}

/// A force that what is added to it keeps at its limit: an error that would drive it further is not integrated, one
/// that would take it back is. What is in the integral shows in the next tick's force, Kv·e + Kv·(T/Ti)·Σe.
fn integrates_towards_the_range<S: Scalar>() {
    let law = limited::<S>();
    let (c, ticks) = (0.01, 100);
    let step = KV * c / RATE_HZ / INTEGRAL_TIME_S;
    for [error, added] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let mut state = State::at(Position(0));
        for _ in 0..ticks {
            let wanted = law.pi_output(&mut state, signal(error * c), Position(0));
            let shaped = wanted.force + S::signal(added * 3.0 * LIMIT_N);
            let (force, limited) = law.limit(&mut state, &wanted, shaped);
            assert!(limited && force == S::signal(added * LIMIT_N), "{}", S::NAME);
        }
        let kept = if (error > 0.0) == (added > 0.0) { 0 } else { ticks };
        let expected = error * (KV * c + step * f64::from(kept + 1));
        let force = law.force(&mut state, signal(error * c), Position(0)).value();
        assert!((force - expected).abs() < 0.002, "{}: {force} for {expected} N", S::NAME);
    }
}

#[test]
fn at_the_limit_only_what_leads_back_is_integrated() {
    integrates_towards_the_range::<Fixed>();
    integrates_towards_the_range::<f32>();
    integrates_towards_the_range::<f64>();
}

const MASS_KG: f64 = 50.0;

/// A mass from rest to c with the force limit F: it speeds up by F/m until the error is F/Kv. From there on
///
/// e″ + a·e′ + (a/Ti)·e = 0, a = Kv/m, e(0) = F/Kv, e′(0) = −a·e(0)
///
/// since nothing has been integrated before. With the roots −p, −q: e = A·e^(−pt) + B·e^(−qt),
/// B = e(0)·(a − p)/(q − p), A = e(0) − B, least where p·A·e^(−pt) + q·B·e^(−qt) = 0.
fn overshoots<S: Scalar>() {
    let (c, force_n, integral_time_s) = (1.0, 500.0, 0.1);
    let law = law::<S>(&AxisSettings {
        velocity_gain_n_s_per_m: KV,
        velocity_integral_time_s: Some(integral_time_s),
        force_limit_n: force_n,
        ..AxisSettings::default()
    });
    let a = KV / MASS_KG;
    let root = (a * a / 4.0 - a / integral_time_s).sqrt();
    let (p, q) = (a / 2.0 - root, a / 2.0 + root);
    let start = force_n / KV;
    let fast = start * (a - p) / (q - p);
    let slow = start - fast;
    let leaves_s = (c - start) / (force_n / MASS_KG);
    let peak_s = (-q * fast / (p * slow)).ln() / (q - p);
    let overshoot = -(slow * (-p * peak_s).exp() + fast * (-q * peak_s).exp());

    let mut state = State::at(Position(0));
    let (mut x, mut v, mut at_limit, mut greatest, mut when_s) = (0.0, 0.0, 0, 0.0, 0.0);
    for n in 0..20_000 {
        let force = law.force(&mut state, signal(c), Position::from_m(x).unwrap()).value();
        at_limit += u32::from(force >= 0.999_999 * force_n);
        let acceleration = force / MASS_KG;
        x += v / RATE_HZ + acceleration / (2.0 * RATE_HZ * RATE_HZ);
        v += acceleration / RATE_HZ;
        if v - c > greatest {
            (greatest, when_s) = (v - c, f64::from(n + 1) / RATE_HZ);
        }
    }
    // The reading is half a tick late and the force is held for one: a·T = 1 % of the fast root.
    let at_limit_s = f64::from(at_limit) / RATE_HZ;
    assert!((at_limit_s - leaves_s).abs() < 3.0 / RATE_HZ, "{}: {at_limit_s} s of {leaves_s}", S::NAME);
    assert!((greatest / overshoot - 1.0).abs() < 0.03, "{}: {greatest} m/s of {overshoot}", S::NAME);
    let peak_s = leaves_s + peak_s;
    assert!((when_s - peak_s).abs() < 0.03 * peak_s, "{}: {when_s} s of {peak_s}", S::NAME);
    assert!((v - c).abs() < 1e-4 * c, "{}: {v} m/s", S::NAME);
}

#[test]
fn a_step_through_the_limit_overshoots_as_the_linear_loop_from_there_does() {
    overshoots::<Fixed>();
    overshoots::<f32>();
    overshoots::<f64>();
}
