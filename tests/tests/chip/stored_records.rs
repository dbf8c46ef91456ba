//! Records of settings in the flash of either chip, with which its model is tested.

use embedded_storage::nor_flash::NorFlash;
use shared::storage::{StorageError, Store};

/// The messages of a record: two, which together are longer than a write of 32 bytes and no multiple of it.
pub fn messages(number: u8) -> [Vec<u8>; 2] {
    let bytes = |length: u8| (0..length).map(|at| at.wrapping_mul(37) ^ number.wrapping_mul(91)).collect();
    [bytes(45), bytes(20)]
}

/// Saves the messages of a record. Returns its number.
pub fn save(store: &mut Store<impl NorFlash>, number: u8) -> Result<u32, StorageError> {
    let mut writer = store.writer()?;
    messages(number).iter().try_for_each(|message| writer.bytes(store, message))?;
    writer.commit(store)
}

/// The messages of the newest record, if one is valid.
pub fn stored(store: &mut Store<impl NorFlash>) -> Option<[Vec<u8>; 2]> {
    let mut reader = store.newest().ok()?;
    let mut next = || {
        let mut buffer = [0; 64];
        reader.bytes(store, &mut buffer).unwrap().to_vec()
    };
    let read = [next(), next()];
    assert!(reader.is_at_end());
    Some(read)
}
