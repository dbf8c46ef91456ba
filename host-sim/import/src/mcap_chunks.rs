//! Chunks of an MCAP file that are not packed: a record that is longer than its chunk makes the reader of the crate `mcap` count below zero.

use files::error::InputError;

/// Length of the magic bytes at the begin of a file.
const MAGIC: usize = 8;

/// Kind of a chunk.
const CHUNK: u8 = 6;

/// Bytes of a chunk before the name of its packing: two times, a size, a checksum.
const BEFORE_PACKING: usize = 28;

/// Checks that the records of each chunk that is not packed fit into it. What is broken otherwise, the reader itself refuses.
///
/// # Errors
/// If one does not fit.
pub fn check(bytes: &[u8], source: &str) -> Result<(), InputError> {
    let mut rest = bytes.get(MAGIC..).unwrap_or_default();
    while let Some((kind, data, after)) = record(rest) {
        if kind == CHUNK && records_of(data).is_some_and(|records| !fit(records)) {
            return Err(InputError::expected(
                source,
                "an MCAP file",
                "a record that is longer than its chunk",
            ));
        }
        rest = after;
    }
    Ok(())
}

/// Kind and contents of the first record, and what follows it; `None` if it is not whole.
fn record(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (kind, rest) = bytes.split_first()?;
    let (length, rest) = rest.split_first_chunk()?;
    let (data, after) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    Some((*kind, data, after))
}

/// The records of a chunk, if it is whole and not packed.
fn records_of(chunk: &[u8]) -> Option<&[u8]> {
    let (packing, rest) = chunk.get(BEFORE_PACKING..)?.split_first_chunk()?;
    let (length, rest) = rest.split_first_chunk().filter(|_| u32::from_le_bytes(*packing) == 0)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    // The reader counts from this length, even if there is more or less.
    Some(&rest[..length.min(rest.len())])
}

/// Whether bytes are whole records.
fn fit(mut records: &[u8]) -> bool {
    while !records.is_empty() {
        let Some((_, _, after)) = record(records) else { return false };
        records = after;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record_of(kind: u8, length: u64, data: &[u8]) -> Vec<u8> {
        [&[kind][..], &length.to_le_bytes(), data].concat()
    }

    /// A file with a chunk of this packing, of one record of a byte that claims another length.
    fn file(packing: &[u8], claimed: u64) -> Vec<u8> {
        let records = record_of(5, claimed, b"x");
        let packing = [&u32::try_from(packing.len()).unwrap().to_le_bytes()[..], packing].concat();
        let chunk =
            [&[0; BEFORE_PACKING][..], &packing, &(records.len() as u64).to_le_bytes(), &records].concat();
        [&b"\x89MCAP0\r\n"[..], &record_of(CHUNK, chunk.len() as u64, &chunk), &record_of(15, 20, &[0; 20])]
            .concat()
    }

    #[test]
    fn a_record_that_is_longer_than_its_chunk_is_refused() {
        assert!(check(&file(b"", 1), "a.mcap").is_ok() && check(&file(b"zstd", 2), "a.mcap").is_ok());
        for claimed in [0, 2, u64::MAX] {
            let message = check(&file(b"", claimed), "a.mcap").unwrap_err().to_string();
            assert_eq!(
                message,
                "a.mcap: expected an MCAP file, found a record that is longer than its chunk"
            );
        }
        assert!(check(b"", "a").is_ok() && check(b"\x89MCAP0\r\n\x06", "a").is_ok());
    }

    /// What the fuzzing found: it is refused where arithmetic is checked and where it is not.
    #[test]
    fn the_file_of_the_fuzzing_is_refused() {
        let bytes = include_bytes!("../../../fuzz/seeds/import_binary/mcap_overlong_record");
        let budget = crate::budget::Budget::file();
        assert!(crate::mcap_messages::columns(&bytes[1..], budget, "a", &mut Vec::new()).is_err());
    }
}
