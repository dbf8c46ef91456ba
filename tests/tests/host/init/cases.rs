//! The blind cases, of which only the nameplate is known: lead and pole pairs.

use std::path::Path;

use super::{initial, leaves_no_more};
use crate::traces::{self, Traced};
use model::axis::Settings;
use model::machine::{Axis, Machine};
use tests::cases;
use trace::trace;

/// The declared machine with the values of its nameplates alone.
fn nameplate(declared: &Machine) -> Machine {
    let mut machine = Machine { velocity_loop_rate_hz: None, ..declared.clone() };
    for axis in machine.axis.values_mut() {
        let mut settings = Settings::default();
        settings.mechanics.lead_mm = axis.settings.mechanics.lead_mm;
        settings.sensors.resolver_pole_pairs = axis.settings.sensors.resolver_pole_pairs;
        *axis = Axis { settings, ..Axis::default() };
    }
    machine
}

/// A trace with the estimated file leaves no more than one with the declared file, whose controller is exact; the estimated settings
/// are within 1 % of it, the rate of the velocity loop, the law and the feedback are the true ones.
fn is_as_good_as_declared(folder: &Path) {
    let Traced { fit, validate, trace: declared } = &*traces::of_case(folder);
    let initial = initial(&nameplate(declared.machine()), fit);
    assert_eq!(initial.machine.rates(), declared.machine().rates(), "{}", folder.display());
    // Where the case has an undeclared deviation of the setting, the estimated one is the true one.
    let mut found = declared.axes().iter().flat_map(|axis| &axis.found);
    let has_own_gain = found.any(|found| found.effect.name() == "servo_mismatch");
    for (name, axis) in &declared.machine().axis {
        let own = &initial.machine.axis[name].settings;
        assert_eq!(own.controller.law, axis.settings.controller.law);
        assert_eq!(own.sensors.feedback, axis.settings.sensors.feedback, "{} {name}", folder.display());
        for key in ["position_gain_per_s", "feedforward_percent", "velocity_gain_n_s_per_m"] {
            let key = model::axis::Tolerated::with_key(key).unwrap();
            let ratio = (key.get)(own).unwrap() / (key.get)(&axis.settings).unwrap();
            assert!(
                has_own_gain || (0.99..1.01).contains(&ratio),
                "{} {name} {}: {ratio}",
                folder.display(),
                key.key
            );
        }
    }
    let estimated = trace(&initial.machine, fit, validate, &|_| {}).unwrap();
    leaves_no_more(&folder.display().to_string(), &estimated, declared);
}

#[test]
fn the_first_case() {
    let Some(folders) = cases::folders() else { return };
    is_as_good_as_declared(&folders[0]);
}

#[test]
fn all_other_cases() {
    let Some(folders) = cases::folders() else { return };
    folders[1..].iter().for_each(|folder| is_as_good_as_declared(folder));
}
