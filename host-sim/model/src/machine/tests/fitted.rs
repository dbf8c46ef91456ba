//! Tables that a trace adds to fitted values.

use super::*;

/// Tables that a trace writes after the keys of axis y, before its effects.
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
    // The nominal stiffness is 160; the motor mass has no nominal value.
    let [fitted, before] = [axis, &nominal].map(|axis| &axis.settings.mechanics);
    assert_eq!((fitted.stiffness_n_per_um, before.stiffness_n_per_um), (Some(150.0), Some(160.0)));
    assert_eq!((before.motor_mass_kg, before.coulomb_n), (fitted.motor_mass_kg, Some(150.0)));
    assert_eq!(nominal.effect[0].parameters(), [("width_um", 9.0)]);
    assert_eq!(nominal.effect[1..], axis.effect[1..]);
    assert_eq!(nominal.at_nominal(), nominal);
    let offsets = axis.log_offsets.unwrap();
    assert_eq!([offsets.table_zero_um, offsets.tool_zero_um], [Some(-3.5), None]);
    assert_eq!(offsets.all().nth(3), Some(("tool_late_ms", Some(0.05))));
}

#[test]
fn nominal_values_and_offsets_that_do_not_belong_to_the_axis_are_refused() {
    let error = |change: [&str; 2]| Machine::parse(&fitted(change), "m.toml").unwrap_err().to_string();
    // 187 − 20 % = 149.6, so that 150 is in the range; 190 − 20 % = 152, so that it would be a wind-up.
    assert!(Machine::parse(&fitted(["per_um = 160.0", "per_um = 187.0"]), "m.toml").is_ok());
    let cases = [
        (
            ["per_um = 160.0", "per_um = 190.0"],
            "axis.y.stiffness_n_per_um: expected a value that a fit may give, 152 to 266, from \
             nominal.stiffness_n_per_um (190) and its tolerance (10 %), found 150.0",
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
            "axis.y.nominal.effect[0].name: expected the effect of the axis at the same index (backlash), found \"windup\"",
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
        let message = error(change);
        assert!(message.contains(wanted) && !message.contains('\n'), "{message}\n{wanted}");
    }
}

/// A tolerance of its own takes the place of that of all mechanical values; a setting of the controller is exact without one.
#[test]
fn a_value_has_its_own_tolerance_or_that_of_all() {
    let text = MACHINE.replacen(
        "[[axis.y.effect]]",
        "[axis.y.tolerance_percent]\ncoulomb_n = 2.5\n\n[[axis.y.effect]]",
        1,
    );
    let machine = Machine::parse(&text, "m.toml").unwrap();
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    let settings = &machine.axis["y"].settings;
    let tolerances =
        ["coulomb_n", "stiffness_n_per_um", "position_gain_per_s"].map(|key| settings.tolerance(key));
    let differences = [tolerances[0] - 0.025, tolerances[1] - 0.1, tolerances[2]];
    assert!(differences.iter().all(|difference| difference.abs() < 1e-12), "{tolerances:?}");
    assert_eq!(settings.clone().without_tolerances().tolerance("coulomb_n").to_bits(), 0.0_f64.to_bits());
    let refused = |line: &str| {
        let text = MACHINE.replacen(
            "[[axis.y.effect]]",
            &format!("[axis.y.tolerance_percent]\n{line}\n\n[[axis.y.effect]]"),
            1,
        );
        Machine::parse(&text, "m.toml").unwrap_err().to_string()
    };
    assert!(
        refused("coulomb_n = 101")
            .contains("axis.y.tolerance_percent.coulomb_n: expected a number from 0 to 100, found 101")
    );
    // Axis x declares no value at all.
    let absent = MACHINE.replacen("[axis.x]", "[axis.x]\n[axis.x.tolerance_percent]\ncoulomb_n = 5.0", 1);
    assert_eq!(
        Machine::parse(&absent, "m.toml").unwrap_err().to_string().split(": ").skip(2).collect::<Vec<_>>(),
        ["axis.x.tolerance_percent.coulomb_n", "expected no such key, as coulomb_n is not given, found 5.0"]
    );
}
