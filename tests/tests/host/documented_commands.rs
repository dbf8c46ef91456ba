//! Commands that documents show: the program has the verb and each flag. What a command prints is compared where a page shows it
//! (`command_line/worked_example.rs`, and `chip/servo_board/document.rs` for the board).

use std::collections::BTreeMap;
use std::fs;
use std::process::Command;

use super::documents::documents;

/// How documents call the program.
const CALLS: [&str; 3] = ["lost-motion ", "cargo run --release -- ", "target/release/lost-motion "];

/// Commands of the program, each with the page that shows it, without its call.
fn shown() -> Vec<(String, String)> {
    let mut shown = Vec::new();
    let overview = help("");
    let is_verb = |line: &str| {
        let verb = line.split(' ').next().unwrap_or_default();
        overview.lines().any(|line| line.strip_prefix(&format!("  {verb} ")).is_some())
    };
    for path in documents() {
        let page = path.file_name().unwrap().to_str().unwrap().to_owned();
        let text = fs::read_to_string(&path).unwrap().replace("\\\n", " ");
        // Every second part of a text that is split at backticks is code: a fenced block, or a span.
        for code in text.split('`').skip(1).step_by(2) {
            for line in code.lines() {
                let line = line.trim();
                // In a sentence, a command is called by its verb.
                let by_verb = || (line.contains(" --") && is_verb(line)).then_some(line);
                let command = CALLS.iter().find_map(|call| line.strip_prefix(call)).or_else(by_verb);
                shown.extend(command.map(|command| (page.clone(), command.to_owned())));
            }
        }
    }
    shown
}

/// The help of a verb: an empty text if there is no such verb.
fn help(verb: &str) -> String {
    let mut command = Command::new(tests::program::lost_motion());
    let output = command.args(verb.split_whitespace()).arg("--help").output().unwrap();
    if output.status.success() { String::from_utf8(output.stdout).unwrap() } else { String::new() }
}

/// The words of a verb: those before the first flag, value, path or comment. Values of positional arguments may follow.
fn verb(words: &[&str]) -> String {
    let count = match words[0] {
        "board" if words.get(1) == Some(&"bench") => 3,
        "board" => 2,
        _ => 1,
    };
    words[..count.min(words.len())].join(" ")
}

#[test]
fn the_program_has_every_command_and_flag_that_documents_show() {
    let shown = shown();
    assert!(shown.len() > 100, "{}", shown.len());
    let mut helps = BTreeMap::new();
    for (page, command) in shown {
        let command = command.split(['#', '|', '>', '<']).next().unwrap();
        let words: Vec<&str> = command.split_whitespace().collect();
        // `lost-motion --version`, and verbs in general: `lost-motion VERB`.
        if words.first().is_none_or(|word| !word.starts_with(char::is_lowercase)) {
            continue;
        }
        let verb = verb(&words);
        if verb.contains("VERB") || verb.contains('…') {
            continue;
        }
        let help = helps.entry(verb.clone()).or_insert_with(|| help(&verb));
        assert!(!help.is_empty(), "{page}: {command}");
        for flag in words.iter().filter(|word| word.starts_with("--")) {
            let flag = flag.split('=').next().unwrap();
            let has = help.split(|c: char| !(c.is_alphanumeric() || c == '-')).any(|word| word == flag);
            assert!(has, "{page}: {command}: {flag}");
        }
    }
}
