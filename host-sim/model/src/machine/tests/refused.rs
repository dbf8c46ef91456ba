//! Tests of refused machines and effects: line, key and expectation in the error message.

use super::*;

/// Asserts that each replacement in [`MACHINE`] gives the expected error, in one line.
fn assert_refused(replacements: &[(&str, &str, &str)]) {
    for (from, to, wanted) in replacements {
        let message = error_after(from, to);
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
}

/// Text to be replaced in [`MACHINE`], its replacement, and the expected error.
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
        "line 12: axis.y.motr_mass_kg: unknown key, expected one of drive, controller",
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
        "drive = \"velocity\"\n",
        "line 9: axis.y.velocity_gain_n_s_per_m: expected no such key, as drive is \"velocity\", found 5e4",
    ),
    (
        "controller = \"hpc\"\n",
        "drive = \"stepper\"\n",
        "line 7: axis.y.position_gain_per_s: expected no such key, as drive is \"stepper\", found 40.0",
    ),
    (
        "lead_mm = 16",
        "lead_mm = 16\nfull_steps_per_turn = 400",
        "axis.y.full_steps_per_turn: expected no such key, as drive is \"torque\", found 400",
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
        "axis.y.dual_feedback_time_constant_s: expected a value beside feedback = \"dual\"",
    ),
    ("\"dual\"", "\"both\"", "line 24: axis.y.feedback: expected one of motor, table, dual, found \"both\""),
    (
        "presliding_stiffness_n_per_um = 40.0\n",
        "",
        "axis.y.presliding_stiffness_n_per_um: expected a value beside presliding_damping_n_s_per_m",
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
    ("[axis.x]", "[axis.x]\ncoulomb_newton = 3", "line 42: axis.x.coulomb_newton: unknown key"),
    ("[axis.y]", "[axis.y", "line 5: expected valid TOML"),
    ("force_limit_n", "lead_mm", "line 22: expected valid TOML: duplicate key"),
];

#[test]
fn bad_machines_are_refused_with_line_key_and_expectation() {
    assert_refused(BAD_MACHINES);
}

/// Keys, values and messages of refused effects of the machine.
const BAD_EFFECTS: &[(&str, &str, &str)] = &[
    ("\"backlash\"", "\"slop\"", "line 28: axis.y.effect[0].name: expected one of backlash, lost_motion, "),
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
    ("\"table\"", "\"motor\"", "axis.y.effect[2].channel: expected one of table, tool, force"),
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
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"pitch_map\"\npositions_mm = [0, 50, 50]\nerror_um = [1, 2, 3]\n[axis.x]",
        "line 43: axis.y.effect[3].positions_mm: expected positions that increase, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"pitch_map\"\npositions_mm = [0, 50]\nerror_um = [1, 2, 3]\n[axis.x]",
        "line 44: axis.y.effect[3].error_um: expected as many numbers as positions_mm, 2, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"pitch_map\"\npositions_mm = [0, 50]\nerror_um = [1, 2]\nerror_negative_um = [1]\n[axis.x]",
        "line 45: axis.y.effect[3].error_negative_um: expected as many numbers as positions_mm, 2, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"friction_map\"\npositions_mm = [0]\nfriction_n = [1]\n[axis.x]",
        "line 43: axis.y.effect[3].positions_mm: expected at least two positions, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"friction_map\"\npositions_mm = [0, 50]\nfriction_n = [1, \"a\"]\n[axis.x]",
        "line 44: axis.y.effect[3].friction_n: expected a list of numbers, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"friction_map\"\npositions_mm = [0, 50]\nfriction_n = 3\n[axis.x]",
        "line 44: axis.y.effect[3].friction_n: expected a list of numbers, found 3",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"friction_map\"\npositions_mm = [0, 50]\nfriction_n = [1, 2e13]\n[axis.x]",
        "line 44: axis.y.effect[3].friction_n[1]: expected a number within ±1e12",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"constant_load\"\nforce_n = [3]\n[axis.x]",
        "line 43: axis.y.effect[3].force_n: expected a number, found an array",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"feedforward_mismatch\"\npercent = -101\n[axis.x]",
        "line 43: axis.y.effect[3].percent: expected a number that makes Kf 0 to 200 %",
    ),
    (
        "[axis.x]",
        "[[axis.y.effect]]\nname = \"drive_lag\"\nms = 11\n[axis.x]",
        "line 43: axis.y.effect[3].ms: expected a number from 0 to 10, found 11",
    ),
];

#[test]
fn bad_effects_are_refused_with_line_key_and_expectation() {
    assert_refused(BAD_EFFECTS);
}
