//! What the user says of an axis: `x.lead_mm=10`, `y.drive=stepper`.

use std::str::FromStr;

use files::error::InputError;
use model::machine::Machine;
use toml::{Table, Value};

/// A key of an axis with its value, as in a machine file.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Name of the axis.
    pub axis: String,
    /// Key in its table.
    pub key: String,
    /// Its value: a number, or a text.
    pub value: Value,
}

impl FromStr for Known {
    type Err = &'static str;

    /// Reads `AXIS.KEY=VALUE`. A value that is no number is a text.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const EXPECTED: &str = "expected AXIS.KEY=VALUE, such as x.lead_mm=10";
        let (key, value) = text.split_once('=').ok_or(EXPECTED)?;
        let (axis, key) = key.trim().split_once('.').ok_or(EXPECTED)?;
        let value = value.trim();
        if axis.is_empty() || key.is_empty() || value.is_empty() {
            return Err(EXPECTED);
        }
        let number = value.parse::<i64>().map(Value::Integer).ok();
        let number = number.or_else(|| value.parse::<f64>().map(Value::Float).ok());
        Ok(Self {
            axis: axis.to_owned(),
            key: key.to_owned(),
            value: number.unwrap_or_else(|| Value::String(value.to_owned())),
        })
    }
}

/// A machine with values that the user says, in place of its own; `source` names them in messages.
///
/// # Errors
/// If an axis does not exist, or a key or value is none of a machine file.
pub fn with(machine: &Machine, known: &[Known], source: &str) -> Result<Machine, InputError> {
    if known.is_empty() {
        return Ok(machine.clone());
    }
    let mut document: Table = toml::from_str(&machine.to_toml())
        .map_err(|error| InputError::expected(source, "a machine that can be written", error.to_string()))?;
    for Known { axis, key, value } in known {
        let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
        let axes = document.get_mut("axis").and_then(Value::as_table_mut);
        let Some(table) = axes.and_then(|axes| axes.get_mut(axis)).and_then(Value::as_table_mut) else {
            let expected = format!("an axis of the logs ({})", names.join(", "));
            return Err(InputError::expected(source, &expected, files::error::quoted(axis)));
        };
        table.insert(key.clone(), value.clone());
    }
    let text = toml::to_string(&document)
        .map_err(|error| InputError::expected(source, "values of a machine file", error.to_string()))?;
    Machine::parse(&text, source)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: &str = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\nlead_mm = 5\n[axis.y]\n";

    #[test]
    fn values_are_set_as_in_a_machine_file() {
        let machine = Machine::parse(MACHINE, "m.toml").unwrap();
        let known = ["x.lead_mm=10", "y.drive=stepper", " y.lead_mm = 2.5"].map(|text| text.parse().unwrap());
        let said = with(&machine, &known, "--set").unwrap();
        let leads = ["x", "y"].map(|axis| said.axis[axis].settings.mechanics.lead_mm);
        assert_eq!(leads, [Some(10.0), Some(2.5)]);
        assert_eq!(said.axis["y"].settings.controller.drive, model::axis::Drive::Stepper);
    }

    #[test]
    fn what_is_no_value_of_an_axis_is_refused() {
        let machine = Machine::parse(MACHINE, "m.toml").unwrap();
        let refused = |text: &str| with(&machine, &[text.parse().unwrap()], "--set").unwrap_err().to_string();
        assert!(refused("z.lead_mm=10").contains("an axis of the logs (x, y)"));
        assert!(
            refused("x.lead_mm=-1").contains("axis.x.lead_mm: expected a number above 0"),
            "{}",
            refused("x.lead_mm=-1")
        );
        assert!(refused("x.led_mm=1").contains("led_mm"));
        for text in ["lead_mm=10", "x.lead_mm", "x.=1", "x.lead_mm="] {
            assert!(text.parse::<Known>().is_err(), "{text}");
        }
    }
}
