//! Tests of the keys of a gantry.

use shared::config::GantrySettings;

use super::*;

/// Three axes with the same travel, to each of which keys can be added.
fn machine(keys: [&str; 3]) -> String {
    let axis = |(name, keys): (&str, &str)| {
        format!(
            "[axis.{name}]\n{keys}\ncontroller = \"p\"\nposition_gain_per_s = 25\nvelocity_gain_n_s_per_m = 3000\n\
             force_limit_n = 200\nmotor_mass_kg = 6\ntable_mass_kg = 9\nfeedback = \"motor\"\ntravel_mm = [-100, 100]\n"
        )
    };
    let axes: String = ["x", "y", "z"].into_iter().zip(keys).map(axis).collect();
    format!("name = \"gantry\"\nsample_rate_hz = 4000.0\nvelocity_loop_rate_hz = 20000.0\n{axes}")
}

fn read_machine(keys: [&str; 3]) -> Machine {
    Machine::parse(&machine(keys), "m.toml").unwrap()
}

const GANTRY: &str = "gantry_with = \"x\"\ngantry_skew_limit_mm = 0.3\ngantry_offset_mm = -1.5";

#[test]
fn a_gantry_is_converted_with_the_number_of_its_first_motor() {
    for (keys, first) in [
        ([GANTRY, "", ""].map(|keys| keys.replace("\"x\"", "\"y\"")), 1),
        (["", "", GANTRY].map(str::to_owned), 0),
    ] {
        let read = read_machine(keys.each_ref().map(String::as_str));
        assert_eq!(Machine::parse(&read.to_toml(), "again.toml").unwrap(), read);
        let second = keys.iter().position(|keys| !keys.is_empty()).unwrap();
        let gantry = |axis: usize| crate::servo::gantry(&read.axis[axis].settings, read.axis.keys());
        let expected = GantrySettings { first, skew_limit_m: 0.3e-3, reference_offset_m: -1.5e-3 };
        assert_eq!(gantry(second), Some(expected));
        assert_eq!(gantry(1), Some(expected).filter(|_| second == 1));
    }
    let read = read_machine(["", "", "gantry_with = \"x\"\ngantry_skew_limit_mm = 0.3"]);
    let gantry = crate::servo::gantry(&read.axis["z"].settings, read.axis.keys()).unwrap();
    assert!(gantry.reference_offset_m.abs() < 1e-15);
}

#[test]
fn bad_keys_of_a_gantry_are_refused_with_line_key_and_expectation() {
    let other = "axis.z.gantry_with: expected the name of another axis, which is a motor of no other gantry";
    for (keys, wanted) in [
        (["", "", "gantry_with = \"z\"\ngantry_skew_limit_mm = 0.3"], other),
        (["", "", "gantry_with = \"u\"\ngantry_skew_limit_mm = 0.3"], other),
        (["", GANTRY, "gantry_with = \"y\"\ngantry_skew_limit_mm = 0.3"], other),
        (["", GANTRY, GANTRY], "axis.y.gantry_with: expected the name of another axis"),
        (["", "", "gantry_with = 1"], "axis.z.gantry_with: expected"),
        (
            ["", "", "gantry_with = \"x\""],
            "axis.z.gantry_skew_limit_mm: expected a limit beside gantry_with, found none",
        ),
        (
            ["", "", "gantry_skew_limit_mm = 0.3"],
            "axis.z.gantry_with: expected the first motor, beside gantry_skew_limit_mm",
        ),
        (
            ["", "", "gantry_offset_mm = 0.3"],
            "axis.z.gantry_with: expected the first motor, beside gantry_offset_mm",
        ),
        (
            ["", "", "gantry_with = \"x\"\ngantry_skew_limit_mm = 10.5"],
            "axis.z.gantry_skew_limit_mm: expected a number from 0 to 10, found 10.5",
        ),
        (
            ["", "", "gantry_with = \"x\"\ngantry_skew_limit_mm = 0.3\ngantry_offset_mm = 100.5"],
            "axis.z.gantry_offset_mm: expected a number from -100 to 100, found 100.5",
        ),
        (
            ["fastest_mm_per_s = 100", "", GANTRY],
            "axis.z.fastest_mm_per_s: expected what x has, with which this axis is a gantry",
        ),
        (
            ["", "", "gantry_with = \"x\"\ngantry_skew_limit_mm = 0.3\nsmoothing_s = 0.01"],
            "axis.z.smoothing_s: expected what x has",
        ),
    ] {
        let message = Machine::parse(&machine(keys), "m.toml").expect_err(wanted).to_string();
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
    let other_travel =
        machine(["", "", GANTRY]).replacen("travel_mm = [-100, 100]", "travel_mm = [-100, 90]", 1);
    let message = Machine::parse(&other_travel, "m.toml").unwrap_err().to_string();
    assert!(message.contains("axis.z.travel_mm: expected what x has"), "{message}");
}
