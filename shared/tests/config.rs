//! The constants of an axis are those of its settings by their definitions, and each range ends where it is declared.

use core::f64::consts::TAU;

use shared::config::{
    AxisConfig, AxisSettings, ConfigError, LowPass, Notch, Notches, Rates, ScaleLimits, Sensors,
    VelocitySource,
};
use shared::control::filter::State as FilterState;
use shared::feedback::dual::Feedback;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_M, Position};

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 4 };

const SETTINGS: fn() -> AxisSettings = || AxisSettings {
    position_gain_per_s: 40.0,
    feedforward_percent: 80.0,
    feedforward_ahead_s: 0.3e-3,
    velocity_gain_n_s_per_m: 3000.0,
    velocity_integral_time_s: Some(0.01),
    velocity_lag_s: 20e-6,
    force_limit_n: 500.0,
    sensors: Sensors::Motor { scale_disagreement_limit_m: Some(1e-3), frozen_encoder_limit_m: Some(0.5e-3) },
    following_error_limit_m: 2e-3,
    fastest_m_per_s: Some(1.5),
    saturation_time_s: 0.5,
    travel_m: Some([-0.25, 0.5]),
    stop_deceleration_m_per_s2: 3.0,
    ..AxisSettings::default()
};

fn near(value: f64, exact: f64) {
    assert!((value - exact).abs() <= 1e-12 * exact.abs(), "{value}, {exact}");
}

/// The units are 1.024 µm of an error, 16 nm of an increment, 16.384 µm/s of a velocity, and 2⁻²⁰ nm of a position. The velocity loop has
/// ticks of 50 µs, and the position loop of 200 µs.
#[test]
fn constants_are_those_of_the_settings() {
    let axis = AxisConfig::<f64>::new(&SETTINGS(), RATES).unwrap();
    // Velocity units per error unit: Kp·1.024/16.384.
    near(axis.position.gain, 2.5);
    // Errors per increment that give the velocity: 0.8·5000/40 times 16/1024, and 1.5 position ticks of it.
    near(axis.feedforward.previous.unwrap(), 2.343_75);
    near(axis.feedforward.present, 1.5625 + 2.343_75);
    near(axis.velocity.proportional, 0.049_152);
    near(axis.velocity.integral, 0.049_152 * 50e-6 / 0.01);
    // Velocity units per increment unit of a tick: 20 000·16e-9/16.384e-6, 0.4 of it of the tick before.
    near(axis.velocity.rate, 0.6 * 19.531_25);
    near(axis.velocity.previous_rate, 0.4 * 19.531_25);
    near(axis.velocity.force_limit, 500.0);
    near(axis.velocity_transfer_decay, 1.0 - (-40.0f64 / 5000.0).exp());
    near(axis.force_transfer_decay, 1.0 - (-40.0f64 * 50e-6).exp());
    near(axis.monitor.following_error, 2e-3 / 1.024e-6);
    near(axis.monitor.encoder_step.unwrap(), 1.5 / 20_000.0 / 16e-9);
    assert_eq!(axis.monitor.saturation_budget_ticks, 10_000);
    assert_eq!(axis.monitor.travel, [-0.25, 0.5].map(|m| Position::from_m(m).unwrap()));
    let limit = 1_048_576_000_000;
    assert!(axis.monitor.disagreement.contains(limit) && !axis.monitor.disagreement.contains(limit + 1));
    let frozen = axis.monitor.frozen_encoder.unwrap();
    assert_eq!(frozen.limit, 524_288_000_000);
    near(frozen.integral_limit, 0.5e-3 / 1.024e-6);
    // 16.384 µm/s in a position tick, in error units.
    near(frozen.per_tick, 16.0 / 5000.0);
    near(axis.stop_deceleration as f64, (3.0 / 25e6 * PER_M * 65_536.0).floor());
}

/// The gain of a low-pass of the second order at its frequency is 1/(2D), whatever the rate: 0.5 with a damping ratio D of 1, 1 with 0.5.
#[test]
fn the_damping_of_a_low_pass_is_its_gain_at_its_frequency() {
    for damping_ratio in [0.5, 1.0, 2.5] {
        let low_pass = Some(LowPass { frequency_hz: 500.0, damping_ratio });
        let filter =
            AxisConfig::<f64>::new(&AxisSettings { low_pass, ..SETTINGS() }, RATES).unwrap().low_pass;
        let (filter, mut state) = (filter.unwrap(), FilterState::AT_REST);
        // 500 Hz at 20 kHz: 40 ticks a period. The last of 50 periods, against its sine and cosine.
        let (mut real, mut imaginary) = (0.0, 0.0);
        for tick in 0..2000 {
            let angle = TAU * f64::from(tick) / 40.0;
            let output = filter.step(&mut state, angle.sin());
            if tick >= 1960 {
                (real, imaginary) =
                    (real + output * angle.sin() / 20.0, imaginary + output * angle.cos() / 20.0);
            }
        }
        let gain = real.hypot(imaginary);
        // The slowest pole of the three, 500 Hz times 0.21, has decayed by e^(−2π·105·0.1) = 2e-29.
        assert!((gain - 0.5 / damping_ratio).abs() < 1e-9, "{damping_ratio}: {gain}");
    }
}

/// Without a lead there is no second term: the tick computes it only where there is one.
#[test]
fn feedforward_that_is_not_ahead_has_one_term() {
    let settings = AxisSettings { feedforward_ahead_s: 0.0, ..SETTINGS() };
    let feedforward = AxisConfig::<f64>::new(&settings, RATES).unwrap().feedforward;
    assert!(feedforward.previous.is_none());
    near(feedforward.present, 1.5625);
}

/// What a scale is off by at the change to it fades by 1 − 1/e in its time, 0.8 s: 4000 position ticks.
#[test]
fn the_fade_time_of_a_scale_is_in_position_ticks() {
    let limits = ScaleLimits::DEFAULT;
    for sensors in [Sensors::Table(limits), Sensors::Dual { time_constant_s: 0.01, limits }] {
        let settings = AxisSettings { sensors, scale_fade_time_s: 0.8, ..SETTINGS() };
        let feedback = AxisConfig::<f64>::new(&settings, RATES).unwrap().feedback;
        let (Feedback::Table { fade } | Feedback::Dual { fade, .. }) = feedback else {
            panic!("{feedback:?}")
        };
        let left = (0..4000).fold(1i64 << 40, |distance, _| fade.step(distance)) as f64;
        let exact = (-1.0f64).exp() * f64::from(1 << 30) * 1024.0;
        assert!((left / exact - 1.0).abs() < 1e-5, "{left}, {exact}");
    }
}

/// 1/4000 of a distance that is left after a time constant of 0.8 s; a gain of 1 − e^(−1/(5000·0.01)) of the crossover.
#[test]
fn the_time_constant_of_dual_feedback_is_in_position_ticks() {
    let sensors = Sensors::Dual { time_constant_s: 0.01, limits: ScaleLimits::DEFAULT };
    let axis = AxisConfig::<f64>::new(&AxisSettings { sensors, ..SETTINGS() }, RATES).unwrap();
    let Feedback::Dual { fraction, .. } = axis.feedback else { panic!("{:?}", axis.feedback) };
    near(fraction, 1.0 - (-1.0f64 / 50.0).exp());
}

type Set = fn(&mut AxisSettings, f64);

fn refused<S: Scalar>(set: Set, value: f64) -> Option<ConfigError> {
    let mut settings = SETTINGS();
    set(&mut settings, value);
    AxisConfig::<S>::new(&settings, RATES).err()
}

/// Both ends of a range are accepted, and a thousandth beyond them is not.
fn ranges<S: Scalar>(name: &str, set: Set, [least, greatest]: [f64; 2]) {
    let width = 1e-3 * least.abs().max(greatest.abs());
    for (end, beyond) in [(least, least - width), (greatest, greatest + width)] {
        assert_eq!(refused::<S>(set, end), None, "{name}: {end}");
        let Some(ConfigError::OutOfRange { name: found, min, max }) = refused::<S>(set, beyond) else {
            panic!("{name}: {beyond}: {:?}", refused::<S>(set, beyond));
        };
        let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * width;
        assert!(found == name && is_near(min, least) && is_near(max, greatest), "{found}: {min} to {max}");
    }
}

/// As `docs/board.md` and the documentation of the settings state them, for ticks of 50 µs and position ticks of 200 µs.
#[test]
fn each_range_ends_where_it_is_declared() {
    ranges::<f64>("feedforward_percent", |s, value| s.feedforward_percent = value, [0.0, 200.0]);
    // 8 position ticks.
    ranges::<f64>("feedforward_ahead_s", |s, value| s.feedforward_ahead_s = value, [0.0, 1.6e-3]);
    // A thousandth of the rate to a quarter of it.
    let observer: Set = |s, bandwidth_hz| s.velocity_source = VelocitySource::Observer { bandwidth_hz };
    ranges::<f64>("velocity_observer_hz", observer, [20.0, 5000.0]);
    let low_pass: Set = |s, frequency_hz| s.low_pass = Some(LowPass { frequency_hz, damping_ratio: 0.7 });
    ranges::<f64>("low_pass_frequency_hz", low_pass, [20.0, 9000.0]);
    let damping: Set = |s, damping_ratio| s.low_pass = Some(LowPass { frequency_hz: 500.0, damping_ratio });
    ranges::<f64>("low_pass_damping_ratio", damping, [0.05, 10.0]);
    let depth: Set = |s, depth| {
        s.notches = Notches([None, None, None, Some(Notch { frequency_hz: 100.0, width_hz: 10.0, depth })]);
    };
    ranges::<f64>("notch_depth", depth, [0.0, 1.0]);
    ranges::<f64>("preload_n", |s, value| s.preload_n = Some(value), [-500.0, 500.0]);
    // To the following error limit, with the motor alone.
    let frozen: Set = |s, m| {
        s.sensors = Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(m) };
    };
    ranges::<f64>("frozen_encoder_limit_m", frozen, [0.0, 2e-3]);
}

/// A tick in both directions, to a part in 10⁹.
#[test]
fn the_lag_of_the_velocity_is_at_most_a_tick() {
    for lag_s in [50e-6, -50e-6] {
        assert_eq!(refused::<f64>(|s, value| s.velocity_lag_s = value, lag_s), None);
        let error = refused::<f64>(|s, value| s.velocity_lag_s = value, lag_s * (1.0 + 2e-9));
        let Some(ConfigError::OutOfRange { name: "velocity_lag_s", min, max }) = error else {
            panic!("{error:?}")
        };
        assert!((max - 50e-6).abs() < 1e-13 && (min + 50e-6).abs() < 1e-13, "{min} to {max}");
    }
}

/// A notch is at most four times as wide as its frequency, and wider than nothing.
#[test]
fn the_width_of_a_notch_is_that_of_its_frequency() {
    let width: Set = |s, width_hz| {
        s.notches = Notches([None, Some(Notch { frequency_hz: 100.0, width_hz, depth: 0.5 }), None, None]);
    };
    assert_eq!(refused::<f64>(width, 400.0), None);
    let error = ConfigError::OutOfRange { name: "notch_width_hz", min: 0.0, max: 400.0 };
    assert_eq!(refused::<f64>(width, 400.1), Some(error));
    assert_eq!(refused::<f64>(width, 0.0), Some(ConfigError::NotPositive("notch_width_hz")));
}

/// A gain of fixed point is below 128. With 60 position ticks of feed-forward for Kp = 1/s, 0.8·5000·16/1024 = 62.5 per increment, the
/// feed-forward may be ahead by 0.999·128/62.5 − 1 = 1.046 position ticks, 0.2092 ms.
#[test]
fn a_large_feedforward_is_not_far_ahead_in_fixed_point() {
    let set: Set = |s, ahead_s| {
        s.position_gain_per_s = 1.0;
        s.feedforward_ahead_s = ahead_s;
    };
    ranges::<Fixed>("feedforward_ahead_s", set, [0.0, (0.999 * 128.0 / 62.5 - 1.0) * 200e-6]);
}

/// Signals of 99 % of the range are declared at most: 131 072 errors of 1.024 µm, and increments of 16 nm per tick of 50 µs.
#[test]
fn a_limit_that_a_signal_does_not_hold_is_refused() {
    for (name, set, greatest) in [
        (
            "following_error_limit_m",
            (|s, value| s.following_error_limit_m = value) as Set,
            0.99 * 131_072.0 * 1.024e-6,
        ),
        ("fastest_m_per_s", |s, value| s.fastest_m_per_s = Some(value), 0.99 * 131_072.0 * 16e-9 * 20_000.0),
    ] {
        assert_eq!(refused::<Fixed>(set, greatest * (1.0 - 1e-12)), None, "{name}");
        let Some(ConfigError::OutOfRange { name: found, min: 0.0, max }) =
            refused::<Fixed>(set, 1.001 * greatest)
        else {
            panic!("{name}")
        };
        assert!(found == name && (max / greatest - 1.0).abs() < 1e-12, "{found}: {max}");
        assert_eq!(refused::<Fixed>(set, 0.0).map(|error| error.name()), Some(name));
    }
}

/// The velocity loop runs at 1 Hz to 1 MHz, and a position loop at least in every tick.
#[test]
fn rates_have_their_range() {
    let of = |velocity_loop_hz, position_loop_divider| {
        let settings =
            AxisSettings { position_gain_per_s: 0.1, velocity_lag_s: 0.0, ..AxisSettings::default() };
        AxisConfig::<f64>::new(&settings, Rates { velocity_loop_hz, position_loop_divider }).err()
    };
    assert_eq!((of(1.0, 1), of(1e6, 1)), (None, None));
    let error = ConfigError::OutOfRange { name: "velocity_loop_hz", min: 1.0, max: 1e6 };
    assert_eq!((of(0.99, 1), of(1.01e6, 1)), (Some(error), Some(error)));
    assert_eq!(of(20_000.0, 0), Some(ConfigError::NotPositive("position_loop_divider")));
}

/// Soft limits are in order and within 100 m.
#[test]
fn soft_limits_are_in_order() {
    let of = |travel_m| {
        AxisConfig::<f64>::new(&AxisSettings { travel_m: Some(travel_m), ..SETTINGS() }, RATES).err()
    };
    assert_eq!(of([-100.0, 100.0]), None);
    for travel_m in [[0.1, 0.1], [0.2, 0.1]] {
        assert_eq!(of(travel_m), Some(ConfigError::NotPositive("travel_m")));
    }
    let error = ConfigError::OutOfRange { name: "travel_m", min: -100.0, max: 100.0 };
    assert_eq!((of([-100.1, 0.0]), of([0.0, 100.1])), (Some(error), Some(error)));
}

/// A quarter of the range of 32 bits less one, which four times a tick does not exceed; the least deceleration is a step of it.
#[test]
fn extreme_times_saturate() {
    let of = |settings| AxisConfig::<f64>::new(&settings, RATES).unwrap();
    let axis = of(AxisSettings { saturation_time_s: 1e9, ..SETTINGS() });
    assert_eq!(axis.monitor.saturation_budget_ticks, (1 << 30) - 2);
    assert_eq!(of(AxisSettings { stop_deceleration_m_per_s2: 1e-20, ..SETTINGS() }).stop_deceleration, 1);
}
