//! A save that is interrupted by a loss of power, or by a flash that fails.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use shared::link::Refusal;
use shared::link::message::{Reply, Request, UploadKind};
use shared::safety::Power;

use super::rig::{Draws, Memory, Rig};
use super::saving::{from_record, report, save_all, saved, slower};
use super::uploads::upload;

/// An access that changes a flash.
#[derive(Clone, Debug)]
enum Change {
    Erase(u32, u32),
    Write(u32, Vec<u8>),
}

/// A flash that keeps a list of its changes, and refuses further ones at a number of them.
struct Recorded<'f> {
    memory: &'f mut Memory,
    changes: Vec<Change>,
    most: usize,
}

impl Recorded<'_> {
    fn note(&mut self, change: Change) -> Result<(), NorFlashErrorKind> {
        if self.changes.len() >= self.most {
            return Err(NorFlashErrorKind::Other);
        }
        self.changes.push(change);
        Ok(())
    }
}

impl ErrorType for Recorded<'_> {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Recorded<'_> {
    const READ_SIZE: usize = Memory::READ_SIZE;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.memory.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        self.memory.capacity()
    }
}

impl NorFlash for Recorded<'_> {
    const WRITE_SIZE: usize = Memory::WRITE_SIZE;
    const ERASE_SIZE: usize = Memory::ERASE_SIZE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        self.note(Change::Erase(from, to))?;
        self.memory.erase(from, to)
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        for (word, at) in bytes.chunks(Memory::WRITE_SIZE).zip((offset..).step_by(Memory::WRITE_SIZE)) {
            self.note(Change::Write(at, word.to_vec()))?;
        }
        self.memory.write(offset, bytes)
    }
}

/// The flash after some whole changes and a part of the next one: any bits of the word or of the slot have changed.
fn interrupted(before: &Memory, changes: &[Change], whole: usize, draws: &mut Draws) -> Memory {
    let mut flash = before.clone();
    for (number, change) in changes.iter().enumerate().take(whole + 1) {
        let part = number == whole;
        match change {
            Change::Erase(from, to) if part => {
                for byte in &mut flash.bytes_mut()[*from as usize..*to as usize] {
                    *byte |= draws.byte();
                }
            }
            Change::Erase(from, to) => flash.erase(*from, *to).unwrap(),
            Change::Write(at, bytes) if part => {
                for (byte, new) in flash.bytes_mut()[*at as usize..].iter_mut().zip(bytes) {
                    *byte &= new | draws.byte();
                }
            }
            Change::Write(at, bytes) => flash.write(*at, bytes).unwrap(),
        }
    }
    flash
}

/// At each change of the flash during a save by a host: the next start applies the old record, or from the last word on the new one.
#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it")]
fn a_loss_of_power_at_every_step_of_a_save_leaves_the_old_or_the_new_settings() {
    let before = saved(&[20.0, 21.0]);
    let mut after = before.clone();
    let flash = Recorded { memory: &mut after, changes: Vec::new(), most: usize::MAX };
    let mut rig = Rig::with_flash(flash);
    save_all(&mut rig, &slower(22.0));
    let changes = rig.memory.store().flash_mut().changes.clone();
    drop(rig);
    // One erase, settings of more than 400 bytes and two compensations with tables of 73 numbers, in words of 4 bytes.
    assert!(changes.len() > (400 + 2 * 73 * 8) / 4, "{} changes", changes.len());
    let gain_of = |flash: Memory| {
        let mut rig = Rig::with_flash(flash);
        assert_eq!(rig.status().power, Power::Off);
        report(&mut rig)
    };
    let mut draws = Draws(0x0ff);
    for whole in 0..changes.len() {
        let flash = interrupted(&before, &changes, whole, &mut draws);
        let found = gain_of(flash);
        let last = whole + 1 == changes.len();
        assert!(found == from_record(2) || last && found == from_record(3), "{whole}: {found:?}");
    }
    assert_eq!(gain_of(after), from_record(3));
}

/// A flash that fails: the upload is refused and not applied, and the old record stays.
#[test]
fn a_flash_that_fails_is_refused_by_name() {
    let before = saved(&[20.0]);
    for most in [0, 1, 2, 60] {
        let mut memory = before.clone();
        let mut rig = Rig::with_flash(Recorded { memory: &mut memory, changes: Vec::new(), most });
        let refused = Reply::Refused(Refusal::Storage);
        if most == 0 {
            assert_eq!(rig.request(&Request::BeginSave), refused);
        } else {
            assert_eq!(rig.request(&Request::BeginSave), Reply::Done);
            assert_eq!(upload(&mut rig, UploadKind::Settings, &slower(30.0)), refused, "{most}");
            assert_eq!(report(&mut rig), from_record(1));
        }
        assert_eq!(rig.refusal(&Request::Save), Refusal::NothingToSave);
        drop(rig);
        assert_eq!(report(&mut Rig::with_flash(memory)), from_record(1));
    }
}
