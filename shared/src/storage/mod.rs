//! Settings and compensation in flash, in two slots, so that a loss of power leaves the old or the new content.
//!
//! Each slot is a number of erase blocks. A save erases the slot that does not hold the newest record, writes the content, and
//! at the very end the header, which makes the record valid:
//!
//! | header, 32 bytes, little-endian | |
//! |---|---|
//! | 0 | magic, `LMst` |
//! | 4 | version of format and content ([`VERSION`]), 16 bits, and 16 zero bits |
//! | 8 | identity of the board that the content is for |
//! | 12 | sequence number; of two valid records the greater one is the newer |
//! | 16 | length of the content, bytes |
//! | 20 | CRC-32 (that of Ethernet) of the content |
//! | 24 | zero |
//! | 28 | CRC-32 of bytes 0 to 27 |
//!
//! The content is a sequence of messages, each with its length in 16 bits before it. They are postcard messages, written one
//! after the other ([`Writer::message`]) without a buffer for the whole.
//!
//! The test writes at power loss after every single byte, with the interrupted word and an interrupted erase left in random states.
//! It cannot show cells that were programmed too briefly and read differently from time to time: a board should therefore
//! measure its supply before it saves.
//!
//! # Example
//!
//! ```
//! # use shared::storage::memory::MemoryFlash;
//! use shared::storage::{Slots, Store};
//!
//! // A flash of four blocks of 256 bytes, two for each slot.
//! let flash = MemoryFlash::<1024, 256, 4>::erased();
//! let mut store = Store::new(flash, Slots { starts: [0, 512], length: 512 }, 0x4051).unwrap();
//! let mut writer = store.writer().unwrap();
//! writer.message(&mut store, &[1.5f64, -0.25]).unwrap();
//! writer.commit(&mut store).unwrap();
//!
//! let mut buffer = [0; 64];
//! let mut reader = store.newest().unwrap();
//! let stored: [f64; 2] = reader.message(&mut store, &mut buffer).unwrap();
//! assert_eq!(stored, [1.5, -0.25]);
//! ```

mod error;
mod header;
pub mod memory;
mod reader;
mod store;
#[cfg(test)]
mod tests;
mod writer;

pub use error::{SlotError, StorageError};
pub use header::VERSION;
pub use reader::Reader;
pub use store::{Slots, Store};
pub use writer::Writer;
