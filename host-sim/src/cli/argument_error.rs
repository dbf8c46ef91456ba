//! Arguments that the command line does not take: one line on stderr, as for every invalid input.

use clap::Parser;
use clap::error::{Error, ErrorKind};
use files::error::printable;

/// The arguments of the program, whose command is given. Ends it after `--help` or `--version` with 0, and after an error, or without a command, with 2.
#[must_use]
pub fn parse_or_exit<A: Parser>(command: clap::Command) -> A {
    // Otherwise, a negative number is an unknown flag, and not a value that is refused by its range.
    let command = command.mut_subcommands(with_negative_numbers);
    let parsed = command.try_get_matches().and_then(|mut matches| A::from_arg_matches_mut(&mut matches));
    parsed.unwrap_or_else(|error| {
        // Without any argument, the help is the answer.
        let is_help = error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand;
        if is_help || !error.use_stderr() {
            error.exit();
        }
        eprintln!("lost-motion: {}", in_one_line(&error));
        std::process::exit(2)
    })
}

fn with_negative_numbers(command: clap::Command) -> clap::Command {
    command.allow_negative_numbers(true).mut_subcommands(with_negative_numbers)
}

/// The first paragraph of the error and its tips, without the usage.
fn in_one_line(error: &Error) -> String {
    let text = error.render().to_string();
    let paragraphs = text.split("\n\n").filter(|paragraph| {
        let start = paragraph.trim_start();
        !start.is_empty() && !start.starts_with("Usage:") && !start.starts_with("For more information")
    });
    let lines = paragraphs.map(|paragraph| {
        let words: Vec<&str> = paragraph.split_whitespace().collect();
        words.join(" ")
    });
    let line = lines.collect::<Vec<_>>().join("; ");
    printable(&format!("{}; see --help", line.trim_start_matches("error: ")))
}
