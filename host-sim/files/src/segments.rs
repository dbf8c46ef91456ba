//! The text of a file, in segments of whole lines.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::error::{InputError, line_at};

/// First two bytes of a gzip file (RFC 1952).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Smallest length of a segment that is not the last one, bytes.
const SEGMENT: usize = 1 << 22;

/// Most bytes that a gzip file may unpack to, 2 GiB: an hour at 4 kHz with 13 columns of 10 digits.
const MOST_UNPACKED: u64 = 1 << 31;

/// Opens a file; `-` is standard input. A gzip file, recognised by the suffix `.gz` or by its first bytes, is decompressed.
///
/// # Errors
/// If the file cannot be read.
pub fn open<'a>(path: &Path, source: &str) -> Result<Box<dyn Read + 'a>, InputError> {
    let unreadable = |cause: io::Error| InputError::unreadable(source, &cause);
    let file: Box<dyn Read> = if source == "-" {
        Box::new(io::stdin().lock())
    } else {
        Box::new(File::open(path).map_err(unreadable)?)
    };
    let has_suffix = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("gz"));
    unpacked(file, has_suffix, source)
}

/// An input, decompressed if it is a gzip file by its first bytes, or by its name (`is_named_gzip`).
///
/// # Errors
/// If it cannot be read.
pub fn unpacked<'a>(
    mut input: Box<dyn Read + 'a>,
    is_named_gzip: bool,
    source: &str,
) -> Result<Box<dyn Read + 'a>, InputError> {
    let mut start = Vec::new();
    let read = input.by_ref().take(GZIP_MAGIC.len() as u64).read_to_end(&mut start);
    read.map_err(|cause| InputError::unreadable(source, &cause))?;
    let is_gzip = start == GZIP_MAGIC || (is_named_gzip && !start.is_empty());
    let whole = io::Cursor::new(start).chain(input);
    Ok(if is_gzip {
        Box::new(Unpacked { packed: MultiGzDecoder::new(whole), left: MOST_UNPACKED })
    } else {
        Box::new(whole)
    })
}

/// An unpacked gzip file, whose errors say so; `left` is the number of bytes that it may still unpack to.
struct Unpacked<R> {
    packed: MultiGzDecoder<R>,
    left: u64,
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let incomplete = |cause| io::Error::other(format!("expected a complete gzip file: {cause}"));
        let read = self.packed.read(buffer).map_err(incomplete)?;
        let too_long = || {
            let limit = MOST_UNPACKED >> 20;
            io::Error::other(format!("expected a gzip file of at most {limit} MiB, unpacked, found more"))
        };
        self.left = self.left.checked_sub(read as u64).ok_or_else(too_long)?;
        Ok(read)
    }
}

/// The error of an input that was opened and cannot be read on; a broken gzip file says so itself.
pub(crate) fn unreadable(source: &str, cause: &io::Error) -> InputError {
    if cause.kind() == io::ErrorKind::Other {
        return InputError::new(source, cause.to_string());
    }
    InputError::unreadable(source, cause)
}

/// The segments of a text, without the byte order mark.
pub struct Segments<'a> {
    source: &'a str,
    input: Box<dyn Read + 'a>,
    /// The beginning of a line whose end is not yet read.
    rest: Vec<u8>,
    /// Line of the first byte of `rest`.
    line: usize,
}

impl<'a> Segments<'a> {
    /// The segments of an input; `source` is the file name for error messages.
    #[must_use]
    pub fn new(input: Box<dyn Read + 'a>, source: &'a str) -> Self {
        Self { source, input, rest: Vec::new(), line: 1 }
    }

    /// The next segment of whole lines; the last line may lack its end. `None` after the last one.
    ///
    /// # Errors
    /// If the input cannot be read, is not a text in UTF-8, or has a line of more than 4 MiB.
    pub fn next_segment(&mut self) -> Result<Option<Vec<u8>>, InputError> {
        let mut text = std::mem::take(&mut self.rest);
        let read = self.input.by_ref().take(SEGMENT as u64).read_to_end(&mut text);
        let read = read.map_err(|cause| unreadable(self.source, &cause))?;
        let is_end = read < SEGMENT;
        self.check(&text, is_end)?;
        if !is_end {
            let Some(end) = text.iter().rposition(|&byte| byte == b'\n') else {
                let error = InputError::expected(self.source, "lines of at most 4 MiB", "a longer one");
                return Err(error.at_line(self.line));
            };
            self.rest = text.split_off(end + 1);
        }
        if text.is_empty() {
            return Ok(None);
        }
        let first = self.line == 1 && text.starts_with(BYTE_ORDER_MARK);
        self.line += line_at(&text, text.len()) - 1;
        if first {
            text.drain(..BYTE_ORDER_MARK.len());
        }
        Ok(Some(text))
    }

    /// Checks that bytes are UTF-8; the last character may be incomplete unless they are the end of the text.
    fn check(&self, bytes: &[u8], is_end: bool) -> Result<(), InputError> {
        let not_text = |at: usize| {
            let found = format!("byte 0x{:02X}", bytes[at]);
            let line = self.line + line_at(bytes, at) - 1;
            Err(InputError::expected(self.source, "a CSV text in UTF-8", found).at_line(line))
        };
        // A zero byte is valid UTF-8, but indicates a binary file.
        if let Some(at) = bytes.iter().position(|&byte| byte == 0) {
            return not_text(at);
        }
        match str::from_utf8(bytes) {
            Err(error) if is_end || error.error_len().is_some() => not_text(error.valid_up_to()),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines of 64 bytes: with three segments' worth of them, each segment but the last is [`SEGMENT`] long.
    fn lines(count: usize) -> String {
        (0..count).map(|i| format!("{i:063}\n")).collect()
    }

    fn segments(text: &[u8]) -> Result<Vec<Vec<u8>>, InputError> {
        let mut segments = Segments::new(Box::new(text), "t.csv");
        let mut all = Vec::new();
        while let Some(next) = segments.next_segment()? {
            all.push(next);
        }
        Ok(all)
    }

    #[test]
    fn the_segments_of_whole_lines_are_the_text() {
        let text = format!("\u{feff}a,µ{}", lines(3 * SEGMENT / 64));
        let parts = segments(text.as_bytes()).unwrap();
        assert!(parts.len() >= 3 && parts[..parts.len() - 1].iter().all(|part| part.ends_with(b"\n")));
        assert!(parts.iter().all(|part| part.len() <= SEGMENT + 64));
        assert!(parts.concat() == text.as_bytes()[3..], "the text without the byte order mark");
    }

    #[test]
    fn a_byte_that_is_no_text_is_found_with_its_line_in_any_segment() {
        let count = 2 * SEGMENT / 64 + 100;
        for (line, byte) in [(5, 0), (count - 3, 0xff), (count - 3, 0)] {
            let mut text = lines(count).into_bytes();
            text[64 * (line - 1) + 7] = byte;
            let message = segments(&text).unwrap_err().to_string();
            let expected =
                format!("t.csv: line {line}: expected a CSV text in UTF-8, found byte 0x{byte:02X}");
            assert_eq!(message, expected);
        }
        // A character whose second byte is missing at the end of the text.
        assert!(segments("ab\u{b5}".as_bytes().get(..3).unwrap()).is_err());
    }

    #[test]
    fn a_line_that_is_longer_than_a_segment_is_an_error() {
        let line = |bytes: usize| format!("a\n{}", "1".repeat(bytes));
        let parts = segments(line(SEGMENT - 3).as_bytes()).unwrap();
        assert_eq!(parts.concat().len(), SEGMENT - 1);
        let message = segments(line(2 * SEGMENT + 5).as_bytes()).unwrap_err().to_string();
        assert_eq!(message, "t.csv: line 2: expected lines of at most 4 MiB, found a longer one");
        assert!(segments(b"").unwrap().is_empty());
    }

    /// A limit in place of [`MOST_UNPACKED`], which is too long for a test.
    #[test]
    fn a_gzip_file_unpacks_to_no_more_than_its_limit() {
        let mut packed = Vec::new();
        flate2::read::GzEncoder::new(&[7_u8; 1000][..], flate2::Compression::default())
            .read_to_end(&mut packed)
            .unwrap();
        let unpacked = |left| {
            let mut all = Vec::new();
            Unpacked { packed: MultiGzDecoder::new(&packed[..]), left }.read_to_end(&mut all).map(|_| all)
        };
        assert_eq!(unpacked(1000).unwrap(), [7; 1000]);
        let message = unpacked(999).unwrap_err().to_string();
        assert_eq!(message, "expected a gzip file of at most 2048 MiB, unpacked, found more");
    }
}
