//! The flash interface of an STM32G474 with two banks, by the reference manual RM0440, chapter 3: keys, lock, pages, double words with their
//! check bits, errors, the data cache, the bank that cannot be read; and the supply, which may fail at any write.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Chapter 3: two banks of 128 pages of 2 KiB. The program is in the first one, and in the first half of the second.
const BANK: u32 = 0x4_0000;
const PAGE: u32 = 0x800;
const FIRST: u32 = 0x6_0000;
const END: u32 = 0x8_0000;

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
pub const LOCKED: u32 = 1 << 31;
const BUSY_READS: u32 = 3;
const BSY: u32 = 1 << 16;
const PROGERR: u32 = 1 << 3;
const PGAERR: u32 = 1 << 5;
const PGSERR: u32 = 1 << 7;

pub struct FlashModel {
    memory: Vec<u8>,
    /// Double words whose check bits do not fit.
    pub damaged: BTreeSet<u32>,
    /// Double words that were programmed since their erase: another time is an error.
    programmed: BTreeSet<u32>,
    cache: RefCell<BTreeMap<u32, [u8; 8]>>,
    cache_is_on: bool,
    cr: u32,
    sr: u32,
    eccr: Cell<u32>,
    keys: usize,
    busy: Cell<u32>,
    /// The lower half of a double word.
    half: Option<(u32, u32)>,
    /// An error that the next operation has.
    pub next_error: u32,
    pub defect: Defect,
    /// Whether a lock holds off the ticks.
    pub ticks_are_held_off: bool,
    pub writes: usize,
    fails_at: usize,
    pub erased_pages: Vec<u32>,
    random: ChaCha8Rng,
}

/// What is wrong with the flash.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Defect {
    None,
    /// The keys do not unlock.
    Jammed,
    /// An operation does not end.
    NeverEnds,
}

/// What remains without a supply.
#[derive(Clone)]
pub struct Remains {
    pub memory: Vec<u8>,
    damaged: BTreeSet<u32>,
}

impl Remains {
    pub fn erased() -> Self {
        Self { memory: vec![0xff; (END - FIRST) as usize], damaged: BTreeSet::new() }
    }

    pub fn filled(byte: u8) -> Self {
        Self { memory: vec![byte; (END - FIRST) as usize], damaged: BTreeSet::new() }
    }
}

impl FlashModel {
    pub fn new(remains: Remains, fails_at: usize, seed: u64) -> Self {
        Self {
            programmed: (FIRST..END)
                .step_by(8)
                .filter(|at| {
                    let from = (at - FIRST) as usize;
                    remains.memory[from..from + 8] != [0xff; 8]
                })
                .collect(),
            memory: remains.memory,
            damaged: remains.damaged,
            cache: RefCell::default(),
            cache_is_on: true,
            cr: LOCKED,
            sr: 0,
            eccr: Cell::new(0),
            keys: 0,
            busy: Cell::new(0),
            half: None,
            next_error: 0,
            defect: Defect::None,
            ticks_are_held_off: false,
            writes: 0,
            fails_at,
            erased_pages: Vec::new(),
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    pub fn remains(&self) -> Remains {
        Remains { memory: self.memory.clone(), damaged: self.damaged.clone() }
    }

    /// A double word of the program cannot be corrected.
    pub fn damage_program(&self) {
        self.eccr.set(1 << 31);
    }

    pub const fn control(&self) -> u32 {
        self.cr
    }

    const fn has_failed(&self) -> bool {
        self.writes > self.fails_at
    }

    fn begin_write(&mut self) -> Option<bool> {
        if self.has_failed() {
            return None;
        }
        assert_eq!(self.busy.get(), 0, "a write during an operation");
        self.writes += 1;
        Some(self.has_failed())
    }

    fn begin_operation(&mut self) {
        assert_eq!(
            self.sr, 0,
            "chapter 3: an error that is not cleared keeps the next operation from starting"
        );
        assert!(!self.ticks_are_held_off, "the ticks would wait for the end of the operation");
        self.busy.set(if self.defect == Defect::NeverEnds { u32::MAX } else { BUSY_READS });
        self.sr |= std::mem::take(&mut self.next_error);
    }

    pub fn set_access_control(&mut self, value: u32) {
        assert!(
            value & 1 << 12 == 0 || value & 1 << 10 == 0,
            "chapter 3: a reset of the data cache that is on"
        );
        if value & 1 << 12 != 0 {
            self.cache.borrow_mut().clear();
        }
        self.cache_is_on = value & 1 << 10 != 0;
    }

    pub fn register(&self, offset: u32) -> u32 {
        match offset {
            0x10 => {
                let busy = self.busy.get();
                self.busy.set(busy.saturating_sub(u32::from(self.defect != Defect::NeverEnds)));
                self.sr | if busy > 0 && !self.has_failed() { BSY } else { 0 }
            }
            0x14 => self.cr,
            0x18 => self.eccr.get(),
            _ => panic!("{offset:#x} cannot be read"),
        }
    }

    pub fn set_register(&mut self, offset: u32, value: u32) {
        let Some(fails) = self.begin_write() else { return };
        match offset {
            0x08 => {
                assert_eq!(KEYS.get(self.keys), Some(&value), "a wrong key locks the flash until a reset");
                self.keys += 1;
                if self.keys == KEYS.len() && self.defect != Defect::Jammed {
                    self.cr &= !LOCKED;
                }
            }
            0x10 => self.sr &= !value,
            0x14 => self.set_control(value, fails),
            0x18 => self.eccr.set(self.eccr.get() & !(value & 1 << 31)),
            _ => panic!("{offset:#x} is not to be written"),
        }
    }

    fn set_control(&mut self, value: u32, fails: bool) {
        if self.cr & LOCKED != 0 {
            assert!(self.defect == Defect::Jammed && value == LOCKED, "FLASH_CR is locked: {value:#x}");
            self.keys = 0;
            return;
        }
        self.cr = value;
        if value & LOCKED != 0 {
            self.keys = 0;
        }
        if value & 1 << 16 == 0 {
            return;
        }
        let number = value >> 3 & 0x7f;
        assert_eq!(value & !(0x7f << 3), 1 << 16 | 1 << 11 | 1 << 1, "no erase of a page of the second bank");
        let start = BANK + number * PAGE;
        assert!(start >= FIRST, "page {number} is of the program");
        self.erased_pages.push(start);
        for at in (start..start + PAGE).step_by(8) {
            let from = (at - FIRST) as usize;
            for byte in from..from + 8 {
                self.memory[byte] |= if fails { self.random.random::<u8>() } else { 0xff };
            }
            self.damaged.remove(&at);
            self.programmed.remove(&at);
            if fails && self.random.random::<bool>() {
                self.damaged.insert(at);
            }
        }
        self.begin_operation();
    }

    /// Programming: both halves of a double word, the lower one first. What is interrupted has some of its bits cleared, and check bits that
    /// do not fit.
    pub fn program(&mut self, offset: u32, value: u32) {
        let Some(fails) = self.begin_write() else { return };
        assert!((FIRST..END).contains(&offset), "{offset:#x} is of the program");
        if self.cr & (1 | LOCKED) != 1 {
            self.sr |= PGSERR;
            return;
        }
        let Some((at, low)) = self.half.take() else {
            if offset.is_multiple_of(8) {
                self.half = Some((offset, value));
            } else {
                self.sr |= PGAERR;
            }
            return;
        };
        if offset != at + 4 {
            self.sr |= PGAERR;
            return;
        }
        if !self.programmed.insert(at) {
            self.sr |= PROGERR;
            return;
        }
        let from = (at - FIRST) as usize;
        let bytes = u64::from(low) | u64::from(value) << 32;
        for (byte, new) in self.memory[from..from + 8].iter_mut().zip(bytes.to_le_bytes()) {
            *byte &= new | if fails { self.random.random::<u8>() } else { 0 };
        }
        if fails {
            self.damaged.insert(at);
        }
        self.begin_operation();
    }

    /// A word, by way of the data cache. A damaged double word sets the flag for which the NMI is raised.
    pub fn word(&self, offset: u32) -> u32 {
        assert!(offset >= FIRST, "{offset:#x} is of the program");
        assert!(self.busy.get() == 0 || self.has_failed(), "a bank that is busy stalls the program");
        let at = offset & !7;
        if self.damaged.contains(&at) {
            self.eccr.set(1 << 31 | 1 << 21 | (at - BANK));
        }
        let from = (at - FIRST) as usize;
        let content: [u8; 8] = self.memory[from..from + 8].try_into().unwrap();
        let read =
            if self.cache_is_on { *self.cache.borrow_mut().entry(at).or_insert(content) } else { content };
        let half = (offset - at) as usize;
        u32::from_le_bytes(read[half..half + 4].try_into().unwrap())
    }
}
