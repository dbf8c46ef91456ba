//! Measured machines: the axis EMPS, a robot, and a motor. Of each there is one recording: the file is estimated from its first half,
//! and judged by traces of its second half; of the motor, of its middle half and of the rest.

use super::{initial, leaves_no_more};
use files::log::Log;
use import::request::Request;
use model::axis::{Drive, Settings, Tolerated};
use model::effects::Stage;
use model::machine::Machine;
use std::path::Path;
use tests::data::data_folder;
use trace::trace;

/// Nothing is known. Published: Kp 160.18 1/s, Kv 8557 N·s/m, mass 95.1 kg, Coulomb friction 20.4 N, viscous friction 203.5 N·s/m (Janot,
/// Gautier and Brunot, 2019), with a velocity from a mean of two samples, which our loop has as an effect: Kv is 2 % apart.
#[test]
fn emps() {
    let Some(data) = data_folder("data/emps") else { return };
    let machine = Machine::read(&data.join("machine.toml")).unwrap();
    let log = Log::read(&data.join("train.csv")).unwrap();
    let [estimated_from, other] = halves(&log);
    let of_logs = |logs: &[Log]| initial(&init::unknown("EMPS", logs).unwrap(), logs).machine;
    let [of_all, of_half] = [of_logs(&[log]), of_logs(&estimated_from)];
    for (key, published, percent) in [
        ("position_gain_per_s", 160.18, 1.0),
        ("velocity_gain_n_s_per_m", 8557.4, 4.0),
        ("table_mass_kg", 95.1, 2.0),
        ("coulomb_n", 20.4, 15.0),
        ("viscous_n_s_per_m", 203.5, 10.0),
    ] {
        let tolerated = Tolerated::with_key(key).unwrap();
        let deviation = |settings: &Settings| ((tolerated.get)(settings).unwrap() / published - 1.0).abs();
        let [all, half] = [&of_all, &of_half].map(|machine| &machine.axis["x"].settings);
        assert!(100.0 * deviation(all) < percent, "{key}: {}", deviation(all));
        // Of half the data: within its tolerance. One of more than a fifth would promise nothing.
        let tolerance = tolerated.tolerance(half);
        assert!(deviation(half) < tolerance && tolerance <= 0.2, "{key}: {} ± {tolerance}", deviation(half));
    }
    for machine in [&of_all, &of_half] {
        let controller = &machine.axis["x"].settings.controller;
        assert_eq!((controller.feedforward_percent, controller.velocity_integral_time_s), (None, None));
    }
    leaves_no_more_of("EMPS", &of_half, &machine, &other);
}

/// An arm that gravity and other axes move is no axis of ours: what does not describe it is left unknown.
#[test]
fn a_robot_keeps_unknown_what_is_not_shown() {
    let Some(data) = data_folder("data/kuka") else { return };
    let machine = Machine::read(&data.join("machine.toml")).unwrap();
    let [estimated_from, other] = halves(&Log::read(&data.join("recording_a.csv")).unwrap());
    let initial = initial(&init::unknown("robot", &estimated_from).unwrap(), &estimated_from);
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
    leaves_no_more_of("robot", &initial.machine, &machine, &other);
}

/// HSM150: a motor that is turned up by a torque. Its catalogue: 0.12 g·m² and 70.3 µN·m·s, Coulomb friction not told. The file with
/// these values leaves no less of the torque than the estimated one.
#[test]
fn a_motor_in_radians() {
    let Some(data) = data_folder("data/hsm150") else { return };
    let log = imported(&data.join("idf_pos_0.06_1.mat"));
    // With one level of torque, inertia, viscous and Coulomb friction cannot be separated. It steps in the middle of the recording.
    let quarter = log.len() / 4;
    let estimated_from = [log.slice(quarter..3 * quarter)];
    let other = [log.slice(0..quarter), log.slice(3 * quarter..log.len())];
    let initial = initial(&init::unknown("HSM150", &estimated_from).unwrap(), &estimated_from);
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
    let catalogue = Machine::parse(&catalogue, "catalogue.toml").unwrap();
    // Least squares with SciPy 1.17 over filters of 0.1 and 0.5 s: 0.135 and 0.145 g·m².
    let inertia_g_m2 = 1e3 * settings.mechanics.table_mass_kg.unwrap() / unit;
    assert!((0.10..0.16).contains(&inertia_g_m2), "{inertia_g_m2}");
    let force = |machine: &Machine| {
        let trace = trace(machine, &other, &[], &|_| {}).unwrap();
        trace.axes()[0].residual(Stage::Force).unwrap().after.validate
    };
    let [own, catalogue] = [&initial.machine, &catalogue].map(force);
    assert!((0.0..1.1 * catalogue).contains(&own), "{own} N·m, catalogue {catalogue}");
}

/// The halves of a recording, as logs of their own.
fn halves(log: &Log) -> [Vec<Log>; 2] {
    let middle = log.len() / 2;
    [0..middle, middle..log.len()].map(|part| vec![log.slice(part)])
}

/// [`leaves_no_more`], on logs that the file was not estimated from.
fn leaves_no_more_of(name: &str, estimated: &Machine, declared: &Machine, logs: &[Log]) {
    let [own, declared] = [estimated, declared].map(|machine| trace(machine, logs, &[], &|_| {}).unwrap());
    leaves_no_more(name, &own, &declared);
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
