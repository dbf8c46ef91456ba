//! Loss of power at every byte, and records that are refused.

extern crate std;

mod reports;

use std::vec::Vec;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use proptest::prelude::*;

use super::memory::MemoryFlash;
use super::*;

const SIZE: usize = 1024;
const SLOTS: Slots = Slots { starts: [0, 512], length: 512 };
const BOARD: u32 = 0x4051_0002;

type Memory<const WORD: usize> = MemoryFlash<SIZE, 256, WORD>;

/// A flash that loses its power after a number of bytes. The word that is being written is left with some of its bits
/// programmed, an erase block that is being erased with some of its bits erased.
#[derive(Clone)]
struct Failing<const WORD: usize> {
    memory: Memory<WORD>,
    bytes_left: usize,
    written: usize,
    random: u64,
}

impl<const WORD: usize> Failing<WORD> {
    fn new(memory: &Memory<WORD>, bytes_left: usize, random: u64) -> Self {
        Self { memory: memory.clone(), bytes_left, written: 0, random: random | 1 }
    }

    fn random_byte(&mut self) -> u8 {
        // xorshift64
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random.to_le_bytes()[3]
    }

    /// Whether the power lasts for another byte.
    fn step(&mut self) -> bool {
        self.written += 1;
        let lasts = self.bytes_left > 0;
        self.bytes_left = self.bytes_left.saturating_sub(1);
        lasts
    }
}

impl<const WORD: usize> ErrorType for Failing<WORD> {
    type Error = NorFlashErrorKind;
}

impl<const WORD: usize> ReadNorFlash for Failing<WORD> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.memory.read(offset, bytes)
    }

    fn capacity(&self) -> usize {
        SIZE
    }
}

impl<const WORD: usize> NorFlash for Failing<WORD> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = 256;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        // In the order of a shuffled sequence: 257 has no factor in common with the length of a slot.
        let length = (to - from) as usize;
        for k in 0..length {
            let at = from as usize + k * 257 % length;
            if !self.step() {
                for at in from as usize..to as usize {
                    let random = self.random_byte();
                    self.memory.bytes_mut()[at] |= random;
                }
                return Err(NorFlashErrorKind::Other);
            }
            self.memory.bytes_mut()[at] = 0xff;
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        for (k, word) in bytes.chunks(WORD).enumerate() {
            let at = offset as usize + k * WORD;
            for byte in 0..word.len() {
                if !self.step() {
                    for (wanted, at) in word.iter().zip(at..).take(byte + 1) {
                        let random = self.random_byte();
                        self.memory.bytes_mut()[at] &= wanted | random;
                    }
                    return Err(NorFlashErrorKind::Other);
                }
            }
            self.memory.write(u32::try_from(at).unwrap(), word)?;
        }
        Ok(())
    }
}

fn save<F: NorFlash>(flash: F, content: &[Vec<u8>]) -> Result<(), StorageError> {
    let mut store = Store::new(flash, SLOTS, BOARD).unwrap();
    let mut writer = store.writer()?;
    for message in content {
        writer.bytes(&mut store, message)?;
    }
    writer.commit(&mut store).map(drop)
}

fn load<F: NorFlash>(flash: F) -> Result<Vec<Vec<u8>>, StorageError> {
    let mut store = Store::new(flash, SLOTS, BOARD).unwrap();
    let mut reader = store.newest()?;
    let mut content = Vec::new();
    let mut buffer = [0; SIZE];
    while !reader.is_at_end() {
        content.push(reader.bytes(&mut store, &mut buffer)?.to_vec());
    }
    Ok(content)
}

/// Messages whose bytes tell which save they belong to.
fn content(save: u8, lengths: &[usize]) -> Vec<Vec<u8>> {
    lengths
        .iter()
        .map(|length| (0..*length).map(|k| save.wrapping_mul(37) ^ k.to_le_bytes()[0]).collect())
        .collect()
}

/// At each byte of a save the old content is read, or from the last byte of the header on the new one. After the loss a further
/// save succeeds, and a second loss during that one leaves the same guarantee.
fn survives_a_loss_at_every_byte<const WORD: usize>(seed: u64) {
    let mut before = Memory::<WORD>::erased();
    for number in 0..3 {
        save(&mut before, &content(number, &[5, 90, 0, 33])).unwrap();
    }
    let (old, new, third) = (content(2, &[5, 90, 0, 33]), content(9, &[120, 7, 64]), content(11, &[200]));
    let mut complete = Failing::new(&before, usize::MAX, seed);
    save(&mut complete, &new).unwrap();
    let total = complete.written;
    // 512 bytes of erasing, the content of 197 bytes in words, and 32 of the header.
    assert!((512 + 197 + 32..512 + 197 + 32 + 32).contains(&total), "{total} bytes");
    for bytes_left in 0..total {
        let mut flash = Failing::new(&before, bytes_left, seed.wrapping_add(bytes_left as u64));
        assert_eq!(save(&mut flash, &new), Err(StorageError::Flash), "loss at byte {bytes_left}");
        let mut after = flash.memory;
        // The last byte of the header may be one that an erased or torn word has already.
        let is_complete = bytes_left + 1 == total && after.bytes_mut() == complete.memory.bytes_mut();
        let expected = if is_complete { &new } else { &old };
        assert_eq!(load(&mut after).as_ref(), Ok(expected), "loss at byte {bytes_left}");
        // A second loss during the next save, here after every 41st byte.
        for bytes_left in (0..512 + 200 + 34).step_by(41) {
            let mut flash = Failing::new(&after, bytes_left, seed ^ bytes_left as u64);
            assert_eq!(save(&mut flash, &third), Err(StorageError::Flash));
            assert_eq!(load(&mut flash.memory).as_ref(), Ok(expected));
        }
        save(&mut after, &third).unwrap();
        assert_eq!(load(&mut after), Ok(third.clone()));
    }
    assert_eq!(load(&mut complete.memory), Ok(new));
}

#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it")]
fn a_loss_of_power_at_every_byte_leaves_the_old_or_the_new_content() {
    for seed in [1, 0x1234_5678, 0xdead_beef] {
        survives_a_loss_at_every_byte::<1>(seed);
        survives_a_loss_at_every_byte::<4>(seed);
        survives_a_loss_at_every_byte::<8>(seed);
    }
}

/// The first save ever, interrupted anywhere, leaves nothing, and never a part.
#[test]
fn an_interrupted_first_save_leaves_nothing() {
    let empty = Memory::<4>::erased();
    for bytes_left in 0..512 + 12 + 32 {
        let mut flash = Failing::new(&empty, bytes_left, 7);
        assert_eq!(save(&mut flash, &content(1, &[10])), Err(StorageError::Flash), "{bytes_left}");
        let loaded = load(&mut flash.memory);
        assert!(matches!(loaded, Err(StorageError::NoRecord(_))), "{bytes_left}: {loaded:?}");
    }
}

/// Any single bit of a slot that flips makes its record invalid, by name, and the other slot is used.
#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it")]
fn a_flipped_bit_is_noticed() {
    let mut memory = Memory::<1>::erased();
    save(&mut memory, &content(1, &[20])).unwrap();
    save(&mut memory, &content(2, &[20])).unwrap();
    for bit in 0..8 * (32 + 22) {
        let mut flash = memory.clone();
        flash.bytes_mut()[512 + bit / 8] ^= 1 << (bit % 8);
        let mut store = Store::new(&mut flash, SLOTS, BOARD).unwrap();
        let [first, second] = store.refused();
        assert_eq!(first, None);
        let expected = if bit < 32 { SlotError::NoRecord } else { SlotError::Checksum };
        assert_eq!(second, Some(expected), "bit {bit}");
        assert_eq!(load(&mut flash), Ok(content(1, &[20])), "bit {bit}");
    }
}

/// A record whose header has another version, and a right checksum.
fn with_version(version: u16) -> Memory<1> {
    let mut memory = Memory::<1>::erased();
    save(&mut memory, &content(1, &[20])).unwrap();
    let bytes = memory.bytes_mut();
    bytes[4..6].copy_from_slice(&version.to_le_bytes());
    let crc = header::CRC.checksum(&bytes[..28]).to_le_bytes();
    bytes[28..32].copy_from_slice(&crc);
    memory
}

#[test]
fn records_that_do_not_belong_here_are_refused_by_name() {
    let refused = |mut memory: Memory<1>, board| {
        let mut store = Store::new(&mut memory, SLOTS, board).unwrap();
        store.newest().err()
    };
    let reason = |reason| Some(StorageError::NoRecord([reason, SlotError::Empty]));
    assert_eq!(refused(with_version(VERSION), BOARD), None);
    assert_eq!(refused(with_version(VERSION + 1), BOARD), reason(SlotError::Version(VERSION + 1)));
    assert_eq!(refused(with_version(0), BOARD), reason(SlotError::Version(0)));
    assert_eq!(refused(with_version(VERSION), BOARD + 1), reason(SlotError::OtherBoard(BOARD)));
    assert_eq!(refused(Memory::erased(), BOARD), reason(SlotError::Empty));
    let mut foreign = Memory::erased();
    foreign.bytes_mut()[..4].copy_from_slice(b"\x7fELF");
    assert_eq!(refused(foreign, BOARD), reason(SlotError::NoRecord));
}

#[test]
fn the_sequence_number_wraps() {
    let mut memory = Memory::<1>::erased();
    save(&mut memory, &content(1, &[20])).unwrap();
    let bytes = memory.bytes_mut();
    bytes[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    let crc = header::CRC.checksum(&bytes[..28]).to_le_bytes();
    bytes[28..32].copy_from_slice(&crc);
    for number in 2..6 {
        save(&mut memory, &content(number, &[20])).unwrap();
        assert_eq!(load(&mut memory), Ok(content(number, &[20])));
        let mut store = Store::new(&mut memory, SLOTS, BOARD).unwrap();
        assert_eq!(store.newest().unwrap().sequence(), u32::from(number) - 2);
    }
}

#[test]
fn slots_that_do_not_fit_are_refused() {
    let refused = |starts, length| {
        let slots = Slots { starts, length };
        Store::new(Memory::<4>::erased(), slots, BOARD).err() == Some(StorageError::Layout)
    };
    assert!(!refused([0, 512], 512) && !refused([768, 0], 256));
    assert!(refused([0, 256], 512) && refused([0, 0], 256), "they overlap");
    assert!(refused([0, 768], 512) && refused([0, u32::MAX - 255], 256), "beyond the end");
    assert!(refused([0, 300], 256) && refused([128, 512], 256) && refused([0, 512], 300), "not aligned");
    assert!(refused([0, 512], 0), "no room for the header");
    let large_words = Store::new(MemoryFlash::<1024, 256, 64>::erased(), SLOTS, BOARD).err();
    assert_eq!(large_words, Some(StorageError::Layout));
}

/// The longest content fills a slot to the last byte; one more is refused, and the old record stays.
#[test]
fn content_that_is_too_long_is_refused() {
    let mut memory = Memory::<4>::erased();
    save(&mut memory, &content(1, &[20])).unwrap();
    assert_eq!(save(&mut memory, &content(2, &[512 - 32 - 2 + 1])), Err(StorageError::TooLong));
    assert_eq!(load(&mut memory), Ok(content(1, &[20])));
    save(&mut memory, &content(3, &[512 - 32 - 2])).unwrap();
    assert_eq!(load(&mut memory), Ok(content(3, &[512 - 32 - 2])));
}

#[test]
fn a_message_of_another_type_is_refused() {
    let mut store = Store::new(Memory::<4>::erased(), SLOTS, BOARD).unwrap();
    let mut writer = store.writer().unwrap();
    writer.message(&mut store, &(7u32, "name")).unwrap();
    writer.message(&mut store, &[0.5f32; 3]).unwrap();
    writer.commit(&mut store).unwrap();
    let mut reader = store.newest().unwrap();
    let (mut small, mut buffer) = ([0; 3], [0; 64]);
    assert_eq!(reader.bytes(&mut store, &mut small), Err(StorageError::MessageTooLong));
    assert_eq!(reader.message::<(u32, &str), _>(&mut store, &mut buffer), Ok((7, "name")));
    let mut again = reader;
    assert_eq!(again.message::<[f32; 2], _>(&mut store, &mut buffer), Err(StorageError::Message));
    assert_eq!(reader.message::<[f32; 3], _>(&mut store, &mut buffer), Ok([0.5; 3]));
    assert_eq!(reader.message::<u8, _>(&mut store, &mut buffer), Err(StorageError::NoMessage));
}

proptest! {
    /// Whatever the flash contains, loading ends without a panic, and accepts nothing.
    #[test]
    fn any_bytes_are_refused(seed: u64) {
        let mut flash = Failing::new(&Memory::<1>::erased(), 0, seed);
        for at in 0..SIZE {
            let random = flash.random_byte();
            flash.memory.bytes_mut()[at] = random;
        }
        prop_assert!(load(&mut flash).is_err());
        // Also with the right first word.
        for start in [0, 512] {
            flash.memory.bytes_mut()[start..start + 4].copy_from_slice(b"LMst");
        }
        prop_assert_eq!(load(&mut flash), Err(StorageError::NoRecord([SlotError::Checksum; 2])));
    }
}

/// The stored types have the bytes that they had when [`VERSION`] was set. If this fails, a stored type has changed: raise the
/// version, so that old records are refused instead of misread, and then the checksum here.
#[test]
fn the_version_is_that_of_the_stored_types() {
    use crate::compensate::CompensationSettings;
    use crate::compensate::settings::{Cycle, ForceModel, Reversal};
    use crate::config::{
        AxisSettings, GainSchedule, GantrySettings, Notch, Notches, Rates, ScaleLimits, SchedulePoint,
        ScheduledOver, Sensors, VelocitySource,
    };
    use crate::link::message::{BoardSettings, UploadKind};
    let axis = AxisSettings {
        sensors: Sensors::Dual { time_constant_s: 0.25, limits: ScaleLimits::DEFAULT },
        notches: Notches([Some(Notch { frequency_hz: 300.0, width_hz: 60.0, depth: 0.5 }), None, None, None]),
        gain_schedule: GainSchedule::of(
            ScheduledOver::Speed,
            [SchedulePoint { at: 0.0, ratio: 2.0 }, SchedulePoint { at: 0.25, ratio: 1.0 }],
        ),
        velocity_source: VelocitySource::Observer { bandwidth_hz: 300.0 },
        travel_m: Some([-0.125, 0.5]),
        gantry: Some(GantrySettings { first: 1, skew_limit_m: 0.25, reference_offset_m: -0.5 }),
        ..AxisSettings::default()
    };
    let compensation = CompensationSettings {
        screw: [Cycle { period_m: 0.0625, values: [0.5, -0.5].into_iter().collect() }].into_iter().collect(),
        reversal: Some(Reversal { force_n: 2.0, decay_s: 0.5, fade_m_per_s: 0.25 }),
        force: Some(ForceModel::default()),
        ..CompensationSettings::default()
    };
    let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
    let mut store =
        Store::new(MemoryFlash::<4096, 2048, 4>::erased(), Slots { starts: [0, 2048], length: 2048 }, BOARD)
            .unwrap();
    let mut writer = store.writer().unwrap();
    writer.message(&mut store, &rates).unwrap();
    writer.message(&mut store, &axis).unwrap();
    writer.message(&mut store, &compensation).unwrap();
    writer.message(&mut store, &BoardSettings { rates, axes: [axis] }).unwrap();
    for kind in [UploadKind::Settings, UploadKind::Compensation { axis: 1 }] {
        writer.message(&mut store, &kind).unwrap();
    }
    writer.commit(&mut store).unwrap();
    let (mut reader, mut buffer) = (store.newest().unwrap(), [0; 2048]);
    assert_eq!(reader.message::<Rates, _>(&mut store, &mut buffer), Ok(rates));
    assert_eq!(reader.message::<AxisSettings, _>(&mut store, &mut buffer), Ok(axis));
    assert_eq!(reader.message::<CompensationSettings, _>(&mut store, &mut buffer), Ok(compensation));
    let header = &store.flash.bytes_mut()[..32];
    let checksum = u32::from_le_bytes([header[20], header[21], header[22], header[23]]);
    assert_eq!((VERSION, checksum), (8, 0x4b30_bc42));
}
