//! The program of the board on an emulated STM32F405.
//!
//! QEMU's machine `netduinoplus2` has the core, its interrupt controller, flash and RAM at their addresses, and TIM2 to
//! TIM5. The program is unchanged. QEMU does not model the clocks, so that the program would wait for them for ever: the
//! test halts at the accesses to `FLASH_ACR`, `RCC_CR`, `RCC_PLLCFGR` and `RCC_CFGR` and emulates them ([`clocks`]). Before
//! the start it fills the free RAM with a pattern.
//!
//! QEMU models no TIM1, GPIO, watchdog or encoder mode either. They read as 0, and writes to them are in the emulator's
//! log ([`log`]). [`inputs`] provides switch and encoders where a test closes the loops, [`usb_core`] a USB core that
//! is broken.
#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "for tests, which fail by panicking")]

pub mod clocks;
mod device;
pub mod inputs;
pub mod log;
pub mod usb_core;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use crate::chip::image::Image;
use crate::chip::memory::{Offset, Word, word};
use crate::chip::vectors::Vectors;
use crate::chip::walk::is_panic;
use crate::firmware::{FLASH, RAM, SERIAL, SETTINGS_SLOTS, TICK};
use crate::gdb::{GdbError, Halt, PC, Target, Watch, XPSR};
use tempfile::TempDir;

pub use device::Device;

use clocks::Clocks;
use inputs::Inputs;
use log::Log;
use usb_core::StuckUsbCore;

/// Timeout of a run: a thousand ticks take four seconds on a slow machine.
const TIMEOUT: Duration = Duration::from_secs(90);

/// Rounds of the idle loop between ticks where the test models the inputs.
const ROUNDS: u32 = 3;

/// Function of the idle loop: each round calls it once. A part of its mangled name.
const IDLE_ROUND: &str = "3app5serve";

/// Interval between readings of the log.
const POLL: Duration = Duration::from_millis(50);

/// State of an IT block in the program status: not 0 where the next instructions are conditional.
const IT_STATE: u32 = 0x0600_fc00;

/// `str r0, [r1]`
const STORE: [u8; 2] = 0x6008u16.to_le_bytes();

/// Pattern of the free RAM.
const PATTERN: u8 = 0xa5;

/// The emulated chip with its program, halted.
pub struct Chip {
    /// The program.
    pub image: Image,
    /// Its vector table.
    pub vectors: Vectors,
    /// Memory and registers of the core.
    pub target: Target,
    /// Model of the clocks.
    pub clocks: Clocks,
    /// Model of the inputs; `None`: as in QEMU, pins read as 0 and the encoder counters run.
    pub inputs: Option<Inputs>,
    /// Model of the USB core; `None`: as in QEMU, its registers read as 0.
    pub usb: Option<StuckUsbCore>,
    /// The emulator's log.
    pub log: Log,
    /// For the log and the emulator's messages.
    folder: TempDir,
    /// Address of the function of the idle loop.
    idle_round: Vec<u32>,
    /// Rounds of the idle loop since the last tick that was pended.
    rounds: u32,
}

/// How a run ended.
#[derive(Debug, PartialEq, Eq)]
pub enum End {
    /// After the requested number of ticks.
    Ticked,
    /// In a function that never returns: of a fault, an unhandled interrupt or a panic; its name.
    Entered(String),
}

impl Chip {
    /// Starts the emulator, halted before the first instruction.
    #[must_use]
    pub fn start(program: &Path, inputs: Option<Inputs>) -> Self {
        let image = Image::read(&fs::read(program).unwrap());
        let vectors = Vectors::read(&image, FLASH);
        let folder = tempfile::tempdir().unwrap();
        let log = Log(folder.path().join("log"));
        let mut command = Command::new("qemu-system-arm");
        command
            .args(["-machine", "netduinoplus2", "-icount", "shift=0,sleep=off", "-display", "none"])
            .args(["-monitor", "none", "-serial", "null", "-serial", "null", "-serial"])
            .arg(format!("unix:{},server=on,wait=off", folder.path().join("serial").display()))
            .args(["-S", "-gdb", "stdio"])
            .args(["-d", "int,unimp,guest_errors", "-D"])
            .arg(&log.0)
            .arg("-kernel")
            .arg(program)
            .stderr(fs::File::create(folder.path().join("errors")).unwrap());
        let target = Target::start(&mut command).unwrap();
        let mut chip = Self {
            image,
            vectors,
            target,
            clocks: Clocks::new(),
            inputs,
            usb: None,
            log,
            folder,
            idle_round: Vec::new(),
            rounds: 0,
        };
        chip.prepare().unwrap();
        chip
    }

    /// Gives the chip a USB core. To be called before it runs.
    ///
    /// # Errors
    /// When the emulator does not reply.
    pub fn attach_usb(&mut self, usb: StuckUsbCore) -> Result<(), GdbError> {
        for &address in usb.registers() {
            self.target.watch(Watch::Read, address)?;
            self.target.watch(Watch::Write, address)?;
        }
        self.usb = Some(usb);
        Ok(())
    }

    /// Fills the free RAM and sets breakpoints and watchpoints.
    fn prepare(&mut self) -> Result<(), GdbError> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        self.target.set_memory(floor, &vec![PATTERN; (top - floor) as usize])?;
        // Erased, where QEMU leaves zeros.
        for slot in SETTINGS_SLOTS {
            self.target.set_memory(slot, &[0xff; 64])?;
        }
        let inputs = self.inputs.iter().flat_map(Device::registers);
        for &address in self.clocks.registers().iter().chain(inputs) {
            self.target.watch(Watch::Read, address)?;
            self.target.watch(Watch::Write, address)?;
        }
        let tick = self.vectors.handler(TICK);
        let serial = self.vectors.handler(SERIAL);
        let handlers = self.vectors.exceptions().into_iter().filter(|&at| at != tick && at != serial);
        self.idle_round = self.image.named(|name| name.contains(IDLE_ROUND));
        let idle = self.inputs.iter().flat_map(|_| self.idle_round.clone()).collect::<Vec<_>>();
        for address in handlers.chain(self.image.named(is_panic)).chain(idle) {
            self.target.watch(Watch::Run, address)?;
        }
        Ok(())
    }

    /// Runs until a number of ticks have begun or the program has entered a function that never returns; halts there.
    ///
    /// # Errors
    /// When the emulator does not reply.
    pub fn run(&mut self, ticks: usize) -> Result<End, GdbError> {
        let start = Instant::now();
        let mut polled = start;
        self.target.run()?;
        loop {
            let halted = self.target.halted(POLL)?;
            if polled.elapsed() >= POLL {
                polled = Instant::now();
                if self.ticks() >= ticks {
                    return halted
                        .map_or_else(|| self.target.stop().map(drop), |_| Ok(()))
                        .map(|()| End::Ticked);
                }
                assert!(start.elapsed() < TIMEOUT, "too slow; {}", self.diagnostics());
            }
            match halted {
                Some(Halt::Read(address) | Halt::Write(address)) => {
                    self.emulate_access(address)?;
                    self.target.run()?;
                }
                Some(Halt::Here) => {
                    let at = self.target.register(PC)?;
                    if self.idle_round.contains(&at) {
                        // A whole round has passed between two halts: then the next tick may begin.
                        self.target.step()?;
                        self.rounds += 1;
                        if self.rounds >= ROUNDS
                            && let Some((address, value)) = self.inputs.as_mut().and_then(Inputs::next_tick)
                        {
                            self.rounds = 0;
                            self.store(address, value)?;
                        }
                        self.target.run()?;
                        continue;
                    }
                    let (_, function) = self.image.function_at(at).unwrap();
                    return Ok(End::Entered(function.names[0].clone()));
                }
                None => {}
            }
        }
    }

    /// Pends a tick at the instruction at which the chip is halted.
    ///
    /// # Errors
    /// When the emulator does not reply.
    pub fn pend_tick(&mut self) -> Result<(), GdbError> {
        let (address, value) = inputs::PEND_TICK;
        self.store(address, value)
    }

    /// Number of ticks that have begun.
    #[must_use]
    pub fn ticks(&self) -> usize {
        self.log.exceptions().into_iter().filter(|number| *number == TICK).count()
    }

    /// Path of the socket at USART3.
    #[must_use]
    pub fn serial(&self) -> PathBuf {
        self.folder.path().join("serial")
    }

    /// Performs the access to a watched register at which the target has halted, and skips its instruction.
    fn emulate_access(&mut self, address: u32) -> Result<(), GdbError> {
        let at = self.target.register(PC)?;
        let (high, low) = (self.image.half(at).unwrap_or(0), self.image.half(at + 2).unwrap_or(0));
        let access =
            word(high, low).unwrap_or_else(|| panic!("{high:#06x} {low:#06x} at {at:#x} is no access"));
        let Word { loads, register, base, offset } = access;
        // With `-icount` QEMU halts before an access to a device, so that the instruction at PC is the access.
        let added = match offset {
            Offset::Bytes(bytes) => bytes.cast_unsigned(),
            Offset::Register(number, shift) => self.target.register(number)? << shift,
        };
        let conditional = self.target.register(XPSR)? & IT_STATE;
        assert_eq!(conditional, 0, "{access:?} at {at:#x} is conditional: it cannot be skipped");
        let accessed = self.target.register(base)?.wrapping_add(added);
        assert_eq!(accessed, address, "{access:?} at {at:#x} is not at the watched address");
        let device: &mut dyn Device = match (&mut self.inputs, &mut self.usb) {
            (Some(inputs), _) if inputs.registers().contains(&address) => inputs,
            (_, Some(usb)) if usb.registers().contains(&address) => usb,
            _ => &mut self.clocks,
        };
        if loads {
            self.target.set_register(register, device.read(address))?;
        } else {
            device.write(address, self.target.register(register)?);
        }
        self.target.set_register(PC, at + if high >= 0xe800 { 4 } else { 2 })?;
        let stores = self.inputs.as_mut().map(Inputs::stores).unwrap_or_default();
        stores.into_iter().try_for_each(|(to, value)| self.store(to, value))
    }

    /// Lets the core store a word in a device, which GDB cannot do, by an instruction in free RAM.
    fn store(&mut self, address: u32, value: u32) -> Result<(), GdbError> {
        let free = self.floor();
        let [r0, r1, pc] = [self.target.register(0)?, self.target.register(1)?, self.target.register(PC)?];
        self.target.set_memory(free, &STORE)?;
        for (number, value) in [(0, value), (1, address), (PC, free)] {
            self.target.set_register(number, value)?;
        }
        self.target.step()?;
        assert_eq!(self.target.register(PC)?, free + 2, "a store of {value:#x} to {address:#x}");
        for (number, value) in [(0, r0), (1, r1), (PC, pc)] {
            self.target.set_register(number, value)?;
        }
        self.target.set_memory(free, &[PATTERN; 2])
    }

    /// Runs the first instructions of the handler of an exception, without its exception frame.
    ///
    /// # Errors
    /// When the target does not reply.
    pub fn enter_handler(&mut self, exception: usize, instructions: u32) -> Result<(), GdbError> {
        self.target.set_register(PC, self.vectors.handler(exception))?;
        (0..instructions).try_for_each(|_| self.target.step())
    }

    /// Messages of the emulator and the end of its log.
    #[must_use]
    pub fn diagnostics(&self) -> String {
        let errors = fs::read_to_string(self.folder.path().join("errors")).unwrap_or_default();
        let count = self.log.exceptions().len();
        format!("{count} exceptions so far. The emulator: {errors}\n{}", self.log.end())
    }

    fn floor(&self) -> u32 {
        self.vectors.stack_floor(&self.image, &RAM)
    }

    /// Used bytes of the stack, by the pattern, and bytes that it may use.
    ///
    /// # Errors
    /// When the emulator does not reply.
    pub fn stack(&mut self) -> Result<[u32; 2], GdbError> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        let bytes = self.target.memory(floor, (top - floor) as usize)?;
        let untouched = bytes.iter().take_while(|&&byte| byte == PATTERN).count();
        Ok([top - floor - u32::try_from(untouched).unwrap(), top - floor])
    }
}
