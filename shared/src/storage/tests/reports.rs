//! What is reported: a record that was not replaced, and the texts of the errors.

use super::*;

/// A flash that is protected from some time on: it takes erasing and writing without an error, and keeps what it has.
struct Protected(Memory<4>);

impl ErrorType for Protected {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Protected {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.0.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl NorFlash for Protected {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 256;

    fn erase(&mut self, _: u32, _: u32) -> Result<(), NorFlashErrorKind> {
        Ok(())
    }

    fn write(&mut self, _: u32, _: &[u8]) -> Result<(), NorFlashErrorKind> {
        Ok(())
    }
}

/// A valid record that is not the one that was written: the old one of the slot, which the flash has kept.
#[test]
fn an_old_record_that_was_not_replaced_is_no_success() {
    let mut memory = Memory::<4>::erased();
    for content in [1, 2] {
        save(&mut memory, &[std::vec![content; 20]]).unwrap();
    }
    let saved = save(Protected(memory), &[std::vec![3; 20]]);
    assert_eq!(saved, Err(StorageError::Verification(SlotError::Checksum)));
}

#[test]
fn the_messages_say_what_was_found() {
    use std::string::ToString;
    let slots = [
        (SlotError::Empty, "nothing"),
        (SlotError::NoRecord, "not a record"),
        (SlotError::Version(7), "version 7"),
        (SlotError::OtherBoard(0xabc), "0xabc"),
        (SlotError::Checksum, "checksum"),
        (SlotError::Unreadable, "read"),
    ];
    for (error, words) in slots {
        assert!(error.to_string().contains(words), "{error}");
        let both = StorageError::NoRecord([SlotError::Empty, error]).to_string();
        assert!(both.contains("nothing") && both.contains(words), "{both}");
        let verification = StorageError::Verification(error).to_string();
        assert!(verification.contains(words) && verification.contains("read back"), "{verification}");
    }
    for (error, words) in [
        (StorageError::Layout, "slots"),
        (StorageError::TooLong, "longer"),
        (StorageError::MessageTooLong, "message is too long"),
        (StorageError::NoMessage, "no further message"),
        (StorageError::Message, "another type"),
        (StorageError::Flash, "flash"),
    ] {
        assert!(error.to_string().contains(words), "{error}");
    }
    let writer = Store::new(Memory::<4>::erased(), SLOTS, BOARD).unwrap().writer().unwrap();
    assert!(std::format!("{writer:?}").contains("slot: 0, length: 0"), "{writer:?}");
}
