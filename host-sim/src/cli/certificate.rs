//! What the page of a trace tells of its circumstances: serial number, operator, date and command line.

use std::ffi::OsString;
use std::path::Path;
use std::str::FromStr;

use jiff::Zoned;
use jiff::civil::Date;
use report::certificate::Circumstances;

/// Arguments for the page.
#[derive(clap::Args)]
#[command(next_help_heading = "On the page")]
pub struct CertificateArguments {
    /// Serial number of the machine.
    #[arg(long, value_name = "TEXT", requires = "report")]
    serial: Option<String>,
    /// Who traces it.
    #[arg(long, value_name = "TEXT", requires = "report")]
    operator: Option<String>,
    /// Date, as 2026-11-27, or `today`. Without it the page has none, so that the same logs give the same bytes.
    #[arg(long, requires = "report")]
    date: Option<DateOf>,
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
    /// What the page tells. `paths` are the files of the command line, which stand there without their folders.
    pub fn circumstances(&self, paths: &[&Path]) -> Circumstances {
        let date = self.date.map(|date| match date {
            DateOf::Day(date) => date,
            DateOf::Today => Zoned::now().date(),
        });
        Circumstances {
            serial: self.serial.clone(),
            operator: self.operator.clone(),
            date: date.map(|date| date.to_string()),
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
