//! Why a record was not read or written.

/// Why the record of a slot is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SlotError {
    /// The slot is erased.
    Empty,
    /// The slot holds something else, or the start of a record that was interrupted.
    NoRecord,
    /// The record has another version of format and content.
    Version(u16),
    /// The record is for a board with this identity.
    OtherBoard(u32),
    /// Header or content have another checksum: the flash has lost bits, or the write was interrupted.
    Checksum,
    /// The flash could not be read.
    Unreadable,
}

impl core::fmt::Display for SlotError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Empty => write!(f, "nothing is stored"),
            Self::NoRecord => write!(f, "not a record"),
            Self::Version(version) => write!(f, "version {version} is not known"),
            Self::OtherBoard(board) => write!(f, "stored for another board ({board:#x})"),
            Self::Checksum => write!(f, "the checksum differs"),
            Self::Unreadable => write!(f, "the flash could not be read"),
        }
    }
}

/// Why content was not loaded or saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StorageError {
    /// The slots overlap, are not aligned to erase blocks, are too small for a header, or exceed the flash.
    Layout,
    /// No slot has a valid record: the reason for each.
    NoRecord([SlotError; 2]),
    /// The content is longer than a slot.
    TooLong,
    /// A message is longer than 65,535 bytes or than the buffer that it is read to.
    MessageTooLong,
    /// There is no further message.
    NoMessage,
    /// The bytes of a message are not the expected one.
    Message,
    /// The flash reports an error of erasing, writing or reading.
    Flash,
    /// The record that was written does not read back as valid.
    Verification(SlotError),
}

impl core::fmt::Display for StorageError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Layout => write!(f, "the slots do not fit the flash"),
            Self::NoRecord([first, second]) => write!(f, "first slot: {first}; second slot: {second}"),
            Self::TooLong => write!(f, "the content is longer than a slot"),
            Self::MessageTooLong => write!(f, "a message is too long"),
            Self::NoMessage => write!(f, "no further message is stored"),
            Self::Message => write!(f, "a stored message has another type"),
            Self::Flash => write!(f, "the flash reports an error"),
            Self::Verification(error) => write!(f, "what was written does not read back: {error}"),
        }
    }
}

impl core::error::Error for StorageError {}
