//! The program of the board on an emulated STM32F405, and how it is run.
//!
//! QEMU's `netduinoplus2` has the core, its interrupt controller, flash and RAM at their addresses, and TIM2 to
//! TIM5. The program is unchanged. One thing is put in its way, because it would wait for it for ever: the
//! clocks. The test halts at the accesses of `FLASH_ACR`, `RCC_CR`, `RCC_PLLCFGR` and `RCC_CFGR` and answers them as
//! the chip does ([`clocks`]). Besides, it fills the free RAM with a pattern before the start.
//!
//! QEMU models no TIM1, no GPIO, no watchdog and no encoder mode. They read as 0; what is written to them stands in the
//! emulator's log ([`log`]). [`inputs`] answers for switch and encoders where a test closes the loops.
#![allow(clippy::unwrap_used, clippy::missing_panics_doc, reason = "for tests, which fail by panicking")]

pub mod clocks;
pub mod inputs;
pub mod log;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::chip::image::Image;
use crate::chip::memory::{Offset, Word, word};
use crate::chip::vectors::Vectors;
use crate::chip::walk::panics;
use crate::firmware::{FLASH, RAM, TICK};
use crate::gdb::{Halt, PC, Target, Trouble, Watch, XPSR};
use tempfile::TempDir;

use clocks::Clocks;
use inputs::Inputs;
use log::Log;

/// All ticks have to be over within this time: a thousand take four seconds on a slow machine.
const DEADLINE: Duration = Duration::from_secs(40);

/// How often the log is looked at.
const LOOK: Duration = Duration::from_millis(50);

/// Bits of the status that say which of the next instructions run.
const IT_STATE: u32 = 0x0600_fc00;

/// `str r0, [r1]`
const STORE: [u8; 2] = 0x6008u16.to_le_bytes();

/// What the free RAM is filled with.
const PATTERN: u8 = 0xa5;

/// The emulated chip with its program, halted.
pub struct Chip {
    /// The program.
    pub image: Image,
    /// Its vector table.
    pub vectors: Vectors,
    /// Memory and registers of the core.
    pub target: Target,
    /// What is answered instead of the clocks.
    pub clocks: Clocks,
    /// Without them the inputs read as QEMU has them: 0, and counters that run.
    pub inputs: Option<Inputs>,
    /// What the emulator writes down.
    pub log: Log,
    /// For the log and for what the emulator says.
    folder: TempDir,
}

/// Registers that the test answers for instead of QEMU.
pub trait Device {
    /// Addresses of the words.
    fn registers(&self) -> &[u32];
    /// What a load gets.
    fn read(&mut self, address: u32) -> u32;
    /// Takes a store.
    fn write(&mut self, address: u32, value: u32);
}

/// How a run has ended.
#[derive(Debug, PartialEq, Eq)]
pub enum End {
    /// With as many ticks as were asked for.
    Ticked,
    /// Where the program never comes back from: a fault, an interrupt that nobody handles, a panic.
    Entered(String),
}

impl Chip {
    /// Before the first instruction.
    #[must_use]
    pub fn start(program: &Path, inputs: Option<Inputs>) -> Self {
        let image = Image::read(&fs::read(program).unwrap());
        let vectors = Vectors::read(&image, FLASH);
        let folder = tempfile::tempdir().unwrap();
        let log = Log(folder.path().join("log"));
        let mut command = Command::new("qemu-system-arm");
        command
            .args(["-machine", "netduinoplus2", "-icount", "shift=0,sleep=off", "-display", "none"])
            .args(["-monitor", "none", "-serial", "none", "-S", "-gdb", "stdio"])
            .args(["-d", "int,unimp,guest_errors", "-D"])
            .arg(&log.0)
            .arg("-kernel")
            .arg(program)
            .stderr(fs::File::create(folder.path().join("errors")).unwrap());
        let target = Target::start(&mut command).unwrap();
        let mut chip = Self { image, vectors, target, clocks: Clocks::new(), inputs, log, folder };
        chip.prepare().unwrap();
        chip
    }

    /// Fills the free RAM and says where to halt.
    fn prepare(&mut self) -> Result<(), Trouble> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        self.target.set_memory(floor, &vec![PATTERN; (top - floor) as usize])?;
        let inputs = self.inputs.iter().flat_map(Device::registers);
        for &address in self.clocks.registers().iter().chain(inputs) {
            self.target.watch(Watch::Read, address)?;
            self.target.watch(Watch::Write, address)?;
        }
        let tick = self.vectors.handler(TICK);
        let handlers = self.vectors.exceptions().into_iter().filter(|&handler| handler != tick);
        for address in handlers.chain(self.image.named(panics)) {
            self.target.watch(Watch::Run, address)?;
        }
        Ok(())
    }

    /// Runs until so many ticks have begun, or until it is at one of its ends, and halts it there.
    ///
    /// # Errors
    /// When the emulator does not answer.
    pub fn run(&mut self, ticks: usize) -> Result<End, Trouble> {
        let began = Instant::now();
        let mut looked = began;
        self.target.run()?;
        loop {
            let halted = self.target.halted(LOOK)?;
            if looked.elapsed() >= LOOK {
                looked = Instant::now();
                if self.log.exceptions().len() >= ticks {
                    return halted
                        .map_or_else(|| self.target.stop().map(drop), |_| Ok(()))
                        .map(|()| End::Ticked);
                }
                assert!(began.elapsed() < DEADLINE, "too slow; {}", self.words());
            }
            match halted {
                Some(Halt::Read(address) | Halt::Write(address)) => {
                    self.answer(address)?;
                    self.target.run()?;
                }
                Some(Halt::Here) => {
                    let at = self.target.register(PC)?;
                    let (_, function) = self.image.function_at(at).unwrap();
                    return Ok(End::Entered(function.names[0].clone()));
                }
                None => {}
            }
        }
    }

    /// Does the access to a watched register that the target has halted at instead of it, and goes on behind it.
    fn answer(&mut self, address: u32) -> Result<(), Trouble> {
        let at = self.target.register(PC)?;
        let (high, low) = (self.image.half(at).unwrap_or(0), self.image.half(at + 2).unwrap_or(0));
        let access =
            word(high, low).unwrap_or_else(|| panic!("{high:#06x} {low:#06x} at {at:#x}: no access"));
        let Word { loads, register, base, offset } = access;
        // With `-icount` QEMU halts before an access to a device; behind it, this would be another instruction.
        let added = match offset {
            Offset::Bytes(bytes) => bytes.cast_unsigned(),
            Offset::Register(number, shift) => self.target.register(number)? << shift,
        };
        let conditional = self.target.register(XPSR)? & IT_STATE;
        assert_eq!(conditional, 0, "{access:?} at {at:#x} is conditional: it cannot be left out");
        let accessed = self.target.register(base)?.wrapping_add(added);
        assert_eq!(accessed, address, "{access:?} at {at:#x} is not what was watched");
        let device: &mut dyn Device = match &mut self.inputs {
            Some(inputs) if inputs.registers().contains(&address) => inputs,
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

    /// Lets the core itself store a word where GDB cannot: in a device. The instruction stands in free RAM meanwhile.
    fn store(&mut self, address: u32, value: u32) -> Result<(), Trouble> {
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

    /// Takes an exception by hand, to the first instructions of its handler.
    ///
    /// # Errors
    /// When the target does not answer.
    pub fn take(&mut self, exception: usize, instructions: u32) -> Result<(), Trouble> {
        self.target.set_register(PC, self.vectors.handler(exception))?;
        (0..instructions).try_for_each(|_| self.target.step())
    }

    /// What the emulator has said.
    #[must_use]
    pub fn words(&self) -> String {
        let errors = fs::read_to_string(self.folder.path().join("errors")).unwrap_or_default();
        let begun = self.log.exceptions().len();
        format!("{begun} exceptions so far. The emulator: {errors}\n{}", self.log.end())
    }

    fn floor(&self) -> u32 {
        self.vectors.stack_floor(&self.image, &RAM)
    }

    /// Bytes below the start of the stack that are not the pattern any more, and those above the data.
    ///
    /// # Errors
    /// When the emulator does not answer.
    pub fn stack(&mut self) -> Result<[u32; 2], Trouble> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        let bytes = self.target.memory(floor, (top - floor) as usize)?;
        let untouched = bytes.iter().take_while(|&&byte| byte == PATTERN).count();
        Ok([top - floor - u32::try_from(untouched).unwrap(), top - floor])
    }
}
