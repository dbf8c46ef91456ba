//! MAT-files of level 5, which MATLAB writes with `-v6` and `-v7`, SciPy and Octave too.
//!
//! Our own reader: of the crates that read this format, one has no limit of what it unpacks, prints errors to stderr and multiplies
//! dimensions unchecked (`matfile` 0.5), another a single release (`mat5` 0.1), and one needs a library of C (`matio-rs`).
//!
//! Source: The MathWorks, "MAT-File Format", 2019, chapter 1. Read are full real arrays of numbers; other variables are told by name.

use files::error::{InputError, quoted};
use flate2::read::ZlibDecoder;

use crate::arrays::Array;
use crate::budget::Budget;
use crate::numbers::{Kind, Layout};

/// Length of the header of a file, bytes.
const HEADER: usize = 128;

/// Types of elements.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Flag of an array with an imaginary part.
const COMPLEX: u32 = 0x800;

/// Reads the arrays of a file.
///
/// # Errors
/// If it is no MAT-file of level 5, ends too early, or unpacks to more than `budget`.
pub fn arrays(
    bytes: &[u8],
    mut budget: Budget,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<Array>, InputError> {
    let expected = |found: &str| InputError::expected(source, "a MAT-file of level 5", found);
    let Some((header, rest)) = bytes.split_at_checked(HEADER) else { return Err(expected("a short file")) };
    let is_little = match &header[126..] {
        b"IM" => true,
        b"MI" => false,
        _ => return Err(expected("no mark of byte order")),
    };
    let version = Layout { kind: Kind::Unsigned, size: 2, is_little }.number(&header[124..126]);
    if version.to_bits() != 256f64.to_bits() {
        return Err(expected("another version: save with -v7, as -v7.3 is another format (HDF5)"));
    }
    let mut elements = Elements { bytes: rest, is_little, is_packed: true };
    let mut arrays = Vec::new();
    while !elements.bytes.is_empty() {
        let broken = || InputError::expected(source, "a whole MAT-file", "an element that is cut off");
        let (kind, content) = elements.next().ok_or_else(broken)?;
        let unpacked;
        let content = match kind {
            COMPRESSED => {
                unpacked = budget.read(ZlibDecoder::new(content), source)?;
                let mut inner = Elements { bytes: &unpacked, is_little, is_packed: false };
                match inner.next().ok_or_else(broken)? {
                    (MATRIX, content) => content,
                    _ => continue,
                }
            }
            MATRIX => content,
            _ => continue,
        };
        match variable(content, is_little).ok_or_else(broken)? {
            Variable::Array(array) => arrays.push(array),
            Variable::Other(name, what) => notes.push(format!("not read: {}, {what}", quoted(&name))),
        }
    }
    Ok(arrays)
}

/// A variable of a file.
enum Variable {
    Array(Array),
    /// Name, and what it is instead.
    Other(String, &'static str),
}

/// A variable from the content of its element; `None` if it is cut off, or contradicts itself.
fn variable(content: &[u8], is_little: bool) -> Option<Variable> {
    let mut elements = Elements { bytes: content, is_little, is_packed: false };
    let (UINT32, flags) = elements.next()? else { return None };
    let flags = word(flags, is_little)?;
    let class = flags & 0xff;
    // An object of a class has another order of elements.
    let (INT32, shape) = elements.next()? else { return Some(Variable::Other(String::new(), "an object")) };
    let (INT8, name) = elements.next()? else { return None };
    let name: String = name.iter().copied().map(char::from).collect();
    let what = match class {
        6..=15 if flags & COMPLEX != 0 => "complex numbers",
        6..=15 => {
            let sizes = Layout { kind: Kind::Signed, size: 4, is_little }.numbers(shape);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "32 bits, not below zero"
            )]
            let shape: Vec<usize> = sizes.into_iter().map(|size| size.max(0.0) as usize).collect();
            let count = shape.iter().try_fold(1usize, |count, &length| count.checked_mul(length))?;
            // An empty array may lack its element.
            let values = if count == 0 { Vec::new() } else { elements.numbers()? };
            let array = Array { name, shape, is_column_major: true, values };
            return (array.values.len() == count).then_some(Variable::Array(array));
        }
        1 => "a cell array",
        2 => "a structure",
        4 => "a text",
        5 => "a sparse matrix",
        _ => "an object",
    };
    Some(Variable::Other(name, what))
}

/// Elements one after the other.
struct Elements<'a> {
    bytes: &'a [u8],
    is_little: bool,
    /// Whether compressed elements may be among them, which have no padding.
    is_packed: bool,
}

impl<'a> Elements<'a> {
    /// Type and content of the next element.
    fn next(&mut self) -> Option<(u32, &'a [u8])> {
        let first = word(self.bytes, self.is_little)?;
        // A small element has its length beside its type, and up to four bytes of content.
        if first >> 16 != 0 {
            let (content, rest) = self.bytes.get(4..)?.split_at_checked(4)?;
            self.bytes = rest;
            return Some((first & 0xffff, content.get(..usize::try_from(first >> 16).ok()?)?));
        }
        let length = usize::try_from(word(self.bytes.get(4..)?, self.is_little)?).ok()?;
        let (content, rest) = self.bytes.get(8..)?.split_at_checked(length)?;
        let padding = if self.is_packed && first == COMPRESSED { 0 } else { length.wrapping_neg() % 8 };
        // The last element of a file may lack its padding.
        self.bytes = rest.get(padding..).unwrap_or_default();
        Some((first, content))
    }

    /// The numbers of the next element. MATLAB stores whole numbers in the smallest type that holds them.
    fn numbers(&mut self) -> Option<Vec<f64>> {
        let (kind, content) = self.next()?;
        let (kind, size) = match kind {
            INT8 => (Kind::Signed, 1),
            2 => (Kind::Unsigned, 1),
            3 => (Kind::Signed, 2),
            4 => (Kind::Unsigned, 2),
            INT32 => (Kind::Signed, 4),
            UINT32 => (Kind::Unsigned, 4),
            7 => (Kind::Float, 4),
            9 => (Kind::Float, 8),
            12 => (Kind::Signed, 8),
            13 => (Kind::Unsigned, 8),
            _ => return None,
        };
        Some(Layout { kind, size, is_little: self.is_little }.numbers(content))
    }
}

/// The first four bytes as a number.
fn word(bytes: &[u8], is_little: bool) -> Option<u32> {
    let word = *bytes.first_chunk()?;
    Some(if is_little { u32::from_le_bytes(word) } else { u32::from_be_bytes(word) })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::ZlibEncoder};

    use super::*;

    /// An element with padding, after the description of the format.
    fn element(kind: u32, content: &[u8]) -> Vec<u8> {
        let mut bytes = [kind.to_le_bytes(), u32::try_from(content.len()).unwrap().to_le_bytes()].concat();
        bytes.extend(content);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    /// A variable of doubles, stored as `kind` with these bytes.
    fn matrix(name: &str, [rows, columns]: [i32; 2], class: u32, kind: u32, content: &[u8]) -> Vec<u8> {
        let flags = [class.to_le_bytes(), [0; 4]].concat();
        let shape = [rows.to_le_bytes(), columns.to_le_bytes()].concat();
        let parts = [
            element(UINT32, &flags),
            element(INT32, &shape),
            element(INT8, name.as_bytes()),
            element(kind, content),
        ];
        element(MATRIX, &parts.concat())
    }

    fn packed(element: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(element).unwrap();
        let content = encoder.finish().unwrap();
        let mut bytes =
            [COMPRESSED.to_le_bytes(), u32::try_from(content.len()).unwrap().to_le_bytes()].concat();
        bytes.extend(content);
        bytes
    }

    fn file(elements: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = format!("{:124}", "MATLAB 5.0 MAT-file").into_bytes();
        bytes.extend(b"\x00\x01IM");
        bytes.extend(elements.concat());
        bytes
    }

    fn read(bytes: &[u8], budget: Budget) -> Result<(Vec<Array>, Vec<String>), String> {
        let mut notes = Vec::new();
        let arrays = arrays(bytes, budget, "a.mat", &mut notes).map_err(|error| error.to_string())?;
        Ok((arrays, notes))
    }

    fn doubles(values: &[f64]) -> Vec<u8> {
        values.iter().flat_map(|value| value.to_le_bytes()).collect()
    }

    #[test]
    fn packed_and_plain_variables_are_read() {
        let v = matrix("velocity", [3, 1], 6, 9, &doubles(&[0.5, -0.25, 1e300]));
        // Whole numbers of class double, stored as int16; the name is a small element in files of MATLAB.
        let n = matrix("n", [1, 2], 6, 3, &[0xfe, 0xff, 7, 0]);
        let text = matrix("remark", [1, 2], 4, 16, b"ab");
        let (arrays, notes) = read(&file(&[packed(&v), n, packed(&text)]), Budget::file()).unwrap();
        let found: Vec<_> =
            arrays.iter().map(|array| (array.name.as_str(), &array.values[..], &array.shape[..])).collect();
        assert_eq!(
            found,
            [("velocity", &[0.5, -0.25, 1e300][..], &[3, 1][..]), ("n", &[-2.0, 7.0], &[1, 2])]
        );
        assert_eq!(notes, ["not read: \"remark\", a text"]);
    }

    #[test]
    fn the_unpacked_size_is_limited() {
        let bytes = file(&[packed(&matrix("zeros", [100_000, 1], 6, 9, &vec![0; 800_000]))]);
        assert!(bytes.len() < 2000, "{}", bytes.len());
        let message = read(&bytes, Budget::new(1 << 19)).unwrap_err();
        assert!(message.contains("at most 524288 bytes, unpacked, found more"), "{message}");
        assert!(read(&bytes, Budget::new(1 << 20)).is_ok());
    }

    #[test]
    fn other_versions_and_broken_files_are_refused() {
        let bytes = file(&[matrix("v", [3, 1], 6, 9, &doubles(&[1.0, 2.0, 3.0]))]);
        let mut hdf5 = bytes.clone();
        hdf5[125] = 2;
        assert!(read(&hdf5, Budget::file()).unwrap_err().contains("save with -v7"));
        for end in HEADER + 1..bytes.len() {
            assert!(read(&bytes[..end], Budget::file()).unwrap_err().contains("a whole MAT-file"), "{end}");
        }
        // More values than there are.
        let lies = file(&[matrix("v", [i32::MAX, i32::MAX], 6, 9, &doubles(&[1.0]))]);
        assert!(read(&lies, Budget::file()).is_err());
    }
}
