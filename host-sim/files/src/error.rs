//! Errors in input files, each in one line.

use std::fmt::{self, Display};
use std::io;

use thiserror::Error;

/// Maximum number of characters of an input that a message quotes.
const MAX_QUOTE: usize = 40;

/// An input that cannot be used.
///
/// Displayed as one line: file, line, key or column, then what was expected there and what was found.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{}{}{}: {problem}", FileName(file), Line(*line), Key(key.as_deref()))]
pub struct InputError {
    file: String,
    line: Option<usize>,
    key: Option<String>,
    problem: String,
}

impl InputError {
    /// The error "expected …, found …" in `file`. Text from the input should be passed through [`quoted`] first.
    #[must_use]
    pub fn expected(file: &str, what: impl Display, found: impl Display) -> Self {
        Self::new(file, format!("expected {what}, found {found}"))
    }

    /// An error with its own message.
    #[must_use]
    pub fn new(file: &str, problem: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line: None, key: None, problem: in_one_line(&problem.into()) }
    }

    /// The error of a file that cannot be opened or read.
    #[must_use]
    pub fn unreadable(file: &str, cause: &io::Error) -> Self {
        Self::new(file, format!("expected a readable file: {cause}"))
    }

    /// This error with what to do about it, in brackets.
    #[must_use]
    pub fn with_advice(self, advice: &str) -> Self {
        Self { problem: format!("{} ({})", self.problem, in_one_line(advice)), ..self }
    }

    /// This error at a line of the file, counted from 1.
    #[must_use]
    pub fn at_line(self, line: usize) -> Self {
        Self { line: Some(line), ..self }
    }

    /// This error at a key (`axis.x.lead_mm`) or a column (`x_motor_mm`).
    #[must_use]
    pub fn at_key(self, key: &str) -> Self {
        Self { key: Some(in_one_line(key)), ..self }
    }
}

/// A part of an input for a message: quoted, escaped, truncated to [`MAX_QUOTE`] characters.
#[must_use]
pub fn quoted(found: &str) -> String {
    format!("\"{}\"", shortened(found).escape_debug())
}

/// A part of an input, truncated to [`MAX_QUOTE`] characters.
#[must_use]
pub fn shortened(found: &str) -> String {
    match found.char_indices().nth(MAX_QUOTE) {
        Some((end, _)) => format!("{}…", &found[..end]),
        None => found.to_owned(),
    }
}

/// Line of a byte of the text, counted from 1.
#[must_use]
pub fn line_at(text: &[u8], offset: usize) -> usize {
    let before = &text[..offset.min(text.len())];
    before.split(|&byte| byte == b'\n').count()
}

/// Replaces each run of white space, line ends included, by one space, and control characters by `?`.
#[must_use]
pub fn in_one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ").replace(is_invisible, "?")
}

/// A text for a terminal: control characters but line ends and tabs, and characters that turn the direction of the text or are not
/// visible, are replaced by `?`. A name in a file may contain any.
#[must_use]
pub fn printable(text: &str) -> String {
    text.replace(|c: char| is_invisible(c) && !matches!(c, '\n' | '\t'), "?")
}

/// Whether a character controls a terminal or the direction of a text.
fn is_invisible(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// A file name. Spaces are kept, so that the name can be copied; control characters are replaced by `?`.
struct FileName<'a>(&'a str);

impl Display for FileName<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.replace(is_invisible, "?"))
    }
}

struct Line(Option<usize>);

impl Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |line| write!(f, ": line {line}"))
    }
}

struct Key<'a>(Option<&'a str>);

impl Display for Key<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |key| write!(f, ": {key}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_line_key_and_problem_are_one_line() {
        let error = InputError::expected("fit.csv", "a finite number", quoted("NaN"))
            .at_line(17)
            .at_key("x_motor_mm");
        let wanted = "fit.csv: line 17: x_motor_mm: expected a finite number, found \"NaN\"";
        assert_eq!(error.to_string(), wanted);
    }

    #[test]
    fn advice_is_in_brackets() {
        let error = InputError::new("a.csv", "is a picture").with_advice("draw\nit");
        assert_eq!(error.to_string(), "a.csv: is a picture (draw it)");
    }

    #[test]
    fn unknown_locations_are_omitted() {
        assert_eq!(InputError::new("a.csv", "is a picture").to_string(), "a.csv: is a picture");
    }

    #[test]
    fn messages_contain_no_line_ends_and_no_control_characters() {
        let error = InputError::new("a\nb.csv", "one\n  | two\r\n\u{1b}[31m").at_key("k\ney");
        assert_eq!(error.to_string(), "a?b.csv: k ey: one | two ?[31m");
    }

    #[test]
    fn a_text_for_a_terminal_keeps_its_lines_alone() {
        assert_eq!(printable("a\tb\n\u{1b}[2J\r\u{9b}c\u{202e}µ"), "a\tb\n?[2J??c?µ");
    }

    #[test]
    fn a_long_quote_is_truncated() {
        let long = "x".repeat(1000);
        assert_eq!(quoted(&long).chars().count(), MAX_QUOTE + 3);
        assert_eq!(quoted("a\nb"), "\"a\\nb\"");
    }
}
