//! A TOML text with the positions of its keys, so that errors can contain key and line.
//!
//! Keys are paths such as `axis.x.effect[0].width_um`; array elements are counted from 0.

use std::fs;
use std::ops::Range;
use std::path::Path;

use indexmap::IndexMap;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error, ValueDeserializer};

use crate::error::{InputError, line_at, shortened};

/// A parsed TOML text.
pub struct Document<'a> {
    source: &'a str,
    text: &'a str,
    root: Spanned<DeTable<'a>>,
    /// All keys of the tree, each before its children.
    entries: IndexMap<String, Entry<'a>>,
    /// Of a document made from another one: the document that the user wrote, with the names that keys have there.
    written: Option<(&'a Document<'a>, IndexMap<String, String>)>,
}

struct Entry<'a> {
    /// Span of the key; for an array element, span of the element.
    name: Range<usize>,
    value: Spanned<DeValue<'a>>,
}

/// Reads the text of a file.
///
/// # Errors
/// If the file cannot be read, or is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    let source = path.display().to_string();
    let bytes = fs::read(path).map_err(|cause| InputError::unreadable(&source, &cause))?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let found = format!("byte 0x{:02X}", error.as_bytes()[at]);
        InputError::expected(&source, "UTF-8 text", found).at_line(line_at(error.as_bytes(), at))
    })
}

impl<'a> Document<'a> {
    /// Parses a text; `source` is the file name given by the user.
    ///
    /// # Errors
    /// If the text is not valid TOML, or contains a number that is not finite.
    pub fn parse(text: &'a str, source: &'a str) -> Result<Self, InputError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let root = DeTable::parse(text).map_err(|error| {
            let offset = error.span().map_or(text.len(), |span| span.start);
            let problem = format!("expected valid TOML: {}", error.message());
            InputError::new(source, problem).at_line(line_at(text.as_bytes(), offset))
        })?;
        let mut entries = IndexMap::new();
        collect("", root.get_ref(), &mut entries);
        let document = Self { source, text, root, entries, written: None };
        document.check_finite()?;
        Ok(document)
    }

    /// This document, made by [`Document::replaced`] from one that the user wrote: errors name its keys and values. `renamed` lists
    /// keys of this document with those in the written one.
    #[must_use]
    pub fn written_as(mut self, written: &'a Self, renamed: Vec<(String, String)>) -> Self {
        self.written = Some((written, renamed.into_iter().collect()));
        self
    }

    /// The text with other text in byte ranges, which do not overlap.
    #[must_use]
    pub fn replaced(&self, changes: &[(Range<usize>, String)]) -> String {
        let mut sorted: Vec<_> = changes.iter().collect();
        sorted.sort_by_key(|(range, _)| range.start);
        let (mut text, mut end) = (String::new(), 0);
        for (range, new) in sorted {
            text.push_str(&self.text[end..range.start]);
            text.push_str(new);
            end = range.end;
        }
        text + &self.text[end..]
    }

    /// Bytes of a key's name; of an array element, those of the element. Empty if there is no such key.
    #[must_use]
    pub fn name_span(&self, key: &str) -> Range<usize> {
        self.entries.get(key).map_or(0..0, |entry| entry.name.clone())
    }

    /// Bytes of a key's value. Empty if there is no such key.
    #[must_use]
    pub fn value_span(&self, key: &str) -> Range<usize> {
        self.entries.get(key).map_or(0..0, |entry| entry.value.span())
    }

    /// Deserializes the whole document.
    ///
    /// # Errors
    /// The first key that does not match the type.
    pub fn deserialize<T: DeserializeOwned>(&self) -> Result<T, InputError> {
        T::deserialize(Deserializer::from(self.root.clone())).map_err(|error| {
            let key = error.span().and_then(|span| self.key_at(&span)).unwrap_or_default();
            self.type_error(key, &error)
        })
    }

    /// Deserializes one value. An error is reported at `key`, even if serde does not report the position, as within tagged
    /// enums.
    ///
    /// # Errors
    /// If the key is missing, or its value does not match the type.
    pub fn deserialize_at<T: DeserializeOwned>(&self, key: &str) -> Result<T, InputError> {
        let entry = self.entries.get(key).ok_or_else(|| self.refuse(key, "this key"))?;
        T::deserialize(ValueDeserializer::from(entry.value.clone()))
            .map_err(|error| self.type_error(key, &error))
    }

    /// The error "expected …, found …" at a key; the found value is that of the document.
    #[must_use]
    pub fn refuse(&self, key: &str, what: &str) -> InputError {
        self.located(key, InputError::expected(self.source, what, self.found(key)))
    }

    /// An error at a key with its own message.
    #[must_use]
    pub fn error_at(&self, key: &str, problem: &str) -> InputError {
        self.located(key, InputError::new(self.source, problem))
    }

    /// Direct children of the table or array at `key`, sorted by position in the file, as the parser sorts tables by name.
    pub fn children(&self, key: &str) -> Vec<&str> {
        let direct = |candidate: &&String| parent(candidate) == key;
        let mut keys: Vec<&str> = self.entries.keys().filter(direct).map(String::as_str).collect();
        keys.sort_by_key(|key| self.entries[*key].name.start);
        keys
    }

    /// Whether there is a key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.entries.contains_key(key)
    }

    /// The number at a key; `None` if the value is none.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        let value = &self.entries.get(key)?.value;
        f64::deserialize(ValueDeserializer::from(value.clone())).ok()
    }

    /// The text at a key; `None` if the value is none.
    #[must_use]
    pub fn word(&self, key: &str) -> Option<String> {
        let value = &self.entries.get(key)?.value;
        String::deserialize(ValueDeserializer::from(value.clone())).ok()
    }

    /// Whether the value at a key is a number.
    #[must_use]
    pub fn is_number(&self, key: &str) -> bool {
        let value = self.entries.get(key).map(|entry| entry.value.get_ref());
        matches!(value, Some(DeValue::Integer(_) | DeValue::Float(_)))
    }

    fn check_finite(&self) -> Result<(), InputError> {
        let infinite = |entry: &Entry<'_>| match entry.value.get_ref() {
            DeValue::Float(float) => !float.as_str().parse().is_ok_and(f64::is_finite),
            _ => false,
        };
        match self.entries.iter().find(|(_, entry)| infinite(entry)) {
            Some((key, _)) => Err(self.refuse(key, "a finite number")),
            None => Ok(()),
        }
    }

    fn located(&self, key: &str, error: InputError) -> InputError {
        if let Some((written, old)) = self.written_key(key) {
            return written.located(old, error);
        }
        let error = if key.is_empty() { error } else { error.at_key(key) };
        match self.line(key) {
            Some(line) => error.at_line(line),
            None => error,
        }
    }

    /// The document that the user wrote, and the name of a key there.
    fn written_key<'k>(&'k self, key: &'k str) -> Option<(&'k Document<'a>, &'k str)> {
        let (written, renamed) = self.written.as_ref()?;
        Some((written, renamed.get(key).map_or(key, String::as_str)))
    }

    /// Line of a key, or of the innermost enclosing table if the key is missing.
    fn line(&self, key: &str) -> Option<usize> {
        let around = std::iter::successors(Some(key), |key| Some(parent(key)));
        let mut around = around.take_while(|key| !key.is_empty());
        let entry = around.find_map(|key| self.entries.get(key))?;
        Some(line_at(self.text.as_bytes(), entry.name.start))
    }

    /// The value at a key for a message: the text of the file, or a description of a table or array.
    fn found(&self, key: &str) -> String {
        if let Some((written, old)) = self.written_key(key) {
            return written.found(old);
        }
        let Some(entry) = self.entries.get(key) else {
            return "none".to_owned();
        };
        match entry.value.get_ref() {
            DeValue::Table(table) if table.is_empty() => "an empty table".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
            DeValue::Array(array) => format!("an array of {}", array.len()),
            _ => shortened(&self.text[entry.value.span()]),
        }
    }

    /// The innermost key whose name or value has exactly this span.
    fn key_at(&self, span: &Range<usize>) -> Option<&str> {
        let hit = |entry: &Entry<'_>| entry.name == *span || entry.value.span() == *span;
        self.entries.iter().rev().find(|(_, entry)| hit(entry)).map(|(key, _)| key.as_str())
    }

    /// The only key within another one that has this text as its value: within tagged enums serde reports that of the enum.
    fn key_of_text(&self, outer: &str, text: &str) -> Option<&str> {
        let is_text =
            |entry: &Entry<'_>| matches!(entry.value.get_ref(), DeValue::String(found) if found == text);
        let mut keys = self.entries.iter().filter(|(key, entry)| key.starts_with(outer) && is_text(entry));
        let (key, _) = keys.next()?;
        keys.next().is_none().then_some(key)
    }

    /// Converts an error of serde at the value of `key`.
    fn type_error(&self, key: &str, error: &Error) -> InputError {
        let message = error.message();
        if let Some(name) = between(message, "missing field `", "`") {
            return self.refuse(&join(key, name), "this key");
        }
        let Some((problem, expected)) = message.split_once(", expected ") else {
            return self.refuse(key, &format!("a valid value ({message})"));
        };
        if let (Some(length), "a sequence") = (problem.strip_prefix("invalid length "), expected) {
            // A list with a capacity is refused at its first element beyond it.
            let most = length.parse::<usize>().map_or(0, |length| length.saturating_sub(1));
            return self.refuse(key, &format!("an array of at most {most}"));
        }
        let expected = type_name(expected);
        if let Some(variant) = between(problem, "unknown variant `", "`") {
            return self.refuse(self.key_of_text(key, variant).unwrap_or(key), &expected);
        }
        match between(problem, "unknown field `", "`") {
            Some(name) => {
                let inner = join(key, name);
                let key = if self.entries.contains_key(&inner) { &inner } else { key };
                let problem = format!("unknown key, expected {expected}");
                self.located(key, InputError::new(self.source, problem))
            }
            None => self.refuse(key, &expected),
        }
    }
}

fn collect<'a>(at: &str, table: &DeTable<'a>, entries: &mut IndexMap<String, Entry<'a>>) {
    for (name, value) in table {
        add(&join(at, name.get_ref()), name.span(), value, entries);
    }
}

fn add<'a>(
    key: &str,
    name: Range<usize>,
    value: &Spanned<DeValue<'a>>,
    entries: &mut IndexMap<String, Entry<'a>>,
) {
    entries.insert(key.to_owned(), Entry { name, value: value.clone() });
    match value.get_ref() {
        DeValue::Table(table) => collect(key, table, entries),
        DeValue::Array(array) => {
            for (index, element) in array.iter().enumerate() {
                add(&format!("{key}[{index}]"), element.span(), element, entries);
            }
        }
        _ => {}
    }
}

/// Key of the enclosing table or array; empty for the root.
fn parent(key: &str) -> &str {
    key.rfind(['.', '[']).map_or("", |end| &key[..end])
}

fn join(table: &str, name: &str) -> String {
    if table.is_empty() { name.to_owned() } else { format!("{table}.{name}") }
}

fn between<'t>(text: &'t str, before: &str, after: &str) -> Option<&'t str> {
    Some(text.strip_prefix(before)?.split_once(after)?.0)
}

/// Replaces the names of Rust types by terms of TOML.
fn type_name(expected: &str) -> String {
    match expected {
        "f64" => "a number".to_owned(),
        "u32" => "a whole number not below 0".to_owned(),
        "a string" | "string" => "a text in quotes".to_owned(),
        "a sequence" => "an array".to_owned(),
        "a map" => "a table".to_owned(),
        other if other.starts_with("struct ") || other.contains("enum ") => "a table".to_owned(),
        other => match other.strip_prefix("a tuple of size ") {
            Some(size) => format!("an array of {size}"),
            None => other.replace('`', ""),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
        z = 1
        a = { b = [1, 2.5e0], c = 1_0.5 }
        [[t.u]]
        k = 'v'
        [[t.u]]
    ";

    fn parse_error(text: &str) -> String {
        Document::parse(text, "f.toml").err().unwrap().to_string()
    }

    /// The value of an enum within a tagged one, which serde reads from a copy without places.
    #[test]
    fn an_unknown_word_is_refused_at_its_key() {
        #[derive(Debug, serde::Deserialize)]
        #[serde(tag = "name", rename_all = "lowercase")]
        enum Tagged {
            One { side: Side },
        }
        #[derive(Debug, PartialEq, serde::Deserialize)]
        #[serde(rename_all = "lowercase")]
        enum Side {
            Left,
            Right,
        }
        #[derive(Debug, serde::Deserialize)]
        struct Root {
            e: Vec<Tagged>,
        }
        let read = |side: &str| {
            let text = format!("[[e]]\nname = 'one'\nside = '{side}'\n");
            Document::parse(&text, "f.toml").unwrap().deserialize::<Root>().map_err(|error| error.to_string())
        };
        let unknown = "f.toml: line 3: e[0].side: expected left or right, found 'up'";
        assert_eq!(read("up").unwrap_err(), unknown);
        let is_read = |name, side| matches!(&read(name).unwrap().e[..], [Tagged::One { side: found }] if *found == side);
        assert!(is_read("left", Side::Left) && is_read("right", Side::Right));
    }

    #[test]
    fn refusal_names_line_key_and_value() {
        let document = Document::parse(TEXT, "f.toml").unwrap();
        let message = |key| document.refuse(key, "Z").to_string();
        assert_eq!(message("a.b[1]"), "f.toml: line 3: a.b[1]: expected Z, found 2.5e0");
        assert_eq!(message("t.u[0].k"), "f.toml: line 5: t.u[0].k: expected Z, found 'v'");
        assert_eq!(message("t.u[1].k"), "f.toml: line 6: t.u[1].k: expected Z, found none");
        assert_eq!(message("a"), "f.toml: line 3: a: expected Z, found a table");
        assert_eq!(message("nothing"), "f.toml: nothing: expected Z, found none");
    }

    #[test]
    fn children_are_in_the_order_of_the_file() {
        let document = Document::parse(TEXT, "f.toml").unwrap();
        assert_eq!(document.children(""), ["z", "a", "t"]);
        assert_eq!(document.children("t.u"), ["t.u[0]", "t.u[1]"]);
        assert_eq!(document.children("absent"), [""; 0]);
    }

    #[test]
    fn invalid_toml_is_refused_in_one_line() {
        let message = parse_error("a = 1\nb c\n");
        assert!(message.starts_with("f.toml: line 2: expected valid TOML: "), "{message}");
        assert!(!message.contains('\n'), "{message}");
        assert!(parse_error("a = 1\na = 2\n").contains("line 2"));
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let message = parse_error("[t]\na = [1, -inf]");
        assert_eq!(message, "f.toml: line 2: t.a[1]: expected a finite number, found -inf");
        assert!(parse_error("a = nan").ends_with("a: expected a finite number, found nan"));
        assert!(parse_error("a = 1e400").ends_with("a: expected a finite number, found 1e400"));
    }
}
