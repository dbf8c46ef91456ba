//! Circumstances of a trace: serial number, operator, date, temperature and command line, for its page and its JSON.

use std::ffi::OsString;
use std::path::Path;
use std::str::FromStr;

use budget::traced;
use jiff::Zoned;
use jiff::civil::Date;
use report::certificate::Circumstances;

/// Name of the group of outputs that have them.
pub const OUTPUTS: &str = "outputs_with_circumstances";

/// Arguments for the page and the JSON.
#[derive(clap::Args)]
#[command(next_help_heading = "In report and JSON")]
pub struct CertificateArguments {
    /// Serial number of the machine.
    #[arg(long, value_name = "TEXT", requires = OUTPUTS)]
    serial: Option<String>,
    /// Who traces it.
    #[arg(long, value_name = "TEXT", requires = OUTPUTS)]
    operator: Option<String>,
    /// Date, as 2026-11-27, or `today`. Without it the page has none, so that the same logs give the same bytes.
    #[arg(long, requires = OUTPUTS)]
    date: Option<DateOf>,
    /// Temperature of the machine while it was logged, °C: `history` tells what follows it from what changed.
    #[arg(long, value_name = "CELSIUS", requires = OUTPUTS, allow_negative_numbers = true, value_parser = temperature)]
    temperature_c: Option<f64>,
}

fn temperature(text: &str) -> Result<f64, String> {
    let celsius = text.parse().ok().filter(|celsius: &f64| (-60.0..=150.0).contains(celsius));
    celsius.ok_or_else(|| "expected a temperature from -60 to 150 °C".to_owned())
}

/// A date, or today's, which is asked of the clock only then.
#[derive(Clone, Copy, Debug)]
enum DateOf {
    Day(Date),
    Today,
}

impl FromStr for DateOf {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "today" => Ok(Self::Today),
            text => {
                text.parse().map(Self::Day).map_err(|_| "expected a date, as 2026-11-27, or today".to_owned())
            }
        }
    }
}

impl CertificateArguments {
    /// When and where the machine was traced, as far as it was given.
    pub fn traced(&self) -> traced::Circumstances {
        traced::Circumstances {
            serial: self.serial.clone(),
            operator: self.operator.clone(),
            date: self.day(),
            temperature_c: self.temperature_c,
        }
    }

    fn day(&self) -> Option<String> {
        let day = |date| match date {
            DateOf::Day(date) => date,
            DateOf::Today => Zoned::now().date(),
        };
        self.date.map(|date| day(date).to_string())
    }

    /// What the page tells. `paths` are the files of the command line, which stand there without their folders.
    pub fn circumstances(&self, paths: &[&Path]) -> Circumstances {
        Circumstances {
            traced: self.traced(),
            command_line: command_line(std::env::args_os().skip(1), paths),
        }
    }
}

/// The command line as it is typed in a shell; pages do not show the folders of their author.
fn command_line(arguments: impl Iterator<Item = OsString>, paths: &[&Path]) -> Option<String> {
    let name = |path: &str| {
        let known = paths.iter().find(|known| known.to_str() == Some(path))?;
        Some(known.file_name()?.to_string_lossy().into_owned())
    };
    let shown = |argument: OsString| {
        let argument = argument.to_string_lossy().into_owned();
        let of_flag = || {
            let (flag, path) = argument.split_once('=').filter(|(flag, _)| flag.starts_with("--"))?;
            Some(format!("{flag}={}", name(path)?))
        };
        name(&argument).or_else(of_flag).unwrap_or(argument)
    };
    let words: Vec<String> = std::iter::once("lost-motion".to_owned()).chain(arguments.map(shown)).collect();
    shlex::try_join(words.iter().map(String::as_str)).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_has_no_folders_and_can_be_typed() {
        let arguments = [
            "trace",
            "--fit=/home/me/a b.csv",
            "--machine",
            "../m.toml",
            "--unit",
            "x_motor_mm=mm/s",
            "--report",
            "out/",
        ];
        let paths = ["/home/me/a b.csv", "../m.toml", "out/"].map(Path::new);
        let shown = command_line(arguments.into_iter().map(OsString::from), &paths).unwrap();
        let words = shlex::split(&shown).unwrap();
        let expected = [
            "lost-motion",
            "trace",
            "--fit=a b.csv",
            "--machine",
            "m.toml",
            "--unit",
            "x_motor_mm=mm/s",
            "--report",
            "out",
        ];
        assert_eq!(words, expected);
    }
}
