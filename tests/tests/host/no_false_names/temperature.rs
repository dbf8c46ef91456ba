//! Friction that depends on the temperature of the guide, in logs with that channel and without.

use model::effects::{Effect, FrictionTemperature};
use self_test::warming::Warming;
use trace::trace;
use trace::verdict::{self, Verdict};

use super::machine::TestMachine;
use super::reported::{assert_named, assert_value, certain, context, found};

/// A guide that warms up by 6 °C while its cooler cycles by ±2 °C: neither a function of the time of the session that another effect has, nor of
/// the motion.
const WARMING: Warming = Warming {
    start_c: 19.0,
    rise_c: 6.0,
    time_constant_s: 60.0,
    cycle_c: 2.0,
    cycle_s: 80.0,
    cycle_rad: 0.7,
    viscosity_per_c: 0.04,
    level_per_c: 0.01,
};

/// The machine with such a guide on its second axis.
fn warm(warming: Warming) -> TestMachine {
    TestMachine::new(31).with_mechanics(1, |mechanics| mechanics.warming = Some(warming))
}

/// The level changes by 1 % of the Coulomb friction per degree. The viscosity is by Vogel's law: at a temperature T, its slope is 4 %/°C times
/// ((T0 + 95)/(T + 95))², T0 = 19 + 0.7·6 °C, which the tracer gives at its reference; its interval is narrower than half of it. The sensor, a lag of 3 s, is late by 2.9 to 3 s in cycles of 80 s; early in the
/// warm-up by exp(t/τ) less.
#[test]
fn friction_by_temperature_is_found_with_its_size_and_the_lag_of_the_sensor() {
    let machine = warm(WARMING);
    let coulomb_n = machine.drawn.axes[1].mechanics.coulomb_n;
    let traced = machine.trace();
    assert_named(&traced, &[("y", "friction_temperature")]);
    assert_eq!(certain(&traced), [("y", "friction_temperature")], "{}", context(&traced));
    let found = found(&traced, 1, "friction_temperature");
    let Effect::FrictionTemperature(effect) = &found.effect else { panic!("{}", context(&traced)) };
    assert_value(found, "level_n_per_c", -0.01 * coulomb_n, 0.004 * coulomb_n);
    let percent = -4.0 * ((23.2 + 95.0) / (effect.reference_c + 95.0)).powi(2);
    assert_value(found, "viscous_percent_per_c", percent, 2.0);
    assert!((1.5..4.0).contains(&effect.sensor_late_s), "{}", context(&traced));
}

/// The same friction without the channel: nothing tells a name for certain, and what remains is not called noise.
#[test]
fn without_the_temperature_its_friction_has_no_certain_name() {
    let traced = warm(WARMING).trace_of(|log| log.axes[1].temperature = None);
    assert_eq!(certain(&traced), [], "{}", context(&traced));
    assert_ne!(verdict::of(&traced), Verdict::Explained, "{}", context(&traced));
}

/// Of a temperature on which no friction depends, nothing is said, and nothing else changes.
#[test]
fn a_temperature_on_which_nothing_depends_changes_nothing() {
    let machine = warm(Warming { viscosity_per_c: 0.0, level_per_c: 0.0, ..WARMING });
    let [with, without] = [machine.trace(), machine.trace_of(|log| log.axes[1].temperature = None)];
    assert_named(&with, &[]);
    assert_eq!(context(&with), context(&without));
}

/// A temperature that one of the logs lacks is not used, and this is told; a machine file that needs it is refused with the log and the column.
#[test]
fn a_log_without_the_temperature_is_told() {
    let machine = warm(WARMING);
    let traced = machine.trace_of(|log| {
        if log.source == "validate_corner" {
            log.axes[1].temperature = None;
        }
    });
    let note = "y temperature is not used, as validate_corner has none.";
    assert!(traced.notes().iter().any(|found| found == note), "{:?}", traced.notes());
    assert!(!certain(&traced).contains(&("y", "friction_temperature")));

    let mut file = machine.file();
    let declared = FrictionTemperature { level_n_per_c: -1.0, ..FrictionTemperature::at_reference(20.0) };
    file.axis["y"].effect.push(Effect::FrictionTemperature(declared));
    let [mut fit, validate] = machine.logs();
    fit[0].axes[1].temperature = None;
    let refused = trace(&file, &fit, &validate, &|_| {}).map(|_| ()).unwrap_err().to_string();
    let expected = format!("{}: expected the column y_temperature_c", fit[0].source);
    assert!(refused.starts_with(&expected) && refused.ends_with("found none"), "{refused}");
}
