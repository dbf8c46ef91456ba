//! Laws of residuals in a machine file.

use super::*;
use crate::residual_law::Term;

const LAW: &str = r#"[[axis.y.law]]
channel = "tool"
[[axis.y.law.term]]
kind = "product"
of = ["position_mm", "other_speed"]
coefficient = 0.5
[axis.x]"#;

/// [`MACHINE`] with a law whose line of variables is another one.
fn with_line(line: &str) -> String {
    LAW.replace("of = [\"position_mm\", \"other_speed\"]", line)
}

#[test]
fn a_law_is_read_and_written() {
    let text = MACHINE.replacen("[axis.x]", &with_line("of = [\"position_mm\", \"other_direction\"]"), 1);
    let machine = Machine::parse(&text, "m.toml").unwrap();
    let [law] = &machine.axis["y"].residual_law[..] else { panic!("{:?}", machine.axis["y"]) };
    assert!(matches!(&law.term[..], [Term::Product { of, .. }] if of.len() == 2), "{law:?}");
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
}

#[test]
fn bad_laws_are_refused_with_key_and_expectation() {
    for (law, wanted) in [
        (
            with_line("of = [\"position_mm\", \"other_speed\"]"),
            "axis.y.law[0].term[0].of[1]: expected one of position_mm, ",
        ),
        (with_line("of = []"), "axis.y.law[0].term[0].of: expected 1 to 4 variables"),
        (
            with_line("of = [\"force_n\"]").replace("0.5", "nan"),
            "axis.y.law[0].term[0].coefficient: expected a finite number, found nan",
        ),
        (with_line("of = [\"force_n\"]\nperiod_mm = 3.0"), "period_mm"),
        (
            with_line("distance_mm = 0.0").replace("product", "hysteresis"),
            "axis.y.law[0].term[0].distance_mm: expected a length above 0",
        ),
        (
            with_line("over = \"position_mm\"\nperiod_mm = -2.0\ncosine = 1.0\nsine = 0.0")
                .replace("product", "wave")
                .replace("coefficient = 0.5\n", ""),
            "axis.y.law[0].term[0].period_mm: expected a length above 0",
        ),
    ] {
        let message = error_after("[axis.x]", &law);
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
}
