//! The force after an enable: it begins with the preload and has no jump.

use proptest::prelude::*;
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{ForceModel, Points};
use shared::config::{AxisSettings, Brake, LowPass, Notch, Notches, Rates};
use shared::machine::{Machine, Reading};
use shared::safety::Power;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use super::{TICK_S, loops};

/// A compensation of a load that is the same everywhere, N. It rises by 0.05 N in a tick.
fn load(load_n: f64) -> CompensationSettings {
    let load = Points { start_m: -0.1, spacing_m: 0.1, values: [load_n; 3].into_iter().collect() };
    CompensationSettings {
        force: Some(ForceModel { load: Some(load), ..ForceModel::default() }),
        force_bound_n: 400.0,
        force_rate_n_per_s: 1000.0,
        ..CompensationSettings::default()
    }
}

/// The forces of an axis that stands from its enable until long after its brake has opened.
fn forces<S: Scalar>(settings: &AxisSettings, load_n: Option<f64>) -> Vec<f64> {
    let rates = Rates { velocity_loop_hz: 1.0 / TICK_S, position_loop_divider: 5 };
    let mut machine = Machine::<S, 1>::new(rates, &[*settings], [Position(0)]).unwrap();
    if let Some(load_n) = load_n {
        machine.compensate(0, &load(load_n)).unwrap();
    }
    let reading = [Reading { motor: Position(0), table: None }];
    machine.enable();
    let forces = (0..400).map(|_| machine.tick(&reading).forces[0].value()).collect();
    assert_eq!(machine.power(), Power::On);
    forces
}

/// Greatest distance of a force from the preload, N.
fn greatest_step_n<S: Scalar>(settings: &AxisSettings, load_n: Option<f64>) -> f64 {
    let preload_n = settings.preload_n.unwrap();
    forces::<S>(settings, load_n).into_iter().map(|n| (n - preload_n).abs()).fold(0.0, f64::max)
}

/// Ti is below 0.137 s, the greatest that fixed point resolves at the lowest Kv.
fn settings() -> impl Strategy<Value = AxisSettings> {
    let filter = (any::<bool>(), any::<bool>(), any::<bool>(), any::<bool>());
    (-250.0..250.0, 500.0..20_000.0, 0.005..0.13, filter).prop_map(
        |(preload_n, velocity_gain_n_s_per_m, ti_s, (integral, notch, low_pass, brake))| AxisSettings {
            preload_n: Some(preload_n),
            velocity_gain_n_s_per_m,
            velocity_integral_time_s: integral.then_some(ti_s),
            notches: Notches(
                [300.0, 150.0, 900.0, 500.0]
                    .map(|hz| notch.then_some(Notch { frequency_hz: hz, width_hz: 60.0, depth: 0.9 })),
            ),
            low_pass: low_pass.then_some(LowPass { frequency_hz: 1000.0, damping_ratio: 0.7 }),
            brake: brake.then_some(Brake { release_s: 5e-3, engage_s: 5e-3 }),
            ..loops()
        },
    )
}

proptest! {
    /// An axis that stands needs the preload and nothing else, whatever the loops, their filters, the brake and the compensation: no tick
    /// differs from it by more than the rounding, neither the first one nor that in which the brake has opened. A compensation of the load
    /// is part of it and is not added.
    #[test]
    fn the_force_is_the_preload_from_the_first_tick_on(
        axis in settings(), load_n in proptest::option::of(-250.0..250.0),
    ) {
        // A signal of f32 at 256 N has steps of 30 µN, one in fixed point 61 µN; filters and sums round several times.
        prop_assert!(greatest_step_n::<Fixed>(&axis, load_n) < 1e-3);
        prop_assert!(greatest_step_n::<f32>(&axis, load_n) < 1e-2);
        prop_assert!(greatest_step_n::<f64>(&axis, load_n) < 1e-3);
    }
}

/// A load of 100 N beside a preload of 100 N is 100 N. Without a preload it rises at its limited rate, as it does with a preload in no tick.
#[test]
fn a_load_that_is_compensated_is_not_added_to_the_preload() {
    let preloaded = AxisSettings { preload_n: Some(100.0), ..loops() };
    assert!(greatest_step_n::<Fixed>(&preloaded, Some(100.0)) < 1e-3);
    let rising = forces::<Fixed>(&loops(), Some(100.0));
    assert!(rising[0] <= 0.051 && (rising[399] - 20.0).abs() < 0.1, "{} N, {} N", rising[0], rising[399]);
}

/// A preload of zero is known to be zero; without one the force of the compensation rises from zero.
#[test]
fn no_preload_is_not_a_preload_of_zero() {
    let of = |preload_n| forces::<Fixed>(&AxisSettings { preload_n, ..loops() }, Some(-50.0));
    assert!(of(Some(0.0)).iter().all(|n| n.abs() < 1e-3));
    assert!(of(None)[399] < -19.0);
    assert!(forces::<Fixed>(&loops(), None).iter().all(|n| n.abs() < 1e-12));
}
