use super::*;
use model::examples;

const FILE: &str = "\
machine = 'demo'

[axis.x.controller]
position_gain_per_s = 50.0

[axis.x.compensation]
backlash_width_m = 12e-6
squareness = [1, 20e-6]
screw = [{ period_m = 0.01, values = [1e-6, -1e-6] }]

[axis.x.compensation.pitch]
of = 'Screw'
forward = { start_m = 0.0, spacing_m = 0.01, values = [0.0, 1e-6] }

[axis.x.compensation.force]
table_mass_kg = 150.0
friction = { coulomb_n = 120.0, stribeck = { excess_n = 10.0, velocity_m_per_s = 0.01 } }

[[predicted]]
motion = 'circle'
before_um = 8.0
after_um = 0.5
bound_percent = 15.0
";

fn parse(text: &str) -> Result<CompensationFile, InputError> {
    CompensationFile::parse(text, "c.toml", &Machine::parse(examples::DEMO_MACHINE, "demo.toml").unwrap())
}

#[test]
fn a_file_is_read_as_it_is_written() {
    let file = parse(FILE).unwrap();
    let x = &file.axis["x"].compensation;
    assert_eq!((x.backlash_width_m, x.squareness), (Some(12e-6), Some((1, 20e-6))));
    assert_eq!(x.position_bound_m.to_bits(), CompensationSettings::default().position_bound_m.to_bits());
    assert_eq!(parse(&file.to_toml().unwrap()).unwrap(), file);
}

/// What is replaced in [`FILE`], by what, and the start of the refusal: line, key, and the value that was found.
const REFUSED: &[[&str; 3]] = &[
    [
        "machine = 'demo'",
        "machine = 'other'",
        "line 1: machine: expected a compensation of machine demo, found 'other'",
    ],
    ["machine = 'demo'", "", "machine: expected this key, found none"],
    [
        "[axis.x.controller]",
        "[axis.z.controller]",
        "line 3: axis.z: unknown axis, expected an axis of the machine (x, y)",
    ],
    [
        "[axis.x.controller]\nposition_gain_per_s = 50.0",
        "[axis.x]\ncontroller = 5",
        "line 4: axis.x.controller: expected a table, found 5",
    ],
    [
        "gain_per_s = 50.0",
        "gain_per_s = -50.0",
        "line 4: axis.x.controller.position_gain_per_s: expected a number above 0, found -50.0",
    ],
    [
        "backlash_width_m = 12e-6",
        "backlash_um = 12.0",
        "line 7: axis.x.compensation.backlash_um: unknown key, expected one of ",
    ],
    [
        "backlash_width_m = 12e-6",
        "backlash_width_m = 'wide'",
        "line 7: axis.x.compensation.backlash_width_m: expected a number, found 'wide'",
    ],
    [
        "backlash_width_m = 12e-6",
        "backlash_width_m = 0.1",
        "line 7: axis.x.compensation.backlash_width_m: expected a number from 0 to 0.002, found 0.1",
    ],
    [
        "squareness = [1,",
        "squareness = [0,",
        "line 8: axis.x.compensation.squareness[0]: expected the number of another axis, of 2 counted from 0, found 0",
    ],
    [
        "squareness = [1, 20e-6]",
        "squareness = 20e-6",
        "line 8: axis.x.compensation.squareness: expected an array of 2, found 20e-6",
    ],
    [
        "squareness = [1, 20e-6]",
        "squareness = [1, -0.2]",
        "line 8: axis.x.compensation.squareness[1]: expected a number from -0.125 to 0.125, found -0.2",
    ],
    [
        "period_m = 0.01",
        "period_m = 0.0",
        "line 9: axis.x.compensation.screw[0].period_m: expected a number from 1.000e-7 to 100, found 0.0",
    ],
    [
        "values = [1e-6, -1e-6]",
        "values = [1e-6]",
        "line 9: axis.x.compensation.screw[0].values: expected 2 to 64 values, found an array of 1",
    ],
    ["'Screw'", "'Nut'", "line 12: axis.x.compensation.pitch.of: "],
    [
        "spacing_m = 0.01",
        "spacing_m = -0.01",
        "line 13: axis.x.compensation.pitch.forward.spacing_m: expected a number from 1.100e-6 to 100, found -0.01",
    ],
    [
        "values = [0.0, 1e-6]",
        "values = [0.0, 2e-3]",
        "line 13: axis.x.compensation.pitch.forward.values: expected a number from -0.001 to 0.001, found an array of 2",
    ],
    [
        "table_mass_kg = 150.0",
        "share = 1.5",
        "line 16: axis.x.compensation.force.share: expected a number from 0 to 1, found 1.5",
    ],
    [
        "excess_n = 10.0",
        "excess_n = -130.0",
        "line 17: axis.x.compensation.force.friction.stribeck.excess_n: expected a number from -120 to 1000, found -130.0",
    ],
    [
        "after_um = 0.5",
        "after_um = -0.5",
        "line 22: predicted[0].after_um: expected a number of at least 0, found -0.5",
    ],
    [
        "bound_percent = 15.0",
        "bound_percent = 101.0",
        "line 23: predicted[0].bound_percent: expected a number from 0 to 100, found 101.0",
    ],
    ["bound_percent = 15.0", "", "line 19: predicted[0].bound_percent: expected this key, found none"],
];

/// Every refusal has the line and the key, and the value that was found.
#[test]
fn what_is_not_possible_is_refused_with_line_key_and_value() {
    for [old, new, wanted] in REFUSED {
        assert!(FILE.contains(old), "{old}");
        let message = parse(&FILE.replacen(old, new, 1)).unwrap_err().to_string();
        let found = message.strip_prefix("c.toml: ").unwrap();
        assert!(found.starts_with(wanted), "\n   {found}\nnot {wanted}");
    }
    let many = format!("values = [{}]", "0.0, ".repeat(65));
    let message = parse(&FILE.replacen("values = [0.0, 1e-6]", &many, 1)).unwrap_err().to_string();
    assert_eq!(
        message,
        "c.toml: line 13: axis.x.compensation.pitch.forward.values: expected an array of at most 64, found an array of 65"
    );
}

#[test]
fn a_mapped_travel_without_length_is_refused() {
    let with = |ends: &str| parse(&format!("machine = 'demo'\n\n[axis.x]\nmapped_mm = {ends}\n"));
    assert_eq!(with("[-42.0, 42.0]").unwrap().axis["x"].mapped_mm, Some([-42.0, 42.0]));
    for ends in ["[42.0, -42.0]", "[1.0, 1.0]"] {
        let message = with(ends).unwrap_err().to_string();
        let expected =
            "c.toml: line 4: axis.x.mapped_mm: expected two positions, the second above the first, found";
        assert!(message.starts_with(expected), "{message}");
    }
    let message = with("[nan, 1.0]").unwrap_err().to_string();
    assert!(
        message.starts_with("c.toml: line 4: axis.x.mapped_mm[0]: expected a finite number"),
        "{message}"
    );
}
