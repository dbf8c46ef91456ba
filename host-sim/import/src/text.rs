//! Bytes to text.

use files::error::InputError;

/// The text of a file: UTF-8, UTF-16 with a byte order mark, or else Latin-1, in which instruments write µ and °.
///
/// # Errors
/// If the file is binary.
pub fn decode(bytes: &[u8], source: &str, notes: &mut Vec<String>) -> Result<String, InputError> {
    let utf_16 = |pair: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2).map(|two| pair([two[0], two[1]]));
        char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER)).collect::<String>()
    };
    let text = match bytes {
        [0xff, 0xfe, ..] => utf_16(u16::from_le_bytes),
        [0xfe, 0xff, ..] => utf_16(u16::from_be_bytes),
        _ => {
            if let Ok(text) = std::str::from_utf8(bytes) {
                text.trim_start_matches('\u{feff}').to_owned()
            } else {
                notes.push("the text is read as Latin-1, as it is not UTF-8".to_owned());
                bytes.iter().copied().map(char::from).collect()
            }
        }
    };
    let is_binary = |c: char| c.is_control() && !c.is_whitespace();
    if let Some(found) = text.chars().find(|&c| is_binary(c)) {
        let found = format!("the byte {:#04x}", u32::from(found));
        return Err(InputError::expected(source, "a text", found));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(bytes: &[u8]) -> Result<(String, usize), String> {
        let mut notes = Vec::new();
        let text = decode(bytes, "a", &mut notes).map_err(|error| error.to_string())?;
        Ok((text, notes.len()))
    }

    #[test]
    fn the_encodings_of_instruments_are_read() {
        let expected = ("x µm\n".to_owned(), 0);
        assert_eq!(decoded("x µm\n".as_bytes()).unwrap(), expected);
        assert_eq!(decoded("\u{feff}x µm\n".as_bytes()).unwrap(), expected);
        let utf_16: Vec<u16> = "\u{feff}x µm\n".encode_utf16().collect();
        let [little, big] = [u16::to_le_bytes, u16::to_be_bytes]
            .map(|bytes| utf_16.iter().flat_map(|&unit| bytes(unit)).collect::<Vec<u8>>());
        assert_eq!(decoded(&little).unwrap(), expected);
        assert_eq!(decoded(&big).unwrap(), expected);
        assert_eq!(decoded(b"x \xb5m\n").unwrap(), ("x µm\n".to_owned(), 1));
    }

    #[test]
    fn a_binary_file_is_refused() {
        assert!(decoded(b"MATLAB 5.0\x00\x01").unwrap_err().contains("a text, found the byte 0x00"));
    }
}
