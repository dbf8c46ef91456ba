//! Arrays of NumPy: `.npy`, and `.npz`, an archive of them.
//!
//! The header is read by our own few lines: `npyz` 0.9 panics where a type has one letter that is not ASCII, and where the product of the
//! dimensions overflows. Source: NumPy Enhancement Proposal 1, "A Simple File Format for NumPy Arrays", versions 1 to 3.

use std::io::Cursor;

use files::error::{InputError, quoted};
use zip::ZipArchive;

use crate::arrays::Array;
use crate::budget::Budget;
use crate::numbers::{Kind, Layout};

/// First bytes of an array.
const MAGIC: &[u8] = b"\x93NUMPY";

/// Reads an array, or the arrays of an archive.
///
/// # Errors
/// If the file is neither, is cut off, or unpacks to more than `budget`.
pub fn arrays(
    bytes: &[u8],
    mut budget: Budget,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<Array>, InputError> {
    let mut arrays = Vec::new();
    if bytes.starts_with(MAGIC) {
        read(bytes, "", source, &mut arrays, notes)?;
        return Ok(arrays);
    }
    let broken =
        |cause: zip::result::ZipError| InputError::expected(source, "an archive of NumPy (.npz)", cause);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(broken)?;
        let name = entry.name().map_err(broken)?.into_owned();
        let unpacked = budget.read(entry, source)?;
        match name.strip_suffix(".npy") {
            Some(name) if unpacked.starts_with(MAGIC) => read(&unpacked, name, source, &mut arrays, notes)?,
            _ => notes.push(format!("not read: {}, no array", quoted(&name))),
        }
    }
    Ok(arrays)
}

/// Appends an array, or one for each field of a structured one.
fn read(
    bytes: &[u8],
    name: &str,
    source: &str,
    arrays: &mut Vec<Array>,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let expected =
        |what: &str, found: String| InputError::expected(source, what, found).at_key(&quoted(name));
    let (header, content) =
        divide(bytes).ok_or_else(|| expected("a header of NumPy", "a file that is cut off".to_owned()))?;
    let header = Header::parse(&String::from_utf8_lossy(header))
        .map_err(|found| expected("a header of NumPy: descr, fortran_order, shape", quoted(&found)))?;
    let size: usize = header.fields.iter().map(|field| field.size).sum();
    let count = header.shape.iter().try_fold(1usize, |count, &length| count.checked_mul(length));
    let count = count.filter(|&count| count.checked_mul(size).is_some_and(|bytes| bytes <= content.len()));
    let Some(count) = count else {
        return Err(expected("as many values as its shape says", format!("{} bytes", content.len())));
    };
    let mut start = 0;
    for Field { name: field, size: width, layout } in header.fields {
        let name = match (name, field.as_str()) {
            (name, "") => name.to_owned(),
            ("", field) => field.to_owned(),
            (name, field) => format!("{name}:{field}"),
        };
        if let Some(layout) = layout.filter(|_| size > 0) {
            let rows = content.chunks_exact(size).take(count);
            let values = rows.map(|row| layout.number(&row[start..start + width])).collect();
            arrays.push(Array {
                name,
                shape: header.shape.clone(),
                is_column_major: header.is_column_major,
                values,
            });
        } else {
            notes.push(format!("not read: {}, no real numbers", quoted(&name)));
        }
        start += width;
    }
    Ok(())
}

/// Header and content of an array.
fn divide(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (version, rest) = rest.split_at_checked(2)?;
    let (length, rest) = if version[0] == 1 {
        let (length, rest) = rest.split_first_chunk()?;
        (usize::from(u16::from_le_bytes(*length)), rest)
    } else {
        let (length, rest) = rest.split_first_chunk()?;
        (usize::try_from(u32::from_le_bytes(*length)).ok()?, rest)
    };
    rest.split_at_checked(length)
}

/// What the header of an array says.
struct Header {
    /// One without a name, or those of a structured array.
    fields: Vec<Field>,
    is_column_major: bool,
    shape: Vec<usize>,
}

struct Field {
    name: String,
    /// Bytes of a value.
    size: usize,
    /// `None`: it is no real number.
    layout: Option<Layout>,
}

/// A part of a literal of Python.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token<'a> {
    Text(&'a str),
    Word(&'a str),
    Sign(char),
}

impl Header {
    /// Reads `{'descr': '<f8', 'fortran_order': False, 'shape': (3, 2), }`. An error is what was found.
    fn parse(text: &str) -> Result<Self, String> {
        let tokens = tokens(text);
        let value = |key: &str| {
            let is_key = |two: &[Token<'_>]| two == [Token::Text(key), Token::Sign(':')];
            let at = tokens.windows(2).position(is_key)?;
            tokens.get(at + 2..)
        };
        let parsed = || {
            let fields = match value("descr")? {
                [Token::Text(kind), ..] => vec![Field::of("", kind)?],
                [Token::Sign('['), rest @ ..] => structure(rest)?,
                _ => return None,
            };
            let is_column_major = value("fortran_order")?.first()? == &Token::Word("True");
            let [Token::Sign('('), rest @ ..] = value("shape")? else { return None };
            let sizes = rest.iter().take_while(|token| **token != Token::Sign(')'));
            let sizes = sizes.filter(|token| **token != Token::Sign(','));
            let size =
                |token: &Token<'_>| if let Token::Word(size) = token { size.parse().ok() } else { None };
            Some(Self { fields, is_column_major, shape: sizes.map(size).collect::<Option<_>>()? })
        };
        parsed().ok_or_else(|| text.to_owned())
    }
}

/// The fields of `[('t', '<f8'), ('x', '<f4', (3,))]`, of which the opening bracket is read.
fn structure(mut tokens: &[Token<'_>]) -> Option<Vec<Field>> {
    let mut fields = Vec::new();
    loop {
        match tokens {
            [Token::Sign(']'), ..] => return Some(fields),
            [Token::Sign(','), rest @ ..] => tokens = rest,
            [
                Token::Sign('('),
                Token::Text(name),
                Token::Sign(','),
                Token::Text(kind),
                Token::Sign(')'),
                rest @ ..,
            ] => {
                fields.push(Field::of(name, kind)?);
                tokens = rest;
            }
            // A field that is an array or a structure itself.
            _ => return None,
        }
    }
}

impl Field {
    /// A field of a type such as `<f8`: order of bytes, kind, size.
    fn of(name: &str, kind: &str) -> Option<Self> {
        let mut letters = kind.chars();
        let (order, kind) = (letters.next()?, letters.next()?);
        let digits: String = letters.take_while(char::is_ascii_digit).collect();
        // The size of a text is that of its letters, of four bytes each.
        let size = digits.parse::<usize>().ok()?.checked_mul(if kind == 'U' { 4 } else { 1 })?;
        let kind = match kind {
            'f' => Some(Kind::Float),
            'i' => Some(Kind::Signed),
            'u' | 'b' => Some(Kind::Unsigned),
            _ => None,
        };
        let layout = kind.map(|kind| Layout { kind, size, is_little: order != '>' });
        // The sum of the sizes of all fields must not overflow.
        (size <= 1 << 20).then(|| Self {
            name: name.to_owned(),
            size,
            layout: layout.filter(|layout| layout.is_known()),
        })
    }
}

fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let after = &rest[first.len_utf8()..];
        rest = match first {
            '\'' | '"' => {
                let (inside, after) = after.split_once(first).unwrap_or((after, ""));
                tokens.push(Token::Text(inside));
                after
            }
            _ if first.is_alphanumeric() => {
                let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
                tokens.push(Token::Word(&rest[..end]));
                &rest[end..]
            }
            _ if first.is_whitespace() => after,
            _ => {
                tokens.push(Token::Sign(first));
                after
            }
        };
    }
    tokens
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use zip::write::{SimpleFileOptions, ZipWriter};

    use super::*;

    fn npy(header: &str, content: &[u8]) -> Vec<u8> {
        let length = u16::try_from(header.len()).unwrap().to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), content].concat()
    }

    fn of(bytes: &[u8], budget: Budget) -> Result<(Vec<Array>, Vec<String>), String> {
        let mut notes = Vec::new();
        let arrays = arrays(bytes, budget, "a.npz", &mut notes).map_err(|error| error.to_string())?;
        Ok((arrays, notes))
    }

    #[test]
    fn a_matrix_is_read_in_either_order() {
        let content: Vec<u8> = [1i16, 2, 3, -4].into_iter().flat_map(i16::to_be_bytes).collect();
        for (word, is_column_major) in [("True", true), ("False", false)] {
            let header = format!("{{'descr': '>i2', 'fortran_order': {word}, 'shape': (2, 2), }}   \n");
            let (arrays, _) = of(&npy(&header, &content), Budget::file()).unwrap();
            let expected = Array {
                name: String::new(),
                shape: vec![2, 2],
                is_column_major,
                values: vec![1.0, 2.0, 3.0, -4.0],
            };
            assert_eq!(arrays, [expected]);
        }
    }

    #[test]
    fn the_fields_of_a_structured_array_are_arrays() {
        let header = "{'descr': [('t', '<f4'), ('what', '<U1'), ('x', '|u1')], 'fortran_order': False, 'shape': (2,), }";
        let row = |t: f32, x: u8| [&t.to_le_bytes()[..], &[65, 0, 0, 0], &[x]].concat();
        let (arrays, notes) =
            of(&npy(header, &[row(0.5, 7), row(1.5, 255)].concat()), Budget::file()).unwrap();
        let found: Vec<_> = arrays.iter().map(|array| (array.name.as_str(), &array.values[..])).collect();
        assert_eq!(found, [("t", &[0.5, 1.5][..]), ("x", &[7.0, 255.0])]);
        assert_eq!(notes, ["not read: \"what\", no real numbers"]);
    }

    #[test]
    fn an_archive_is_read_up_to_its_limit() {
        let zeros = npy("{'descr': '<f8', 'fortran_order': False, 'shape': (100000,), }", &vec![0; 800_000]);
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        archive.start_file("zeros.npy", SimpleFileOptions::default()).unwrap();
        archive.write_all(&zeros).unwrap();
        archive.start_file("remark.txt", SimpleFileOptions::default()).unwrap();
        let bytes = archive.finish().unwrap().into_inner();
        assert!(bytes.len() < 4000, "{}", bytes.len());
        let (arrays, notes) = of(&bytes, Budget::new(1 << 20)).unwrap();
        assert_eq!((arrays[0].name.as_str(), arrays[0].values.len()), ("zeros", 100_000));
        assert_eq!(notes, ["not read: \"remark.txt\", no array"]);
        assert!(of(&bytes, Budget::new(1 << 19)).unwrap_err().contains("at most 524288 bytes, unpacked"));
    }

    #[test]
    fn what_contradicts_itself_is_refused() {
        for header in [
            "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296, 3), }",
            "{'descr': '\u{b5}', 'fortran_order': False, 'shape': (1,), }",
            "{'descr': [('a', '<f8', (2,))], 'fortran_order': False, 'shape': (1,), }",
            "{'descr': '<f8', 'shape': (1,), }",
            "(((((",
        ] {
            assert!(of(&npy(header, &[0; 16]), Budget::file()).is_err(), "{header}");
        }
        let whole = npy("{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }", &[0; 16]);
        for end in 0..whole.len() {
            assert!(of(&whole[..end], Budget::file()).is_err(), "{end}");
        }
    }
}
