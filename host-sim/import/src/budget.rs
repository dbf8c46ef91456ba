//! A limit of the unpacked size: a small file can unpack to any size.

use std::io::Read;

use files::error::InputError;

/// Bytes that may still be unpacked.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    limit: u64,
    left: u64,
}

impl Budget {
    /// The limit of a file, unpacked: 512 MiB, which is 64 million numbers of eight bytes.
    #[must_use]
    pub const fn file() -> Self {
        Self::new(1 << 29)
    }

    /// At most `limit` bytes.
    #[must_use]
    pub const fn new(limit: u64) -> Self {
        Self { limit, left: limit }
    }

    /// Reads all of `packed`.
    ///
    /// # Errors
    /// If it has more bytes than are left, or cannot be read.
    pub fn read(&mut self, packed: impl Read, source: &str) -> Result<Vec<u8>, InputError> {
        let mut bytes = Vec::new();
        let read = packed.take(self.left + 1).read_to_end(&mut bytes);
        read.map_err(|cause| InputError::unreadable(source, &cause))?;
        self.spend(bytes.len() as u64, source)?;
        Ok(bytes)
    }

    /// Counts bytes that are unpacked elsewhere.
    ///
    /// # Errors
    /// If they are more than are left.
    pub fn spend(&mut self, bytes: u64, source: &str) -> Result<(), InputError> {
        let Some(left) = self.left.checked_sub(bytes) else {
            let limit = match self.limit >> 20 {
                0 => format!("{} bytes", self.limit),
                mebibytes => format!("{mebibytes} MiB"),
            };
            return Err(InputError::expected(source, format!("at most {limit}, unpacked"), "more"));
        };
        self.left = left;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_than_the_limit_is_read() {
        let mut budget = Budget::new(10);
        assert_eq!(budget.read(&[7; 6][..], "a").unwrap().len(), 6);
        assert_eq!(budget.read(&[7; 4][..], "a").unwrap().len(), 4);
        // Endless: it would never return without the limit.
        let message = budget.read(std::io::repeat(0), "a.npz").unwrap_err().to_string();
        assert_eq!(message, "a.npz: expected at most 10 bytes, unpacked, found more");
        assert!(
            Budget::file().spend(1 << 30, "a").unwrap_err().to_string().contains("at most 512 MiB, unpacked")
        );
    }
}
