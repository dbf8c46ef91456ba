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

/// Keys that may be added to axis y above.
const LOOPS: &str = "smoothing_s = 0.02
smoothing_jerk_s = 0.005
notch_frequency_hz = 120
notch_width_hz = 30.5
notch_depth = 0.9
low_pass_frequency_hz = 800.0
low_pass_damping_ratio = 0.7
travel_mm = [-200, 310.5]
stop_deceleration_m_per_s2 = 3.0
saturation_time_s = 0.25
scale_disagreement_limit_mm = 0.4
fastest_mm_per_s = 900.0
frozen_encoder_limit_mm = 0.3
";

/// The machine above with more keys in axis y.
fn with(loops: &str) -> String {
    MACHINE.replacen("controller = ", &format!("{loops}controller = "), 1)
}

#[test]
fn filters_and_limits_reach_the_controller_in_its_units() {
    use shared::config::{LowPass, Notch};
    use shared::interpolate::Smoothing;

    let settings = |text: &str| {
        let machine = Machine::parse(text, "m.toml").unwrap();
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
        let axis = &machine.axis["y"];
        crate::servo::settings(&axis.settings, &crate::servo::ServoParameters::of(&axis.effect)).unwrap()
    };
    let given = settings(&with(LOOPS));
    assert_eq!(given.smoothing, Smoothing::SCurve { time_s: 0.02, jerk_time_s: 0.005 });
    assert_eq!(given.notch, Some(Notch { frequency_hz: 120.0, width_hz: 30.5, depth: 0.9 }));
    assert_eq!(given.low_pass, Some(LowPass { frequency_hz: 800.0, damping_ratio: 0.7 }));
    let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
    let [least, greatest] = given.travel_m.unwrap();
    close(least, -0.2);
    close(greatest, 0.3105);
    close(given.stop_deceleration_m_per_s2, 3.0);
    close(given.saturation_time_s, 0.25);
    close(given.scale_disagreement_limit_m.unwrap(), 0.4e-3);
    close(given.fastest_m_per_s.unwrap(), 0.9);

    let trapezoid = settings(&with("smoothing_s = 0.02\n"));
    assert_eq!(trapezoid.smoothing, Smoothing::Trapezoid { time_s: 0.02 });
    let lag = settings(&with("smoothing_time_constant_s = 0.03\n"));
    assert_eq!(lag.smoothing, Smoothing::Exponential { time_constant_s: 0.03 });

    let (none, default) = (settings(MACHINE), shared::config::AxisSettings::default());
    assert_eq!((none.smoothing, none.notch, none.low_pass), (Smoothing::None, None, None));
    assert_eq!((none.travel_m, none.fastest_m_per_s, none.scale_disagreement_limit_m), (None, None, None));
    close(none.stop_deceleration_m_per_s2, default.stop_deceleration_m_per_s2);
    close(none.saturation_time_s, default.saturation_time_s);
}

/// The sample rate is 1 kHz, that of the velocity loop 4 kHz.
const BAD_LOOPS: &[(&str, &str)] = &[
    ("smoothing_s = 0", "line 6: axis.y.smoothing_s: expected a number above 0, found 0"),
    ("smoothing_s = 0.0014", "axis.y.smoothing_s: expected two samples (0.002 s) or more, found 0.0014"),
    (
        "smoothing_s = 0.513",
        "axis.y.smoothing_s: expected with smoothing_jerk_s at most 512 samples (0.512 s)",
    ),
    (
        "smoothing_jerk_s = 0.01",
        "line 5: axis.y.smoothing_s: expected this key, as smoothing_jerk_s is given",
    ),
    (
        "smoothing_s = 0.01\nsmoothing_jerk_s = 0.02",
        "line 7: axis.y.smoothing_jerk_s: expected a time no longer than smoothing_s, found 0.02",
    ),
    (
        "smoothing_s = 0.3\nsmoothing_jerk_s = 0.3",
        "line 6: axis.y.smoothing_s: expected with smoothing_jerk_s at most 512 samples (0.512 s), found 0.3",
    ),
    (
        "smoothing_s = 0.3\nsmoothing_time_constant_s = 0.3",
        "line 7: axis.y.smoothing_time_constant_s: expected no such key, as smoothing_s is given, found 0.3",
    ),
    ("smoothing_time_constant_s = 2e3", "expected a time of at most a million samples, found 2e3"),
    (
        "notch_frequency_hz = 100.0",
        "axis.y.notch_width_hz: expected this key, as notch_frequency_hz is given",
    ),
    ("notch_depth = 1", "axis.y.notch_frequency_hz: expected this key, as notch_depth is given, found none"),
    (
        "notch_frequency_hz = 2000\nnotch_width_hz = 10\nnotch_depth = 1",
        "line 6: axis.y.notch_frequency_hz: expected a number from 4 to 1800, found 2000",
    ),
    (
        "notch_frequency_hz = 100\nnotch_width_hz = 401\nnotch_depth = 1",
        "line 7: axis.y.notch_width_hz: expected a number from 0 to 400, found 401",
    ),
    ("notch_depth = 1.1", "axis.y.notch_depth: expected a number from 0 to 1, found 1.1"),
    ("low_pass_frequency_hz = 100", "axis.y.low_pass_damping_ratio: expected this key, as low_pass_freq"),
    (
        "low_pass_frequency_hz = 3\nlow_pass_damping_ratio = 0.7",
        "line 6: axis.y.low_pass_frequency_hz: expected a number from 4 to 1800, found 3",
    ),
    (
        "low_pass_frequency_hz = 300\nlow_pass_damping_ratio = 11",
        "line 7: axis.y.low_pass_damping_ratio: expected a number from 0.05 to 10, found 11",
    ),
    ("travel_mm = [1, 1]", "line 6: axis.y.travel_mm[1]: expected a number above the first, found 1"),
    ("travel_mm = [-1e6, 1]", "axis.y.travel_mm[0]: expected a travel within 100000 mm of zero, found -1e6"),
    ("travel_mm = [1]", "axis.y.travel_mm: expected an array of length 2, found an array of 1"),
    ("travel_mm = 5", "axis.y.travel_mm: expected"),
    ("stop_deceleration_m_per_s2 = 0", "stop_deceleration_m_per_s2: expected a number above 0, found 0"),
    ("saturation_time_s = -1", "axis.y.saturation_time_s: expected a number above 0, found -1"),
    ("scale_disagreement_limit_mm = -1", "scale_disagreement_limit_mm: expected a number from 0 to 100000"),
    ("fastest_mm_per_s = 0", "axis.y.fastest_mm_per_s: expected a number above 0, found 0"),
    (
        "frozen_encoder_limit_mm = 500",
        "axis.y.frozen_encoder_limit_mm: expected no more than following_error_limit_mm, ",
    ),
    ("frozen_encoder_limit_mm = 0", "axis.y.frozen_encoder_limit_mm: expected a number above 0, found 0"),
];

#[test]
fn bad_filters_and_limits_are_refused_with_line_key_and_expectation() {
    for (loops, wanted) in BAD_LOOPS {
        let said = Machine::parse(&with(&format!("{loops}\n")), "m.toml").expect_err(wanted).to_string();
        assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nwanted {wanted}");
        assert!(!said.contains('\n'), "{said}");
    }
    // Without the controller they would be left out without a word.
    for line in LOOPS.lines() {
        let text = format!("{MACHINE}{line}\n");
        let said = Machine::parse(&text, "m.toml").expect_err(line).to_string();
        let key = line.split(' ').next().unwrap();
        assert!(said.contains(&format!("axis.x.controller: expected this key, as {key} is given")), "{said}");
    }
}

/// What is said of the machine above after one change, which has to change something.
fn said(from: &str, to: &str) -> String {
    let text = MACHINE.replacen(from, to, 1);
    assert_ne!(text, MACHINE);
    Machine::parse(&text, "m.toml").err().unwrap_or_else(|| panic!("accepted:\n{text}")).to_string()
}

#[test]
fn a_machine_reads_with_its_axes_in_the_order_of_the_file() {
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    assert_eq!(machine.axis.keys().collect::<Vec<_>>(), ["y", "x"]);
    let (y, x) = (&machine.axis["y"], &machine.axis["x"]);
    assert_eq!(y.settings.mechanics.lead_mm, Some(16.0));
    let [of_y, of_x] = [&y.settings, &x.settings];
    assert_eq!((of_y.controller.law, of_y.sensors.feedback), (Some(Law::Hpc), Feedback::Dual));
    assert_eq!(y.effect.iter().map(Effect::name).collect::<Vec<_>>(), ["backlash", "crosstalk", "latency"]);
    assert!(of_y.has_controller() && of_y.has_mass() && !of_y.is_rigid());
    assert!(!of_x.has_controller() && !of_x.has_mass() && of_x.is_rigid());
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
fn a_machine_written_reads_as_itself() {
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    let text = machine.to_toml();
    assert_eq!(Machine::parse(&text, "again.toml").unwrap(), machine, "{text}");
    let lines: Vec<&str> = text.lines().collect();
    let place = |line: &str| lines.iter().position(|l| *l == line).unwrap_or_else(|| panic!("{text}"));
    assert!(place("[axis.y]") < place("controller = \"hpc\""), "{text}");
    assert!(place("controller = \"hpc\"") < place("[[axis.y.effect]]"), "{text}");
    assert!(place("[[axis.y.effect]]") < place("[axis.x]"), "{text}");
}

/// Every effect of the catalogue survives being written and read, tag and strict keys together.
#[test]
fn every_effect_written_reads_as_itself() {
    let mut machine = Machine::parse(MACHINE, "m.toml").unwrap();
    // Where it is declared it is not looked for.
    let mechanics = &mut machine.axis["y"].settings.mechanics;
    mechanics.presliding_stiffness_n_per_um = None;
    mechanics.presliding_damping_n_s_per_m = None;
    let axis = machine.axis["y"].settings.clone();
    let stages = {
        use crate::effects::Stage::{Force, Motor, Table, Tool};
        [Motor, Table, Tool, Force]
    };
    let others = ["x".to_owned()];
    let around = crate::effects::EffectContext {
        axis: &axis,
        first: true,
        others: &others,
        stages: &stages,
        travel_mm: [0.0, 100.0],
    };
    let force = crate::effects::EffectContext { stages: &stages[3..], ..around };
    let all = [crate::effects::initial_guesses(&around), crate::effects::initial_guesses(&force)].concat();
    let names: Vec<&str> = all.iter().map(Effect::name).collect();
    assert!(crate::effects::names().iter().all(|name| names.contains(name)));
    for effect in all {
        machine.axis["y"].effect = vec![effect];
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    }
}

/// Change to the machine above, and what has to be said of it.
const BAD_MACHINES: &[(&str, &str, &str)] = &[
    ("1000", "0", "line 2: sample_rate_hz: expected a rate above 0 and up to 1000000, found 0"),
    ("1000", "\"fast\"", "line 2: sample_rate_hz: expected a number, found \"fast\""),
    ("4000.0", "-1", "line 3: velocity_loop_rate_hz: expected a rate above 0"),
    (
        "4000.0",
        "4100.0",
        "line 3: velocity_loop_rate_hz: expected sample_rate_hz (1000) times 1 to 1000, a whole \
             number, found 4100.0",
    ),
    ("4000.0", "500.0", "line 3: velocity_loop_rate_hz: expected sample_rate_hz (1000) times"),
    ("name = \"m\"", "", "m.toml: name: expected this key, found none"),
    ("sample_rate_hz = 1000\n", "", "m.toml: sample_rate_hz: expected this key, found none"),
    ("name =", "colour =", "line 1: colour: unknown key, expected one of name"),
    (
        "motor_mass_kg =",
        "motr_mass_kg =",
        "line 12: axis.y.motr_mass_kg: unknown key, expected one of controller",
    ),
    (
        "mass_kg = 90.0",
        "mass_kg = -3",
        "line 12: axis.y.motor_mass_kg: expected a number not below 0, found -3",
    ),
    ("120.0", "nan", "line 13: axis.y.table_mass_kg: expected a finite number, found nan"),
    (
        "120.0",
        "0",
        "line 13: axis.y.table_mass_kg: expected a mass above 0, as stiffness_n_per_um is given, found 0",
    ),
    (
        "table_mass_kg = 120.0\n",
        "",
        "line 5: axis.y.table_mass_kg: expected a mass above 0, as stiffness_n_per_um is given, found none",
    ),
    (
        "per_s = 40.0",
        "per_s = 0.0",
        "line 7: axis.y.position_gain_per_s: expected a number above 0, found 0.0",
    ),
    ("5e4", "0", "line 9: axis.y.velocity_gain_n_s_per_m: expected a number above 0, found 0"),
    ("\"hpc\"", "\"pid\"", "line 6: axis.y.controller: expected p or hpc, found \"pid\""),
    (
        "controller = \"hpc\"\n",
        "",
        "line 5: axis.y.controller: expected this key, as position_gain_per_s is given, found none",
    ),
    (
        "velocity_gain_n_s_per_m = 5e4\n",
        "",
        "line 5: axis.y.velocity_gain_n_s_per_m: expected this key, as controller is given",
    ),
    ("60.0", "200.1", "line 8: axis.y.feedforward_percent: expected a number from 0 to 200, found 200.1"),
    (
        "percent = 10.0",
        "percent = 101",
        "axis.y.plant_tolerance_percent: expected a number from 0 to 100, found 101",
    ),
    (
        "dual_feedback_time_constant_s = 0.08\n",
        "",
        "axis.y.dual_feedback_time_constant_s: expected this key, as feedback is \"dual\"",
    ),
    ("\"dual\"", "\"both\"", "line 24: axis.y.feedback: expected one of motor, table, dual, found \"both\""),
    (
        "presliding_stiffness_n_per_um = 40.0\n",
        "",
        "axis.y.presliding_stiffness_n_per_um: expected this key, as presliding_damping_n_s_per_m is given",
    ),
    (
        "coulomb_n = 150.0\n",
        "",
        "axis.y.coulomb_n: expected a friction above 0, as presliding_stiffness_n_per_um is given",
    ),
    (
        "pairs = 5",
        "pairs = 2.5",
        "line 23: axis.y.resolver_pole_pairs: expected a whole number not below 0, found 2.5",
    ),
    ("pairs = 5", "pairs = 0", "line 23: axis.y.resolver_pole_pairs: expected a number above 0, found 0"),
    ("pairs = 5", "pairs = -1", "line 23: axis.y.resolver_pole_pairs: expected"),
    ("[axis.x]", "[axis.\"x 1\"]", "line 41: axis.x 1: expected a name that starts with a letter"),
    ("[axis.x]", "axis = 3", "m.toml: line 4"),
    ("[axis.x]", "[axis.x]\neffect = 3", "line 42: axis.x.effect: expected an array, found 3"),
    ("[axis.x]", "[axis.x.effect]\nname = \"backlash\"", "axis.x.effect: expected an array, found a table"),
    ("[axis.x]", "[axis.x]\ncoulomb_nm = 3", "line 42: axis.x.coulomb_nm: unknown key"),
    ("[axis.y]", "[axis.y", "line 5: expected valid TOML"),
    ("force_limit_n", "lead_mm", "line 22: expected valid TOML: duplicate key"),
];

#[test]
fn bad_machines_are_refused_with_line_key_and_expectation() {
    for (from, to, wanted) in BAD_MACHINES {
        let said = said(from, to);
        assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nwanted {wanted}");
        assert!(!said.contains('\n'), "{said}");
    }
}

/// The same for what stands in its effects.
const BAD_EFFECTS: &[(&str, &str, &str)] = &[
    (
        "\"backlash\"",
        "\"slop\"",
        "line 28: axis.y.effect[0].name: expected one of backlash, pitch_progressive, ",
    ),
    ("name = \"backlash\"\n", "", "line 27: axis.y.effect[0].name: expected this key, found none"),
    ("width_um = 9.5", "", "line 27: axis.y.effect[0].width_um: expected this key, found none"),
    (
        "width_um = 9.5",
        "width_mm = 9.5",
        "line 29: axis.y.effect[0].width_mm: unknown key, expected width_um",
    ),
    ("width_um = 9.5", "width_um = 9.5\nlead = 1", "line 30: axis.y.effect[0].lead: unknown key"),
    ("9.5", "\"wide\"", "line 29: axis.y.effect[0].width_um: expected a number, found \"wide\""),
    ("9.5", "inf", "line 29: axis.y.effect[0].width_um: expected a finite number, found inf"),
    ("9.5", "-1", "line 29: axis.y.effect[0].width_um: expected a number not below 0, found -1"),
    (
        "\"x\"",
        "\"z\"",
        "line 34: axis.y.effect[1].source: expected the name of another axis (x), found \"z\"",
    ),
    (
        "\"x\"",
        "\"y\"",
        "line 34: axis.y.effect[1].source: expected the name of another axis (x), found \"y\"",
    ),
    ("\"x\"", "7", "line 34: axis.y.effect[1].source: expected a text in quotes, found 7"),
    ("\"table\"", "\"motor\"", "axis.y.effect[2]: expected one of table, tool, force"),
    ("[axis.x]", "[axis.x]\neffect = [1]", "line 42: axis.x.effect[0].name: expected this key"),
    (
        "[axis.x]",
        "[[axis.x.effect]]\nname = \"pitch_cyclic\"\namplitude_um = 1\nperiod_mm = 0",
        "line 44: axis.x.effect[0].period_mm: expected a number above 0, found 0",
    ),
    (
        "[axis.x]",
        "[[axis.x.effect]]\nname = \"servo_mismatch\"\npercent = -100",
        "line 43: axis.x.effect[0].percent: expected a number above -100, found -100",
    ),
];

#[test]
fn bad_effects_are_refused_with_line_key_and_expectation() {
    for (from, to, wanted) in BAD_EFFECTS {
        let said = said(from, to);
        assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nwanted {wanted}");
        assert!(!said.contains('\n'), "{said}");
    }
}

#[test]
fn files_that_are_no_machines_are_refused() {
    let cases = [
        ("", "name: expected this key"),
        ("time_s,x_command_mm\n0,1\n", "line 1: expected valid TOML"),
        ("name = \"m\"\nsample_rate_hz = 1", "axis: expected this key, found none"),
        ("name = \"m\"\nsample_rate_hz = 1\n[axis]", "line 3: axis: expected at least one table"),
    ];
    for (text, wanted) in cases {
        let said = Machine::parse(text, "m.toml").unwrap_err().to_string();
        assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nwanted {wanted}");
        assert!(!said.contains('\n'), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let said = |path: &Path| Machine::read(path).unwrap_err().to_string();
    assert!(said(folder.path()).contains(": expected a readable file: "));
    assert!(said(&folder.path().join("no.toml")).contains("no.toml: expected a readable file: "));
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"name = 1\n\xff").unwrap();
    assert!(said(&binary).contains("line 2: expected UTF-8 text, found byte 0xFF"));
}

/// Whatever one slip of the finger makes of a machine file, it is read or refused in one line.
#[test]
fn no_slip_breaks_the_reader() {
    for at in 0..MACHINE.len() {
        for slip in ["", "\"", "[", "]", ".", "\n", "-", "9", "e", " ", "=", "ä"] {
            let text = format!("{}{slip}{}", &MACHINE[..at], &MACHINE[at + 1..]);
            if let Err(error) = Machine::parse(&text, "m.toml") {
                assert!(!error.to_string().contains('\n'));
            }
        }
    }
}

/// What a trace writes behind the keys of axis y, in front of its effects.
const FITTED: &str = "
[axis.y.nominal]
stiffness_n_per_um = 160.0
coulomb_n = 150.0
damping_n_s_per_m = 8000.0

[[axis.y.nominal.effect]]
name = \"backlash\"
width_um = 9.0

[axis.y.log_offsets]
table_zero_um = -3.5
tool_late_ms = 0.05
drive_late_ms = -0.02
";

fn fitted(change: [&str; 2]) -> String {
    let (before, effects) = MACHINE.split_once("[[axis.y.effect]]").unwrap();
    let text = format!("{before}{FITTED}\n[[axis.y.effect]]{effects}");
    assert!(text.contains(change[0]), "{change:?}");
    text.replacen(change[0], change[1], 1)
}

#[test]
fn fitted_values_keep_their_nominal_ones_and_the_offsets_of_their_logs() {
    let machine = Machine::parse(&fitted(["", ""]), "m.toml").unwrap();
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    let axis = &machine.axis["y"];
    let nominal = axis.at_nominal();
    // Of the declared stiffness of 150 the nominal one is 160; what has none is its own.
    let [fitted, before] = [axis, &nominal].map(|axis| &axis.settings.mechanics);
    assert_eq!((fitted.stiffness_n_per_um, before.stiffness_n_per_um), (Some(150.0), Some(160.0)));
    assert_eq!((before.motor_mass_kg, before.coulomb_n), (fitted.motor_mass_kg, Some(150.0)));
    assert_eq!(nominal.effect[0].parameters(), [("width_um", 9.0)]);
    assert_eq!(nominal.effect[1..], axis.effect[1..]);
    assert_eq!(nominal.at_nominal(), nominal);
    let offsets = axis.log_offsets.as_ref().unwrap();
    assert_eq!(offsets.zeros_um().map(|(_, um)| um), [Some(-3.5), None]);
    assert_eq!(offsets.instants_ms()[1], ("tool_late_ms", Some(0.05)));
}

#[test]
fn nominal_values_and_offsets_that_do_not_belong_to_the_axis_are_refused() {
    let refused = |change: [&str; 2]| Machine::parse(&fitted(change), "m.toml").unwrap_err().to_string();
    // 10 % of 166 are 16.6: 150 lies 16 below, and just within; of 167, 17 below 16.7.
    assert!(Machine::parse(&fitted(["per_um = 160.0", "per_um = 166.0"]), "m.toml").is_ok());
    let cases = [
        (
            ["per_um = 160.0", "per_um = 167.0"],
            "axis.y.stiffness_n_per_um: expected a value within plant_tolerance_percent (10) of \
             nominal.stiffness_n_per_um (167), found 150.0",
        ),
        (
            ["coulomb_n = 150.0\ndamping_n", "coulomb_n = -1.0\ndamping_n"],
            "axis.y.nominal.coulomb_n: expected a number not below 0, found -1.0",
        ),
        (
            ["damping_n_s_per_m = 8000.0\n", ""],
            "axis.y.nominal.damping_n_s_per_m: expected no such key, as damping_n_s_per_m is not given, found 8000.0",
        ),
        (
            ["name = \"backlash\"\nwidth_um = 9.0", "name = \"windup\"\nstiffness_n_per_um = 9.0"],
            "axis.y.nominal.effect[0].name: expected the effect that the axis has in this place (backlash), found \"windup\"",
        ),
        (
            ["width_um = 9.0", "width_um = -9.0"],
            "axis.y.nominal.effect[0].width_um: expected a number not below 0, found -9.0",
        ),
        (["width_um = 9.0", "width_mm = 9.0"], "axis.y.nominal.effect[0].width_mm: unknown key"),
        (
            ["tool_late_ms = 0.05", "tool_late_ms = 1.5"],
            "axis.y.log_offsets.tool_late_ms: expected a number within ±1, found 1.5",
        ),
        (
            ["table_zero_um = -3.5", "table_zero_um = -2e6"],
            "axis.y.log_offsets.table_zero_um: expected a number within ±1000000, found -2e6",
        ),
        (["table_zero_um", "motor_zero_um"], "axis.y.log_offsets.motor_zero_um: unknown key"),
    ];
    for (change, wanted) in cases {
        let said = refused(change);
        assert!(said.contains(wanted) && !said.contains('\n'), "{said}\n{wanted}");
    }
}
