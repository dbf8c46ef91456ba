//! The help: verbs by what one wants to do, and examples.

use std::fmt::Write;

use clap::Command;

/// Verbs by what one wants to do.
const GROUPS: [(&str, &[&str]); 5] = [
    ("Look at a log", &["trace", "circle", "positions", "budget", "history", "init", "import", "app"]),
    ("Make it better", &["compensate", "verify", "tune", "margins", "simulate", "improve"]),
    ("A servo board", &["record", "board"]),
    ("Papers and tests", &["demo", "compare", "reproduce", "sensors", "self-test"]),
    ("The program itself", &["completions", "man", "help"]),
];

/// Below the help of the program.
const PROGRAM: &str = "Examples:
  lost-motion demo                                          a simulated machine, with nothing to prepare
  lost-motion circle circle.csv --report report             what a circle is made of
  lost-motion init --log circle.csv --out M.toml            a machine file from a log
  lost-motion trace --machine M.toml --fit circle.csv --model better.toml --report report
  lost-motion budget --model better.toml                    what each cause costs at the tool
  lost-motion compensate --model better.toml --out C.toml   what the controller can take away

Exit codes: 0 done; 1 the job failed, or a check of it; 2 arguments or input that cannot be used; 130 interrupted.";

/// Below the help of `trace`.
pub const TRACE: &str = "Examples:
  lost-motion trace --machine M.toml --fit circle.csv --fit travel.csv --validate corner.csv --model better.toml
  lost-motion trace --machine M.toml --fit circle.csv --report report --serial 4711 --operator \"A. Smith\" --date today
  lost-motion trace --machine M.toml --fit circle.csv --limit G=8 --limit corner=15 --check
  lost-motion trace --machine M.toml --fit scope.csv --map \"x_command_mm=X cmd\" --rate 1000";

/// Below the help of `circle`.
pub const CIRCLE: &str = "Examples:
  lost-motion circle circle.csv --report report
  lost-motion circle cw.csv ccw.csv --json circle.json
  lost-motion circle ballbar.csv --radius 100 --feed 1000";

/// Below the help of `budget`.
pub const BUDGET: &str = "Examples:
  lost-motion budget --model better.toml
  lost-motion budget --model better.toml --motion pocket.toml --report report";

/// Below the help of `history`.
pub const HISTORY: &str = "Examples:
  lost-motion trace --machine M.toml --fit circle.csv --date 2026-11-27 --json traces/2026-11-27.json
  lost-motion history traces --report report
  lost-motion history traces --limit x.backlash.width_um=8 --check";

/// Below the help of `init`.
pub const INIT: &str = "Examples:
  lost-motion init --log circle.csv --log travel.csv --out M.toml
  lost-motion init --log circle.csv --set x.lead_mm=10 --out M.toml";

/// Below the help of `compensate`.
pub const COMPENSATE: &str = "Examples:
  lost-motion compensate --model better.toml --out C.toml
  lost-motion compensate --model better.toml --out C.toml --format linuxcnc --out-dir hal";

/// Below the help of `verify`.
pub const VERIFY: &str = "Examples:
  lost-motion verify --machine M.toml --before circle.csv --after again.csv
  lost-motion verify --machine M.toml --before circle.csv --after again.csv --predicted C.toml --limit G=8 --check";

/// The command with its verbs in groups.
pub fn grouped(command: Command) -> Command {
    let styles = command.get_styles().clone();
    let (header, literal) = (styles.get_header(), styles.get_literal());
    let width = command.get_subcommands().map(|verb| verb.get_name().len()).max().unwrap_or(0);
    let mut groups = String::new();
    for (title, verbs) in GROUPS {
        // Writing into a text does not fail.
        let _ = writeln!(groups, "{header}{title}:{header:#}");
        for name in verbs {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            let about =
                about.map_or_else(|| "Show this help, or that of a verb".to_owned(), ToString::to_string);
            let _ = writeln!(groups, "  {literal}{name:<width$}{literal:#}  {about}");
        }
        groups.push('\n');
    }
    command.after_help(PROGRAM).help_template(format!(
        "{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{groups}{header}Options:{header:#}\n{{options}}{{after-help}}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_verb_is_in_one_group() {
        let command = crate::cli::command();
        let mut verbs: Vec<&str> = command.get_subcommands().map(Command::get_name).collect();
        verbs.push("help");
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, verbs)| verbs.iter().copied()).collect();
        verbs.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(grouped, verbs);
    }
}
