//! A model of the registers of an STM32G474, by the reference manual RM0440: which device has a clock, what becomes ready after what, what is
//! protected ([`super::devices`]), the flash ([`super::flash_model`]) and CAN ([`super::can_model`]). Every write is recorded. What the manual forbids panics.

use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};

use firmware::g474::bus::{Bus, Line};

use super::can_model::CanModel;
use super::flash_model::FlashModel;

pub const RCC: u32 = 0x4002_1000;
pub const PWR: u32 = 0x4000_7000;
pub const FLASH_REGISTERS: u32 = 0x4002_2000;
const FLASH: u32 = 0x0800_0000;
pub const GPIOA: u32 = 0x4800_0000;
pub const GPIOB: u32 = 0x4800_0400;
pub const GPIOC: u32 = 0x4800_0800;
pub const GPIOD: u32 = 0x4800_0c00;
pub const TIM1: u32 = 0x4001_2c00;
pub const TIM2: u32 = 0x4000_0000;
/// TIM3, TIM4, TIM5 and TIM8: motor encoders of X and Y, scales of X and Y.
pub const COUNTERS: [u32; 4] = [0x4000_0400, 0x4000_0800, 0x4000_0c00, 0x4001_3400];
const USART3: u32 = 0x4000_4800;
pub const IWDG: u32 = 0x4000_3000;
pub const ADCS: [u32; 2] = [0x5000_0000, 0x5000_0100];
pub const CAN: u32 = 0x4000_6400;
const CAN_MEMORY: u32 = 0x4000_a400;

/// Chapter 7: of each device its enable register, its bit, its address, and its length.
const CLOCKED: [(u32, u32, u32, u32); 17] = [
    (0x4c, 0, GPIOA, 0x400),
    (0x4c, 1, GPIOB, 0x400),
    (0x4c, 2, GPIOC, 0x400),
    (0x4c, 3, GPIOD, 0x400),
    (0x4c, 13, 0x5000_0000, 0x400),
    (0x4c, 16, 0x5000_0800, 0x400),
    (0x58, 0, TIM2, 0x400),
    (0x58, 1, 0x4000_0400, 0x400),
    (0x58, 2, 0x4000_0800, 0x400),
    (0x58, 3, 0x4000_0c00, 0x400),
    (0x58, 18, USART3, 0x400),
    (0x58, 25, CAN, 0x400),
    (0x58, 25, CAN_MEMORY, 0x350),
    (0x58, 28, PWR, 0x400),
    (0x60, 0, 0x4001_0000, 0x30),
    (0x60, 11, TIM1, 0x400),
    (0x60, 13, 0x4001_3400, 0x400),
];

/// Values after a reset that are not zero.
const AFTER_RESET: [(u32, u32); 16] = [
    (RCC, 1 << 8 | 1 << 10),
    (RCC + 0x08, 0b0101),
    (GPIOA, 0xabff_ffff),
    (GPIOB, 0xffff_febf),
    (GPIOC, 0xffff_ffff),
    (GPIOD, 0xffff_ffff),
    (GPIOA + 0x0c, 0x6400_0000),
    (GPIOB + 0x0c, 0x0000_0100),
    (PWR + 0x80, 1 << 8),
    (FLASH_REGISTERS, 0x0004_0600),
    (FLASH_REGISTERS + 0x20, 0xffef_f8aa),
    (ADCS[0] + 0x08, 1 << 29),
    (ADCS[1] + 0x08, 1 << 29),
    (USART3 + 0x1c, 0x00c0),
    (IWDG + 0x08, 0xfff),
    (CAN + 0x18, 1),
];

/// Reads of a register until what it waits for has happened.
const DELAY: u32 = 3;

thread_local! {
    /// Interrupts that the program has raised.
    pub static PENDED: RefCell<Vec<Line>> = const { RefCell::new(Vec::new()) };
}

/// A write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Write {
    pub address: u32,
    pub value: u32,
}

/// The chip behind its bus.
pub struct Model {
    state: RefCell<State>,
}

pub struct State {
    pub words: BTreeMap<u32, u32>,
    log: Vec<Write>,
    /// Bits of a register that become set after some reads of it.
    pending: BTreeMap<u32, (u32, u32)>,
    /// Time that was waited, µs.
    pub waited_us: u32,
    pub watchdog_is_open: bool,
    pub flash: FlashModel,
    pub can: CanModel,
    /// Bytes at the serial port.
    pub received: VecDeque<u8>,
    pub sent: Vec<u8>,
}

impl Model {
    /// After a reset, with a flash. For the lifetime of the test.
    pub fn new(flash: FlashModel) -> &'static Self {
        let state = State {
            words: BTreeMap::from(AFTER_RESET),
            log: Vec::new(),
            pending: BTreeMap::new(),
            waited_us: 0,
            watchdog_is_open: false,
            flash,
            can: CanModel::default(),
            received: VecDeque::new(),
            sent: Vec::new(),
        };
        Box::leak(Box::new(Self { state: RefCell::new(state) }))
    }

    pub fn with<R>(&self, access: impl FnOnce(&mut State) -> R) -> R {
        access(&mut self.state.borrow_mut())
    }

    /// The value of a register, without an effect.
    pub fn word(&self, address: u32) -> u32 {
        self.with(|state| state.word(address))
    }

    /// Sets what the program reads.
    pub fn set(&self, address: u32, value: u32) {
        self.with(|state| state.words.insert(address, value));
    }

    /// A tick begins: the update of its timer.
    pub fn begin_tick(&self) {
        self.with(State::latch_counters);
    }

    /// All writes so far.
    pub fn log(&self) -> Vec<Write> {
        self.with(|state| state.log.clone())
    }

    /// The values that were written to a register.
    pub fn written(&self, address: u32) -> Vec<u32> {
        self.log().iter().filter(|write| write.address == address).map(|write| write.value).collect()
    }

    /// The place of the first write in the log for which a condition is true.
    pub fn first(&self, condition: impl Fn(Write) -> bool) -> usize {
        self.log().into_iter().position(condition).expect("a write")
    }
}

impl Bus for &'static Model {
    fn read(self, address: u32) -> u32 {
        self.with(|state| state.read(address))
    }

    fn write(self, address: u32, value: u32) {
        self.with(|state| state.write(address, value));
    }

    fn wait_us(self, us: u32) {
        self.with(|state| state.waited_us += us);
    }

    fn pend(line: Line) {
        PENDED.with_borrow_mut(|lines| lines.push(line));
    }
}

impl State {
    pub fn word(&self, address: u32) -> u32 {
        self.words.get(&address).copied().unwrap_or(0)
    }

    /// There is something at the address (chapter 2: the flash, the devices, those of the core), and it has a clock.
    fn require_clock(&self, address: u32) {
        let is_there = matches!(address, FLASH..0x0808_0000 | 0x4000_0000..0x5006_0c00 | 0xe000_0000..);
        assert!(is_there, "nothing is at {address:#x}");
        let clocked = CLOCKED.iter().find(|(_, _, from, length)| (*from..from + length).contains(&address));
        if let Some((enable, bit, ..)) = clocked {
            assert!(self.word(RCC + enable) >> bit & 1 == 1, "{address:#x} has no clock");
        }
    }

    fn read(&mut self, address: u32) -> u32 {
        self.require_clock(address);
        if let Some((reads, bits)) = self.pending.get_mut(&address) {
            *reads -= 1;
            if *reads == 0 {
                let bits = *bits;
                self.pending.remove(&address);
                *self.words.entry(address).or_default() ^= bits;
            }
        }
        match address {
            _ if (FLASH..FLASH + 0x8_0000).contains(&address) => self.flash.word(address - FLASH),
            _ if (FLASH_REGISTERS + 4..FLASH_REGISTERS + 0x20).contains(&address) => {
                self.flash.register(address - FLASH_REGISTERS)
            }
            _ if address == USART3 + 0x1c => self.word(address) | u32::from(!self.received.is_empty()) << 5,
            _ if address == USART3 + 0x24 => self.received.pop_front().map_or(0, u32::from),
            _ if (CAN_MEMORY..CAN_MEMORY + 0x350).contains(&address) => {
                self.can.memory.get(&(address - CAN_MEMORY)).copied().unwrap_or(0)
            }
            _ if address == CAN + 0x90 => self.can.received_state(),
            _ if address == CAN + 0xc4 => self.can.sending_state(),
            _ => self.word(address),
        }
    }

    /// Bits of a register change after some reads of it.
    pub fn change_later(&mut self, address: u32, bits: u32) {
        self.pending.insert(address, (DELAY, bits));
    }

    fn write(&mut self, address: u32, value: u32) {
        self.require_clock(address);
        let before = self.word(address);
        self.log.push(Write { address, value });
        if (FLASH..FLASH + 0x8_0000).contains(&address) {
            self.flash.program(address - FLASH, value);
            return;
        }
        if (FLASH_REGISTERS + 4..FLASH_REGISTERS + 0x20).contains(&address) {
            self.flash.set_register(address - FLASH_REGISTERS, value);
            return;
        }
        self.words.insert(address, value);
        match address & !0x3ff {
            RCC => self.clock(address, value, before),
            GPIOA | GPIOB | GPIOC | GPIOD if address & 0x3ff == 0x18 => {
                let outputs = (address & !0x3ff) + 0x14;
                let level = self.word(outputs) & !(value >> 16) | value & 0xffff;
                self.words.insert(outputs, level);
            }
            TIM1 | TIM2 | 0x4000_0400 | 0x4000_0800 | 0x4000_0c00 | 0x4001_3400
                if address & 0x3ff == 0x10 =>
            {
                // Chapter 28: zeros clear the flags.
                self.words.insert(address, before & value);
            }
            0x5000_0000 => self.converter(address, value, before),
            IWDG => self.watchdog(address, value, before),
            USART3 if address & 0x3ff == 0x28 => self.sent.push(value.to_le_bytes()[0]),
            USART3 if address & 0x3ff == 0x20 => {
                let flags = self.word(USART3 + 0x1c) & !value;
                self.words.insert(USART3 + 0x1c, flags);
            }
            FLASH_REGISTERS if address == FLASH_REGISTERS => self.flash.set_access_control(value),
            CAN => self.can_register(address, value, before),
            _ if (CAN_MEMORY..CAN_MEMORY + 0x350).contains(&address) => {
                self.can.memory.insert(address - CAN_MEMORY, value);
            }
            _ => {}
        }
    }
}

/// A frame arrives, or a frame leaves: the flag of it.
pub fn set_can_flags(model: &Model, bits: u32) {
    let flags = model.word(CAN + 0x50);
    model.set(CAN + 0x50, flags | bits);
}
