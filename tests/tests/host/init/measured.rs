//! Measured machines: the axis EMPS, a robot, and a motor.

use super::{initial, leaves_no_more};
use crate::traces::{self, Traced};
use files::log::Log;
use import::request::Request;
use model::axis::{Drive, Settings};
use model::effects::Stage;
use model::machine::Machine;
use std::path::Path;
use tests::data::data_folder;
use trace::{Identification, trace};

/// Nothing is known. Published: Kp 160.18 1/s, Kv 8557 N·s/m, mass 95.1 kg, Coulomb friction 20.4 N, viscous friction 203.5 N·s/m (Janot,
/// Gautier and Brunot, 2019), with a velocity from a mean of two samples, which our loop has as an effect: Kv is 2 % apart.
#[test]
fn emps() {
    let Some(data) = data_folder("data/emps") else { return };
    let Traced { fit, trace: declared, .. } = &*traces::of_measured(&data, "train.csv");
    let initial = initial(&init::unknown("EMPS", fit).unwrap(), fit);
    let Settings { controller, mechanics, .. } = &initial.machine.axis["x"].settings;
    let near = |value: Option<f64>, published: f64, percent: f64| {
        let value = value.unwrap();
        assert!((100.0 * (value / published - 1.0)).abs() < percent, "{value} {published}");
    };
    near(controller.position_gain_per_s, 160.18, 1.0);
    near(controller.velocity_gain_n_s_per_m, 8557.4, 4.0);
    near(mechanics.table_mass_kg, 95.1, 2.0);
    near(mechanics.coulomb_n, 20.4, 15.0);
    near(mechanics.viscous_n_s_per_m, 203.5, 10.0);
    assert_eq!((controller.feedforward_percent, controller.velocity_integral_time_s), (None, None));
    let estimated = trace(&initial.machine, fit, &[], &|_| {}).unwrap();
    leaves_no_more("EMPS", &estimated, declared);
}

/// An arm that gravity and other axes move is no axis of ours: what does not describe it is left unknown.
#[test]
fn a_robot_keeps_unknown_what_is_not_shown() {
    let Some(data) = data_folder("data/kuka") else { return };
    let Traced { fit, trace: declared, .. } = &*traces::of_measured(&data, "recording_a.csv");
    let initial = initial(&init::unknown("robot", fit).unwrap(), fit);
    for name in ["a2", "a3"] {
        let settings = &initial.machine.axis[name].settings;
        assert!(!settings.has_mass() && settings.is_rigid(), "{name}: {settings:?}");
        assert!(initial.notes.iter().any(|note| note.starts_with(name)), "{:?}", initial.notes);
    }
    for axis in initial.machine.axis.values() {
        assert_eq!(
            (axis.settings.controller.law, axis.settings.controller.position_gain_per_s),
            (None, None)
        );
    }
    let estimated = trace(&initial.machine, fit, &[], &|_| {}).unwrap();
    leaves_no_more("robot", &estimated, declared);
}

/// HSM150: a motor that is turned up by a torque. Its catalogue: 0.12 g·m² and 70.3 µN·m·s, Coulomb friction not told. The file with
/// these values leaves no less of the torque than the estimated one.
#[test]
fn a_motor_in_radians() {
    let Some(data) = data_folder("data/hsm150") else { return };
    let log = imported(&data.join("idf_pos_0.06_1.mat"));
    let logs = std::slice::from_ref(&log);
    let initial = initial(&init::unknown("HSM150", logs).unwrap(), logs);
    let settings = &initial.machine.axis["m"].settings;
    assert_eq!(settings.controller.drive, Drive::Torque);
    // A metre stands for 1000°: N·m per 1000°/s² and per 1000°/s.
    let unit = 1000_f64.to_radians();
    let catalogue = format!(
        "name = \"HSM150\"\nsample_rate_hz = 1000.0\n[axis.m]\ntable_mass_kg = {}\nviscous_n_s_per_m = {}\n\
         plant_tolerance_percent = 10.0\n",
        0.12e-3 * unit,
        70.3e-6 * unit
    );
    let declared = trace(&Machine::parse(&catalogue, "catalogue.toml").unwrap(), logs, &[], &|_| {}).unwrap();
    // Least squares with SciPy 1.17 over filters of 0.1 and 0.5 s: 0.135 and 0.145 g·m².
    let inertia_g_m2 = 1e3 * settings.mechanics.table_mass_kg.unwrap() / unit;
    assert!((0.10..0.16).contains(&inertia_g_m2), "{inertia_g_m2}");
    let estimated = trace(&initial.machine, logs, &[], &|_| {}).unwrap();
    let force = |trace: &Identification| trace.axes()[0].residual(Stage::Force).unwrap().after.validate;
    let [own, catalogue] = [&estimated, &declared].map(force);
    assert!((0.0..1.1 * catalogue).contains(&own), "{own} N·m, catalogue {catalogue}");
}

fn imported(path: &Path) -> Log {
    let mapping = |text: &str| text.parse().unwrap();
    let request = Request {
        mappings: ["time_s=data:1", "m_motor_deg=data:3", "m_force_nm=data:5"].map(mapping).to_vec(),
        units: vec!["m_motor_deg=rad".parse().unwrap()],
        ..Request::default()
    };
    import::any_log::read(path, &request).unwrap().log
}
