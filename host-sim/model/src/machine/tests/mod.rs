//! Tests of reading, refusing and writing machine files.

mod fitted;
mod gantry;
mod laws;
mod loops;
mod refused;

use std::path::Path;

use super::*;
use crate::axis::{Feedback, Law};
use crate::effects::Effect;

const MACHINE: &str = r#"name = "m"
sample_rate_hz = 1000
velocity_loop_rate_hz = 4000.0

[axis.y]
controller = "hpc"
position_gain_per_s = 40.0
feedforward_percent = 60.0
velocity_gain_n_s_per_m = 5e4
velocity_integral_time_s = 0.02
force_limit_n = 20000.0
motor_mass_kg = 90.0
table_mass_kg = 120.0
stiffness_n_per_um = 150.0
damping_n_s_per_m = 8000.0
coulomb_n = 150.0
viscous_n_s_per_m = 900.0
motor_coulomb_n = 40.0
presliding_stiffness_n_per_um = 40.0
presliding_damping_n_s_per_m = 2000.0
plant_tolerance_percent = 10.0
lead_mm = 16
resolver_pole_pairs = 5
feedback = "dual"
dual_feedback_time_constant_s = 0.08

[[axis.y.effect]]
name = "backlash"
width_um = 9.5

[[axis.y.effect]]
name = "crosstalk"
um_s2_per_m = -1
source = "x"

[[axis.y.effect]]
name = "latency"
channel = "table"
ms = 0.4

[axis.x]
"#;

/// The error message for [`MACHINE`] with one replacement.
fn error_after(from: &str, to: &str) -> String {
    let text = MACHINE.replacen(from, to, 1);
    assert_ne!(text, MACHINE);
    Machine::parse(&text, "m.toml").err().unwrap_or_else(|| panic!("accepted:\n{text}")).to_string()
}

#[test]
fn axes_are_read_in_the_order_of_the_file() {
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    assert_eq!(machine.axis.keys().collect::<Vec<_>>(), ["y", "x"]);
    let (y, x) = (&machine.axis["y"], &machine.axis["x"]);
    assert_eq!(y.settings.mechanics.lead_mm, Some(16.0));
    let [of_y, of_x] = [&y.settings, &x.settings];
    assert_eq!((of_y.controller.law, of_y.sensors.feedback), (Some(Law::Hpc), Feedback::Dual));
    assert_eq!(y.effect.iter().map(Effect::name).collect::<Vec<_>>(), ["backlash", "crosstalk", "latency"]);
    let has_controller = |axis: &crate::axis::Settings| {
        let controller = &axis.controller;
        controller.law.is_some()
            && controller.position_gain_per_s.is_some()
            && controller.velocity_gain_n_s_per_m.is_some()
    };
    assert!(has_controller(of_y) && of_y.has_mass() && !of_y.is_rigid());
    assert!(!has_controller(of_x) && !of_x.has_mass() && of_x.is_rigid());
    assert_eq!(of_x.sensors.feedback, Feedback::Motor);
    assert_eq!(machine.others("x"), ["y"]);
}

#[test]
fn the_velocity_loop_runs_at_the_sample_rate_unless_declared() {
    let text = MACHINE.replacen("velocity_loop_rate_hz = 4000.0\n", "", 1);
    let machine = Machine::parse(&text, "m.toml").unwrap();
    assert!((machine.velocity_rate_hz() - 1000.0).abs() < 1e-12);
}

#[test]
fn a_written_machine_is_read_as_the_same_machine() {
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    let text = machine.to_toml();
    assert_eq!(Machine::parse(&text, "again.toml").unwrap(), machine, "{text}");
    let lines: Vec<&str> = text.lines().collect();
    let position = |line: &str| lines.iter().position(|l| *l == line).unwrap_or_else(|| panic!("{text}"));
    assert!(position("[axis.y]") < position("controller = \"hpc\""), "{text}");
    assert!(position("controller = \"hpc\"") < position("[[axis.y.effect]]"), "{text}");
    assert!(position("[[axis.y.effect]]") < position("[axis.x]"), "{text}");
}

/// For every effect of the catalogue, with its name as tag and unknown keys denied.
#[test]
fn every_written_effect_is_read_as_the_same_effect() {
    let mut machine = Machine::parse(MACHINE, "m.toml").unwrap();
    // If presliding is declared, it is not searched for.
    let mechanics = &mut machine.axis["y"].settings.mechanics;
    mechanics.presliding_stiffness_n_per_um = None;
    mechanics.presliding_damping_n_s_per_m = None;
    let axis = machine.axis["y"].settings.clone();
    let stages = {
        use crate::effects::Stage::{Force, Motor, Table, Tool};
        [Motor, Table, Tool, Force]
    };
    let others = ["x".to_owned()];
    let with_all_stages = crate::effects::EffectContext {
        axis: &axis,
        logged: crate::effects::LoggedChannels::ALL,
        first: true,
        others: &others,
        stages: &stages,
        travel_mm: [0.0, 100.0],
        effects: &["backlash"],
        residual: &crate::effects::ResidualShape::over("x"),
    };
    let force_only = crate::effects::EffectContext { stages: &stages[3..], ..with_all_stages };
    // The angle of the probe is searched on the second axis; errors of the scale are searched as those of the screw.
    let second = crate::effects::EffectContext { first: false, ..with_all_stages };
    let mut unknown = crate::axis::Settings::default();
    unknown.controller.drive = crate::axis::Drive::Stepper;
    unknown.mechanics.lead_mm = Some(5.0);
    let no_force = crate::effects::LoggedChannels { force: false, ..with_all_stages.logged };
    let other = ["y".to_owned()];
    let over_y = crate::effects::ResidualShape::over("y");
    let stepper = crate::effects::EffectContext {
        axis: &unknown,
        others: &other,
        logged: no_force,
        residual: &over_y,
        ..with_all_stages
    };
    let of_scale =
        ["name = 'scale_gain'\num_per_m = 5", "name = 'scale_cyclic'\namplitude_um = 1\nperiod_mm = 40"];
    let mut all = [with_all_stages, force_only, second]
        .map(|context| crate::effects::initial_guesses(&context))
        .concat();
    all.extend(of_scale.map(|effect| toml::from_str::<Effect>(effect).unwrap()));
    all.extend(crate::effects::KINDS.iter().flat_map(|kind| (kind.assumed)()));
    let of_unknown = crate::effects::initial_guesses(&stepper);
    let names: Vec<&str> = all.iter().chain(&of_unknown).map(Effect::name).collect();
    // Of rotary axes: `gravity_is_that_of_a_rotary_axis`, `the_hysteresis_of_a_gear_has_the_keys_of_its_axis`.
    let of_rotary = ["gravity", "gear_hysteresis"];
    assert!(crate::effects::names().iter().all(|name| names.contains(name) || of_rotary.contains(name)));
    // Axis x declares nothing but its drive.
    machine.axis["x"].settings.controller.drive = crate::axis::Drive::Stepper;
    let placed =
        all.into_iter().map(|effect| ("y", effect)).chain(of_unknown.into_iter().map(|effect| ("x", effect)));
    for (axis, effect) in placed {
        machine.axis[axis].effect = vec![effect];
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
        machine.axis[axis].effect.clear();
    }
}

/// With its keys in N·m; an axis with keys of linear ones is refused.
#[test]
fn gravity_is_that_of_a_rotary_axis() {
    let inertias = "motor_inertia_kg_m2 = 0.5\ntable_inertia_kg_m2 = 2.0";
    let file = |keys: &str| {
        let effect = "[[axis.c.effect]]\nname = 'gravity'\nsine_nm = 5.0\ncosine_nm = -8.0";
        format!("name = 'm'\nsample_rate_hz = 1000.0\n[axis.c]\n{keys}\n{effect}\n")
    };
    let machine = Machine::parse(&file(inertias), "m.toml").unwrap();
    assert_eq!(machine.axis["c"].effect[0].values(), [5.0, -8.0]);
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    let linear = file("").replace("_nm", "_n");
    let refused = Machine::parse(&linear, "m.toml").err().unwrap().to_string();
    assert!(refused.contains("this effect only on a rotary axis"), "{refused}");
}

/// In N·m and mdeg; a belt drives a linear axis, in N and µm.
#[test]
fn the_hysteresis_of_a_gear_has_the_keys_of_its_axis() {
    let rotary = "motor_inertia_kg_m2 = 5.0\ntable_inertia_kg_m2 = 6.0\nstiffness_nm_per_rad = 5e6\n[[axis.c.effect]]\nname = 'gear_hysteresis'\nforce_nm = 60.0\ntravel_mdeg = 1.5";
    let linear = "motor_mass_kg = 80.0\ntable_mass_kg = 100.0\nstiffness_n_per_um = 90.0\n[[axis.c.effect]]\nname = 'gear_hysteresis'\nforce_n = 60.0\ntravel_um = 1.5";
    for keys in [rotary, linear] {
        let text = format!("name = 'm'\nsample_rate_hz = 1000.0\n[axis.c]\n{keys}\n");
        let machine = Machine::parse(&text, "m.toml").unwrap();
        assert_eq!(machine.axis["c"].effect[0].values(), [60.0, 1.5]);
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    }
    let rigid = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.c]\n[[axis.c.effect]]\nname = 'gear_hysteresis'\nforce_n = 60.0\ntravel_um = 1.5\n";
    let refused = Machine::parse(rigid, "m.toml").err().unwrap().to_string();
    assert!(refused.contains("only where the stiffness between motor and table is given"), "{refused}");
}

#[test]
fn files_that_are_not_machine_files_are_refused() {
    let cases = [
        ("", "name: expected this key"),
        ("time_s,x_command_mm\n0,1\n", "line 1: expected valid TOML"),
        ("name = \"m\"\nsample_rate_hz = 1", "axis: expected this key, found none"),
        ("name = \"m\"\nsample_rate_hz = 1\n[axis]", "line 3: axis: expected at least one table"),
    ];
    for (text, wanted) in cases {
        let message = Machine::parse(text, "m.toml").unwrap_err().to_string();
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let error = |path: &Path| Machine::read(path).unwrap_err().to_string();
    assert!(error(folder.path()).contains(": expected a readable file: "));
    assert!(error(&folder.path().join("no.toml")).contains("no.toml: expected a readable file: "));
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"name = 1\n\xff").unwrap();
    assert!(error(&binary).contains("line 2: expected UTF-8 text, found byte 0xFF"));
}

/// Each typing error of one character gives a valid machine or an error message of one line.
#[test]
fn no_typing_error_causes_a_panic() {
    for at in 0..MACHINE.len() {
        for typed in ["", "\"", "[", "]", ".", "\n", "-", "9", "e", " ", "=", "ä"] {
            let text = format!("{}{typed}{}", &MACHINE[..at], &MACHINE[at + 1..]);
            if let Err(error) = Machine::parse(&text, "m.toml") {
                assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
