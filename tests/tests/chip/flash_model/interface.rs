//! A model of the flash interface of an STM32F405, by the reference manual RM0090, chapter 3: keys, lock, the operations of sectors and
//! bytes, errors, the data cache; and the supply, which may fail at any write.
//!
//! What the manual forbids panics: it would be a bus error, or an erased program.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use firmware::flash::{FlashAccess, FlashRegisters, Register};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Table 5: sectors 10 and 11, of 128 KiB each, which are the last of 1 MiB. The program is in the others.
const SECTORS: [(u32, u32); 2] = [(10, 0xc_0000), (11, 0xe_0000)];
const SECTOR_BYTES: u32 = 0x2_0000;
const FIRST: u32 = SECTORS[0].1;

/// 3.6.1: the keys.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// 3.9.5: sequence and parallelism of programming, busy; a one clears an error.
const PGSERR: u32 = 1 << 7;
const PGPERR: u32 = 1 << 6;
const BSY: u32 = 1 << 16;

/// 3.9.7.
const PG: u32 = 1;
const SER: u32 = 1 << 1;
const PSIZE: u32 = 0b11 << 8;
const STRT: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

/// 3.9.2: instruction cache and wait states stay as they are.
const DCRST: u32 = 1 << 12;
const DCEN: u32 = 1 << 10;
pub const ACR_AT_START: u32 = 0x0705;

/// 3.5.2: a line of the data cache has 128 bits.
const LINE: u32 = 16;

/// Reads of the status while an operation goes on.
const BUSY_READS: u32 = 3;

/// The registers, the two sectors, and the supply.
pub struct Interface {
    memory: Vec<u8>,
    cache: RefCell<BTreeMap<u32, Vec<u8>>>,
    acr: u32,
    cr: u32,
    sr: u32,
    /// Keys that were given since the lock.
    keys: usize,
    busy: Cell<u32>,
    /// An error that the next operation has, a bit of `FLASH_SR`.
    pub next_error: u32,
    /// Whether the keys do not unlock.
    pub is_jammed: bool,
    /// Whether the watchdog has its longest period.
    pub watchdog_is_slow: bool,
    /// Writes so far.
    pub writes: usize,
    /// The write during which the supply fails.
    fails_at: usize,
    random: ChaCha8Rng,
}

impl Interface {
    /// With a content of the two sectors, whose supply fails during a write. The seed is that of what such a write leaves.
    pub fn new(memory: Vec<u8>, fails_at: usize, seed: u64) -> Self {
        assert_eq!(memory.len(), 2 * SECTOR_BYTES as usize);
        Self {
            memory,
            cache: RefCell::default(),
            acr: ACR_AT_START,
            cr: LOCK,
            sr: 0,
            keys: 0,
            busy: Cell::new(0),
            next_error: 0,
            is_jammed: false,
            watchdog_is_slow: false,
            writes: 0,
            fails_at,
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// Two erased sectors.
    pub fn erased() -> Vec<u8> {
        vec![0xff; 2 * SECTOR_BYTES as usize]
    }

    /// What remains without a supply.
    pub fn into_memory(self) -> Vec<u8> {
        self.memory
    }

    /// The registers that a program leaves behind: access control and control.
    pub const fn registers(&self) -> [u32; 2] {
        [self.acr, self.cr]
    }

    const fn has_failed(&self) -> bool {
        self.writes > self.fails_at
    }

    /// Counts a write. `None` without a supply; otherwise whether it fails during this write.
    fn begin_write(&mut self) -> Option<bool> {
        if self.has_failed() {
            return None;
        }
        assert_eq!(self.busy.get(), 0, "a write during an operation");
        self.writes += 1;
        Some(self.has_failed())
    }

    fn begin_operation(&mut self) {
        assert_eq!(self.sr, 0, "3.9.5: an error that is not cleared keeps the next operation from starting");
        self.busy.set(BUSY_READS);
        self.sr |= std::mem::take(&mut self.next_error);
    }

    fn set_control(&mut self, value: u32, fails: bool) {
        if self.cr & LOCK != 0 {
            assert!(self.is_jammed && value == LOCK, "FLASH_CR is locked: {value:#x}");
            self.keys = 0;
            return;
        }
        self.cr = value;
        if value & LOCK != 0 {
            self.keys = 0;
        }
        if value & STRT == 0 {
            return;
        }
        assert!(
            value & SER != 0 && value & PG == 0,
            "{value:#x} starts something else than an erase of a sector"
        );
        let number = value >> 3 & 0xf;
        let (_, start) =
            SECTORS[SECTORS.iter().position(|(of, _)| *of == number).expect("erases the program")];
        assert!(self.watchdog_is_slow, "an erase takes longer than the period of the watchdog");
        let from = (start - FIRST) as usize;
        let Self { memory, random, .. } = self;
        for byte in &mut memory[from..from + SECTOR_BYTES as usize] {
            // An erase that is interrupted leaves some bits as they were.
            *byte |= if fails { random.random::<u8>() } else { 0xff };
        }
        self.begin_operation();
    }
}

impl FlashRegisters for Interface {
    fn get(&self, register: Register) -> u32 {
        if self.has_failed() {
            return 0;
        }
        match register {
            Register::AccessControl => self.acr,
            Register::Status => {
                let busy = self.busy.get();
                self.busy.set(busy.saturating_sub(1));
                self.sr | if busy > 0 { BSY } else { 0 }
            }
            Register::Control => self.cr,
            Register::Key => panic!("FLASH_KEYR can only be written"),
        }
    }

    fn set(&mut self, register: Register, value: u32) {
        let Some(fails) = self.begin_write() else { return };
        match register {
            Register::AccessControl => {
                assert!(
                    value & DCRST == 0 || value & DCEN == 0,
                    "3.9.2: a reset of the data cache that is on"
                );
                if value & DCRST != 0 {
                    self.cache.borrow_mut().clear();
                }
                self.acr = value;
            }
            Register::Key => {
                assert_eq!(KEYS.get(self.keys), Some(&value), "a wrong key locks the flash until a reset");
                self.keys += 1;
                if self.keys == KEYS.len() && !self.is_jammed {
                    self.cr &= !LOCK;
                }
            }
            Register::Status => self.sr &= !value,
            Register::Control => self.set_control(value, fails),
        }
    }

    /// With the data cache on, what it holds.
    fn byte(&self, offset: u32) -> u8 {
        let stalls = self.busy.get() > 0 && !self.has_failed();
        assert!(!stalls, "a read stalls the program until the operation has ended");
        let at = (offset - FIRST) as usize;
        if self.acr & DCEN == 0 {
            return self.memory[at];
        }
        let line = at - at % LINE as usize;
        let mut cache = self.cache.borrow_mut();
        let content = cache
            .entry(u32::try_from(line).unwrap())
            .or_insert_with(|| self.memory[line..line + LINE as usize].to_vec());
        content[at - line]
    }

    /// Programming clears bits, in the memory and in the cache. Without PG, or with another width than that of a byte, it is an error.
    fn set_byte(&mut self, offset: u32, byte: u8) {
        let Some(fails) = self.begin_write() else { return };
        assert!(offset >= FIRST, "{offset:#x} is in the program");
        assert!(self.watchdog_is_slow, "the ticks do not feed the watchdog meanwhile");
        if self.cr & (PG | LOCK) != PG {
            self.sr |= PGSERR;
        } else if self.cr & PSIZE != 0 {
            self.sr |= PGPERR;
        } else {
            let at = (offset - FIRST) as usize;
            // A byte whose programming is interrupted has some of its bits cleared.
            let kept = if fails { self.random.random::<u8>() } else { 0 };
            self.memory[at] &= byte | kept;
            let line = at - at % LINE as usize;
            if let Some(content) = self.cache.get_mut().get_mut(&u32::try_from(line).unwrap()) {
                content[at - line] = self.memory[at];
            }
            self.begin_operation();
        }
    }
}

/// The interface with a watchdog.
pub struct Watched<'a>(pub &'a mut Interface);

impl FlashAccess for Watched<'_> {
    type Registers = Interface;

    fn registers(&mut self) -> &mut Interface {
        self.0
    }

    fn with_slow_watchdog<R>(&mut self, change: impl FnOnce(&mut Interface) -> R) -> R {
        self.0.watchdog_is_slow = true;
        let result = change(self.0);
        self.0.watchdog_is_slow = false;
        result
    }
}
