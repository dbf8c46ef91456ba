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

/// A trace whose machine file has the nameplate alone estimates the rest, and finds what one with the declared file finds: nothing. The masses are
/// within 5 % of the true ones. A stiffness without masses is accepted, and kept beside the masses that are estimated.
#[test]
fn a_trace_estimates_what_the_file_does_not_say() {
    let Some(folders) = cases::folders() else { return };
    let Traced { fit, validate, trace: declared } = &*traces::of_case(&folders[0]);
    let mut known = nameplate(declared.machine());
    let stiffness = declared.machine().axis["x"].settings.mechanics.stiffness_n_per_um;
    known.axis["x"].settings.mechanics.stiffness_n_per_um = stiffness;
    let known = Machine::parse(&known.to_toml(), "m.toml").unwrap();
    let (machine, notes) = init::estimate::unknown_values(&known, fit, &|_| {});
    assert_eq!(notes.len(), 2, "{notes:?}");
    assert!(
        notes[0].starts_with("x: not in the machine file, and estimated from the fitted logs: motor_mass_kg")
    );
    assert!(!notes[0].contains("stiffness_n_per_um") || notes[0].contains("presliding_stiffness_n_per_um"));
    for (name, axis) in &declared.machine().axis {
        let [own, truth] = [&machine.axis[name], axis].map(|axis| &axis.settings.mechanics);
        let masses = [(own.motor_mass_kg, truth.motor_mass_kg), (own.table_mass_kg, truth.table_mass_kg)];
        for (own_kg, true_kg) in masses {
            let ratio = own_kg.unwrap() / true_kg.unwrap();
            assert!((0.95..1.05).contains(&ratio), "{name}: {ratio}");
        }
    }
    assert_eq!(machine.axis["x"].settings.mechanics.stiffness_n_per_um, stiffness);
    let estimated = trace(&machine, fit, validate, &|_| {}).unwrap();
    let found: Vec<_> =
        estimated.axes().iter().flat_map(|axis| &axis.found).map(|f| f.effect.name()).collect();
    assert!(found.is_empty(), "{found:?}");
}

/// Without a force, nothing estimates the masses, and the stiffness says nothing, which is told.
#[test]
fn a_stiffness_without_masses_and_force_is_not_used() {
    let text = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.x]\nlead_mm = 10\nstiffness_n_per_um = 200\n";
    let machine = Machine::parse(text, "m.toml").unwrap();
    let (same, notes) = init::estimate::unknown_values(&machine, &[], &|_| {});
    assert_eq!(same, machine);
    assert_eq!(
        notes,
        ["x: stiffness_n_per_um is not used, as motor_mass_kg and table_mass_kg are not known."]
    );
    assert!(machine.axis["x"].settings.is_rigid());
}

#[test]
fn all_other_cases() {
    let Some(folders) = cases::folders() else { return };
    folders[1..].iter().for_each(|folder| is_as_good_as_declared(folder));
}
