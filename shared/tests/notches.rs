//! Several notches of an axis: their order, gaps between them, and what they do to a force.

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, ConfigError, NOTCHES, Notch, Notches, Rates};
use shared::control::filter::{Filter, State};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATE_HZ: f64 = 20_000.0;
const RATES: Rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };

const fn notch(frequency_hz: f64) -> Notch {
    Notch { frequency_hz, width_hz: 90.0, depth: 0.9 }
}

fn reading(motor_m: f64) -> Reading {
    Reading { motor: Position::from_m(motor_m).unwrap(), table: None }
}

fn filter<S: Scalar>(notch: &Notch) -> Filter<S> {
    let g = libm::tan(core::f64::consts::PI * notch.frequency_hz / RATE_HZ);
    Filter::notch(g, notch.width_hz / notch.frequency_hz, notch.depth)
}

/// Forces of an axis whose motor moves irregularly: the velocity loop without an integral part is a gain, so that without filters they
/// are the input of the filters.
fn forces<S: Scalar>(notches: [Option<Notch>; NOTCHES]) -> Vec<S> {
    let settings =
        AxisSettings { velocity_integral_time_s: None, notches: Notches(notches), ..AxisSettings::default() };
    let config = AxisConfig::<S>::new(&settings, RATES).unwrap();
    let mut state = AxisState::at_rest(Position(0), reading(0.0));
    let motor_m = |tick: i32| 5e-8 * f64::from(tick * tick % 61 - tick * 7 % 23);
    (0..500).map(|tick| state.velocity_tick(&config, reading(motor_m(tick)), S::ZERO).0).collect()
}

/// The bits are those of the filters one after the other, in the order of the settings.
fn act_in_order<S: Scalar>() {
    let declared = [400.0, 900.0, 150.0, 1500.0].map(notch);
    let mut filters = declared.map(|notch| (filter::<S>(&notch), State::<S>::AT_REST));
    let expected: Vec<f64> = forces::<S>([None; NOTCHES])
        .into_iter()
        .map(|force| {
            filters.iter_mut().fold(force, |force, (filter, state)| filter.step(state, force)).value()
        })
        .collect();
    let found: Vec<f64> = forces::<S>(declared.map(Some)).into_iter().map(Scalar::value).collect();
    assert!(expected.iter().any(|force| force.abs() > 10.0), "{}", S::NAME);
    assert_eq!(found, expected, "{}", S::NAME);
}

#[test]
fn notches_act_in_their_order_to_the_last_bit() {
    act_in_order::<Fixed>();
    act_in_order::<f32>();
    act_in_order::<f64>();
}

/// A notch behind a gap acts as one without it.
#[test]
fn a_gap_ends_nothing() {
    let with_gap = forces::<Fixed>([None, Some(notch(400.0)), None, Some(notch(900.0))]);
    assert_eq!(with_gap, forces::<Fixed>([Some(notch(400.0)), Some(notch(900.0)), None, None]));
    assert_ne!(with_gap, forces::<Fixed>([Some(notch(400.0)), None, None, None]));
}

/// What is wrong with the last notch is named as what is wrong with the first.
#[test]
fn each_notch_is_checked() {
    for at in 0..NOTCHES {
        let mut settings =
            AxisSettings { notches: Notches([Some(notch(400.0)); NOTCHES]), ..AxisSettings::default() };
        settings.notches.0[at] = Some(notch(0.46 * RATE_HZ));
        let error = AxisConfig::<Fixed>::new(&settings, RATES).unwrap_err();
        assert!(matches!(error, ConfigError::OutOfRange { name: "notch_frequency_hz", .. }), "{error:?}");
    }
}
