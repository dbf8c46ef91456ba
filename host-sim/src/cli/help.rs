//! The help: verbs by what one wants to do, and examples.

use std::fmt::Write;

use clap::Command;

use super::examples;

/// Verbs by what one wants to do.
const GROUPS: [(&str, &[&str]); 5] = [
    (
        "Look at a log",
        &[
            "trace",
            "circle",
            "positions",
            "volume",
            "budget",
            "plan",
            "history",
            "resonances",
            "init",
            "import",
            "gcode",
            "app",
        ],
    ),
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
    let with_examples = |command: Command, (verb, lines): &(&'static str, &[&str])| {
        command.mut_subcommand(verb, |verb| verb.after_help(format!("Examples:\n  {}", lines.join("\n  "))))
    };
    let command = examples::ALL.iter().fold(command, with_examples);
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

    #[test]
    fn every_verb_has_examples_that_it_takes() {
        let command = crate::cli::command();
        for verb in command.get_subcommands() {
            let name = verb.get_name();
            let (_, lines) = examples::ALL.iter().find(|(of, _)| *of == name).unwrap();
            let own = lines.iter().filter(|line| line.starts_with(&format!("lost-motion {name} ")));
            assert!(own.count() >= 1, "{name}");
        }
        let of_verbs = examples::ALL.iter().flat_map(|(_, lines)| lines.iter().copied());
        let of_program = PROGRAM.lines().filter_map(|line| line.strip_prefix("  "));
        for line in of_verbs.chain(of_program) {
            // What a line does stands behind several spaces.
            let words = shlex::split(line.split("   ").next().unwrap()).unwrap();
            let outcome = command.clone().try_get_matches_from(words);
            assert!(outcome.is_ok(), "{line}: {}", outcome.unwrap_err());
        }
    }
}
