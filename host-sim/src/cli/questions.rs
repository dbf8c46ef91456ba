//! What `init` asks on a terminal: values that no log shows.

use std::io::{BufRead, Write};

use ::init::known::Known;
use files::log::{Log, Unit};
use model::axis::Drive;
use model::machine::Machine;

/// Asks for the unknown values, axis by axis; an empty answer leaves a value unknown. A wrong one is asked again.
///
/// # Errors
/// If the terminal cannot be read or written.
pub fn ask(
    machine: &Machine,
    logs: &[Log],
    answers: &mut impl BufRead,
    terminal: &mut impl Write,
) -> std::io::Result<Vec<Known>> {
    let mut known = Vec::new();
    for (name, axis) in &machine.axis {
        let of_axis = || logs.iter().filter_map(|log| log.axis(name));
        let is_open = axis.settings.controller.drive == Drive::Torque && !axis.settings.has_mass();
        let has = |channel: fn(&files::log::AxisLog) -> bool| of_axis().any(channel);
        if is_open && has(|axis| axis.motor.is_some()) && !has(|axis| axis.force.is_some()) {
            known.extend(answer(machine, (name, "drive"), "velocity or stepper", answers, terminal)?);
        }
        if axis.settings.mechanics.lead_mm.is_none() {
            let is_rotary = of_axis().any(|axis| axis.unit == Unit::Degree);
            let (key, what) = if is_rotary {
                ("lead_deg", "angle of the axis per turn of the motor, degrees")
            } else {
                ("lead_mm", "travel per turn of the screw, mm")
            };
            known.extend(answer(machine, (name, key), what, answers, terminal)?);
        }
    }
    Ok(known)
}

/// Asks for one value until it is one of a machine file, or the answer is empty or at its end.
fn answer(
    machine: &Machine,
    (axis, key): (&str, &str),
    what: &str,
    answers: &mut impl BufRead,
    terminal: &mut impl Write,
) -> std::io::Result<Option<Known>> {
    loop {
        write!(terminal, "{axis}.{key}: {what} (Enter: unknown) ")?;
        terminal.flush()?;
        let mut line = String::new();
        if answers.read_line(&mut line)? == 0 || line.trim().is_empty() {
            return Ok(None);
        }
        let said = format!("{axis}.{key}={}", line.trim()).parse::<Known>().map_err(str::to_owned);
        let said = said.and_then(|said| {
            let machine = ::init::known::with(machine, std::slice::from_ref(&said), "answer");
            machine.map(|_| said).map_err(|error| error.to_string())
        });
        match said {
            Ok(said) => return Ok(Some(said)),
            Err(error) => writeln!(terminal, "{error}")?,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::AxisLog;

    fn asked(answers: &str, has_force: bool) -> (Vec<Known>, String) {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.motor = Some(vec![0.0; 3]);
        axis.force = has_force.then(|| vec![0.0; 3]);
        let log = Log::new("a.csv", 0.0, 1e-3, [axis]);
        let machine = ::init::unknown("m", std::slice::from_ref(&log)).unwrap();
        let mut terminal = Vec::new();
        let known = ask(&machine, &[log], &mut answers.as_bytes(), &mut terminal).unwrap();
        (known, String::from_utf8(terminal).unwrap())
    }

    #[test]
    fn what_no_log_shows_is_asked_until_it_is_a_value() {
        let (known, text) = asked("hydraulic\nstepper\n10\n", false);
        let expected = ["x.drive=stepper", "x.lead_mm=10"].map(|text| text.parse().unwrap());
        assert_eq!(known, expected);
        assert_eq!(text.matches("x.drive: velocity or stepper").count(), 2);
        // With a force the drive is known; Enter and the end of the answers leave a value unknown.
        assert_eq!(asked("\n", true).0, []);
        assert_eq!(asked("", false).0, []);
    }
}
