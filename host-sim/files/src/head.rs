//! The first line of an input, looked at before it is decided what reads it.

use std::io::{Cursor, Read};
use std::path::Path;

use crate::error::InputError;
use crate::segments::{open, unreadable};
use crate::table::Table;

/// Longest beginning that is looked at, bytes. A header line is shorter.
const LONGEST: usize = 1 << 20;

/// Bytes that are read at a time.
const PART: u64 = 1 << 12;

/// An input of which the first line is known, and from which nothing is lost.
pub struct Head<'a> {
    start: Vec<u8>,
    rest: Box<dyn Read + 'a>,
}

impl<'a> Head<'a> {
    /// Opens a file, as [`open`]; `source` is the file name for error messages.
    ///
    /// # Errors
    /// If the file cannot be read, or its beginning not be unpacked.
    pub fn open(path: &Path, source: &str) -> Result<Self, InputError> {
        Self::of(open(path, source)?, source)
    }

    /// The beginning of an opened input.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn of(mut input: Box<dyn Read + 'a>, source: &str) -> Result<Self, InputError> {
        let mut start = Vec::new();
        while start.len() < LONGEST && !has_line(&start) {
            let read = input.by_ref().take(PART).read_to_end(&mut start);
            if read.map_err(|cause| unreadable(source, &cause))? == 0 {
                break;
            }
        }
        Ok(Self { start, rest: input })
    }

    /// Names of the columns, if the first line that is not blank is the header of a table with commas; none of a binary file or of
    /// one in another encoding than UTF-8.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let begin = self.start.len() - self.start.trim_ascii_start().len();
        let text = &self.start[begin..];
        let line = text.iter().position(|&byte| byte == b'\n').map_or(text, |end| &text[..end]);
        Table::parse(line, "").map_or_else(|_| Vec::new(), |table| table.names().to_vec())
    }

    /// Whether the input has nothing but white space.
    #[must_use]
    pub fn is_blank(&self) -> bool {
        self.start.trim_ascii().is_empty()
    }

    /// The whole input.
    #[must_use]
    pub fn into_input(self) -> Box<dyn Read + 'a> {
        Box::new(Cursor::new(self.start).chain(self.rest))
    }
}

/// Whether bytes have the end of a line that is not blank.
fn has_line(start: &[u8]) -> bool {
    start.trim_ascii_start().contains(&b'\n')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(bytes: &[u8]) -> Head<'_> {
        Head::of(Box::new(bytes), "a").unwrap()
    }

    #[test]
    fn the_first_line_is_known_and_nothing_is_lost() {
        let long = format!("{}\n1,2\n", vec!["name"; 5000].join(","));
        for (text, names) in [
            ("a, b\r\n1,2\n", vec!["a", "b"]),
            ("\u{feff}a,\"b\"\n1,2\n", vec!["a", "b"]),
            ("\n \r\na,b", vec!["a", "b"]),
            ("a;b\n1;2\n", vec!["a;b"]),
            (long.as_str(), vec!["name"; 5000]),
            ("", vec![]),
        ] {
            assert_eq!(head(text.as_bytes()).names(), names, "{}", &text[..text.len().min(20)]);
            let mut whole = Vec::new();
            head(text.as_bytes()).into_input().read_to_end(&mut whole).unwrap();
            assert!(whole == text.as_bytes());
        }
    }

    #[test]
    fn binary_and_blank_inputs_have_no_names() {
        assert!(head(b"PK\x03\x04\0\0").names().is_empty() && head(b"x \xb5m,y\n").names().is_empty());
        assert!(head(b" \n\n").is_blank() && !head(b" \n1").is_blank());
    }

    /// An input that never ends a line is not read to its end.
    #[test]
    fn no_more_than_the_longest_beginning_is_read() {
        let endless = Head::of(Box::new(std::io::repeat(b'x')), "a").unwrap();
        assert!((LONGEST..LONGEST + 8192).contains(&endless.start.len()));
    }
}
