//! The velocity loop against its equation F = Kv·(e + Σe·T/Ti), rounded once, and its anti-windup at the force limit.

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

/// A number with 24 fraction bits, rounded towards −∞.
fn floor(bits: i128) -> i128 {
    bits >> 24
}

proptest! {
    /// A signal has 14 fraction bits and a gain 24, so that every product is a multiple of 2⁻³⁸ and their sum is exact in
    /// integers. In every tick the force is below this sum by less than a signal step, whatever was integrated before. The motor
    /// moves by whole steps of an increment signal, 2¹⁰ position units.
    #[test]
    fn fixed_point_is_within_a_step_of_exact_arithmetic(
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
            let velocity = floor(increment * rate + last * before);
            last = increment;
            let error = i128::from(command.to_bits()) - velocity;
            sum += error * integral;
            let exact = error * proportional + sum;
            // At the limit the force does not show the rounding.
            prop_assume!(exact.abs() < 131_000 << 38);
            let force = i128::from(law.force(&mut state, command, Position(motor)).to_bits());
            prop_assert!((0..1 << 24).contains(&(exact - (force << 24))), "{}, expected {}·2⁻²⁴", force, exact);
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

/// The force on a locked motor in each tick after a command of `m_per_s`, held for `ticks`, has changed its sign.
fn force_after_sign_change<S: Scalar>(m_per_s: f64, ticks: u32) -> Vec<f64> {
    let law = limited::<S>();
    let mut state = State::at(Position(0));
    for _ in 0..ticks {
        law.force(&mut state, signal(m_per_s), Position(0));
    }
    (0..1000).map(|_| law.force(&mut state, signal(-m_per_s), Position(0)).value()).collect()
}

/// With a constant error e = c the force is Kv·c·(1 + n·T/Ti) until it reaches its limit F. The last integral that is kept is
/// at most F − Kv·c and less than a step Kv·c·T/Ti below that. So the first force for −c is between one and two steps below
/// F − 2·Kv·c, however long the force was saturated; from there it falls by a step per tick. An integral that winds up would
/// keep the force at +F for as long as it was saturated.
fn leaves_saturation_at_once<S: Scalar>() {
    let c = 0.05;
    let step = KV * c / RATE_HZ / INTEGRAL_TIME_S;
    for sign in [1.0, -1.0] {
        // The limit is reached after 12 ms. 400 ticks are 8 ms of saturation, 200,000 ticks 10 s.
        let short = force_after_sign_change::<S>(sign * c, 400);
        let first = sign * short[0];
        let most = LIMIT_N - 2.0 * KV * c - step;
        // 240 additions to an integral of up to 300 N in f32, each rounded by 2⁻²⁵ of it, have an error of 2 mN.
        assert!(first <= most + 0.01 && first > most - step - 0.01, "{}: {first} N, at most {most}", S::NAME);
        for (n, force) in (0u32..).zip(&short) {
            let expected = (first - f64::from(n) * step).max(-LIMIT_N);
            assert!(
                (sign * force - expected).abs() < 0.02,
                "{}, tick {n}: {force}, not {expected} N",
                S::NAME
            );
        }
        let long = force_after_sign_change::<S>(sign * c, 200_000);
        assert!(short.iter().zip(&long).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", S::NAME);
    }
}

#[test]
fn the_time_at_the_limit_does_not_wind_the_integral_up() {
    leaves_saturation_at_once::<Fixed>();
    leaves_saturation_at_once::<f32>();
    leaves_saturation_at_once::<f64>();
}

/// An added force keeps the total force at its limit. An error that would drive it further beyond is not integrated, an error
/// of the opposite sign is. The next force without the added one shows the integral: Kv·e + Kv·(T/Ti)·Σe.
fn integrates_away_from_the_limit<S: Scalar>() {
    let law = limited::<S>();
    let (c, ticks) = (0.01, 100);
    let step = KV * c / RATE_HZ / INTEGRAL_TIME_S;
    for [error, added] in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let mut state = State::at(Position(0));
        for _ in 0..ticks {
            let pi = law.pi_output(&mut state, signal(error * c), Position(0));
            let unlimited = pi.force + S::signal(added * 3.0 * LIMIT_N);
            let (force, limited) = law.limit(&mut state, &pi, unlimited);
            assert!(limited && force == S::signal(added * LIMIT_N), "{}", S::NAME);
        }
        let kept = if (error > 0.0) == (added > 0.0) { 0 } else { ticks };
        let expected = error * (KV * c + step * f64::from(kept + 1));
        let force = law.force(&mut state, signal(error * c), Position(0)).value();
        assert!((force - expected).abs() < 0.002, "{}: {force} N, expected {expected}", S::NAME);
    }
}

#[test]
fn at_the_limit_only_an_error_of_the_opposite_sign_is_integrated() {
    integrates_away_from_the_limit::<Fixed>();
    integrates_away_from_the_limit::<f32>();
    integrates_away_from_the_limit::<f64>();
}

const MASS_KG: f64 = 50.0;

/// A mass m from rest to the speed c with the force limit F: it accelerates by F/m until the error is F/Kv. From then on
///
/// e″ + a·e′ + (a/Ti)·e = 0, a = Kv/m, e(0) = F/Kv, e′(0) = −a·e(0)
///
/// since nothing has been integrated before. With the roots −p and −q: e = A·e^(−pt) + B·e^(−qt), B = e(0)·(a − p)/(q − p),
/// A = e(0) − B. The overshoot is −e at its minimum, where p·A·e^(−pt) + q·B·e^(−qt) = 0.
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
    // The reading is half a tick late and the force is held over a tick: relative errors of the order of a·T = 1 %.
    let at_limit_s = f64::from(at_limit) / RATE_HZ;
    assert!((at_limit_s - leaves_s).abs() < 3.0 / RATE_HZ, "{}: {at_limit_s} s, not {leaves_s}", S::NAME);
    assert!((greatest / overshoot - 1.0).abs() < 0.03, "{}: {greatest} m/s, not {overshoot}", S::NAME);
    let peak_s = leaves_s + peak_s;
    assert!((when_s - peak_s).abs() < 0.03 * peak_s, "{}: {when_s} s, not {peak_s}", S::NAME);
    assert!((v - c).abs() < 1e-4 * c, "{}: {v} m/s", S::NAME);
}

#[test]
fn the_overshoot_after_saturation_is_that_of_the_linear_loop() {
    overshoots::<Fixed>();
    overshoots::<f32>();
    overshoots::<f64>();
}
