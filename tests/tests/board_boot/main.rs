//! The ELF file that is flashed starts on an emulated STM32F405 and ticks.
//!
//! QEMU's `netduinoplus2` has the core, its interrupt controller, flash and RAM at their addresses, and TIM2 to
//! TIM5. The program is unchanged. One thing is put in its way, because it would wait for it for ever: the
//! clocks. The test halts at the accesses of `FLASH_ACR`, `RCC_CR`, `RCC_PLLCFGR` and `RCC_CFGR` and answers them as the
//! chip does (`clocks.rs`). Besides, it fills the free RAM with a pattern before the start.
//!
//! What this run does not show: QEMU models no TIM1, no GPIO, no watchdog and no encoder mode. They read as 0, so
//! the enable switch is open and the drives stay off. What is written to them is checked in the emulator's log.
//! The period between ticks is not that of the chip either: QEMU's timer adds the time since power-up when it
//! was started. So the registers of TIM2 are read, and the rate is computed from them and the clocks.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod clocks;
mod log;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use firmware::setup::{CRYSTAL_HZ, TICK_HZ};
use tempfile::TempDir;
use tests::chip::image::Image;
use tests::chip::vectors::{EXCEPTION_FRAME, Vectors};
use tests::chip::walk::panics;
use tests::firmware::{FLASH, SELF_CALLS, TICK};
use tests::gdb::{Halt, PC, SP, Target, Trouble, Watch, XPSR};

use clocks::Clocks;
use log::{Access, Log};

/// Ticks that have to run.
const TICKS: usize = 1000;

/// All of them have to be over within this time: they take four seconds on a slow machine.
const DEADLINE: Duration = Duration::from_secs(40);

/// How often the log is looked at.
const LOOK: Duration = Duration::from_millis(50);

/// What the free RAM is filled with.
const PATTERN: u8 = 0xa5;

/// TIM2 (RM0090, 18.4): CR1, DIER, PSC, ARR.
const TIM2: u32 = 0x4000_0000;

/// Enabled interrupts 0 to 31 (ARMv7-M reference manual, B3.4.4).
const NVIC_ISER0: u32 = 0xe000_e100;

/// The emulated chip with its program, halted before the first instruction.
struct Chip {
    image: Image,
    vectors: Vectors,
    target: Target,
    clocks: Clocks,
    log: Log,
    folder: TempDir,
}

impl Chip {
    fn start(program: &Path) -> Self {
        let image = Image::read(&fs::read(program).unwrap());
        let vectors = Vectors::read(&image, FLASH);
        let folder = tempfile::tempdir().unwrap();
        let log = Log(folder.path().join("log"));
        let mut command = Command::new("qemu-system-arm");
        command
            .args(["-machine", "netduinoplus2", "-icount", "shift=0", "-display", "none"])
            .args(["-monitor", "none", "-serial", "none", "-S", "-gdb", "stdio"])
            .args(["-d", "int,unimp,guest_errors", "-D"])
            .arg(&log.0)
            .arg("-kernel")
            .arg(program)
            .stderr(fs::File::create(folder.path().join("errors")).unwrap());
        let target = Target::start(&mut command).unwrap();
        Self { image, vectors, target, clocks: Clocks::new(), log, folder }
    }

    /// End of the static data below the stack.
    fn floor(&self) -> u32 {
        let ends = self.image.data.iter().map(|range| range.end);
        ends.filter(|&end| end <= self.vectors.initial_sp).max().unwrap()
    }

    fn prepare(&mut self) -> Result<(), Trouble> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        self.target.fill(floor, (top - floor) as usize, PATTERN)?;
        Clocks::watch(&mut self.target)?;
        let tick = self.vectors.handler(TICK);
        let handlers = self.vectors.exceptions().into_iter().filter(|&handler| handler != tick);
        for address in handlers.chain(self.image.named(panics)) {
            self.target.watch(Watch::Run, address)?;
        }
        Ok(())
    }

    /// Runs until so many ticks have begun, and halts it there.
    fn run(&mut self, ticks: usize) -> Result<(), Trouble> {
        let began = Instant::now();
        self.target.run()?;
        loop {
            match self.target.halted(LOOK)? {
                Some(Halt::Read(address) | Halt::Write(address)) => {
                    self.clocks.answer(&mut self.target, &self.image, address)?;
                    self.target.run()?;
                }
                Some(Halt::Here) => {
                    let (pc, sp) = (self.target.register(PC)?, self.target.register(SP)?);
                    let (_, function) = self.image.function_at(pc).unwrap();
                    panic!("{} at {pc:#x}, stack pointer {sp:#x}; {}", function.names[0], self.words());
                }
                None if self.log.exceptions().len() >= ticks => break,
                None => assert!(began.elapsed() < DEADLINE, "too slow; {}", self.words()),
            }
        }
        self.target.stop().map(|_| ())
    }

    /// What the emulator has said.
    fn words(&self) -> String {
        let errors = fs::read_to_string(self.folder.path().join("errors")).unwrap_or_default();
        format!(
            "{} exceptions so far. The emulator: {errors}\n{}",
            self.log.exceptions().len(),
            self.log.end()
        )
    }

    /// Bytes below the start of the stack that are not the pattern any more, and those above the data.
    fn stack(&mut self) -> Result<[u32; 2], Trouble> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        let bytes = self.target.memory(floor, (top - floor) as usize)?;
        let untouched = bytes.iter().take_while(|&&byte| byte == PATTERN).count();
        Ok([top - floor - u32::try_from(untouched).unwrap(), top - floor])
    }
}

#[test]
fn the_program_that_is_flashed_starts_and_ticks_a_thousand_times_without_an_exception() {
    let mut chip = Chip::start(&tests::firmware::built("board"));
    if let Err(trouble) = chip.prepare().and_then(|()| chip.run(TICKS)) {
        panic!("{trouble:?}; {}", chip.words());
    }
    let exceptions = chip.log.exceptions();
    assert!(exceptions.iter().all(|&number| number == TICK), "{exceptions:?}");
    assert!((TICKS..100 * TICKS).contains(&exceptions.len()), "{}", exceptions.len());
    assert!(!chip.log.text().contains("Invalid"), "{}", chip.words());
    stack_is_as_deep_as_computed(&mut chip);
    tick_is_as_fast_as_set_up(&mut chip);
    let accesses = chip.log.accesses();
    every_device_has_a_clock(&accesses);
    drives_stay_off_and_the_watchdog_is_fed(&accesses, exceptions.len());
    println!("{} ticks, {} answers of the clocks", exceptions.len(), chip.clocks.answered);
}

fn stack_is_as_deep_as_computed(chip: &mut Chip) {
    let [used, room] = chip.stack().unwrap();
    let worst = chip.vectors.worst_case(&chip.image, &SELF_CALLS).unwrap();
    println!("{used} B of the stack were used, {} B computed, {room} B are there", worst.bytes());
    assert!(used <= worst.bytes() && worst.bytes() <= room, "{used} B of {} B of {room} B", worst.bytes());
    // The tick's own frame on that of the core, which left its two words of alignment and reserve out.
    let tick = chip.vectors.handler(TICK);
    let [_, frame, ..] = [0, worst.exceptions.iter().find(|depth| depth.way[0].0 == tick).unwrap().way[0].1];
    assert!(used >= frame + EXCEPTION_FRAME - 8, "{used} B of {frame} B");
    let (sp, running) = (chip.target.register(SP).unwrap(), chip.target.register(XPSR).unwrap() & 511);
    assert!(sp <= chip.vectors.initial_sp && sp >= chip.vectors.initial_sp - worst.bytes(), "{sp:#x}");
    assert!(running == 0 || running as usize == TICK, "exception {running}");
}

fn tick_is_as_fast_as_set_up(chip: &mut Chip) {
    let [control, interrupts, prescaler, reload] =
        [0, 0xc, 0x28, 0x2c].map(|offset| chip.target.word(TIM2 + offset).unwrap());
    // Counts up, without end; interrupts at an update, and at nothing else.
    assert_eq!((control & 0x79, interrupts), (1, 1), "CR1 {control:#x}, DIER {interrupts:#x}");
    let clock = chip.clocks.timers_hz(CRYSTAL_HZ);
    assert_eq!(clock % ((prescaler + 1) * (reload + 1)), 0);
    assert_eq!(clock / ((prescaler + 1) * (reload + 1)), TICK_HZ);
    assert_eq!(chip.target.word(NVIC_ISER0).unwrap(), 1 << 28, "TIM2 and nothing else");
}

/// Offset and bit of each device's clock (RM0090, 7.3.10 to 7.3.14): without it a write is lost.
const CLOCK_OF: [(&str, u32, u32); 4] =
    [("GPIOA", 0x30, 0), ("GPIOB", 0x30, 1), ("GPIOC", 0x30, 2), ("timer[1]", 0x44, 0)];

fn every_device_has_a_clock(accesses: &[Access]) {
    for (device, offset, bit) in CLOCK_OF {
        let first = accesses.iter().position(|access| access.device == device).expect(device);
        let clocked = |access: &Access| {
            let enables = access.written.is_some_and(|value| value >> bit & 1 == 1);
            access.device == "RCC" && access.offset == offset && enables
        };
        assert!(accesses[..first].iter().any(clocked), "{device} is used without its clock");
    }
    // TIM2 to TIM4 are modelled: their accesses are not in the log.
    for bit in 0..3 {
        let enables = |access: &Access| access.written.is_some_and(|value| value >> bit & 1 == 1);
        let clocked = accesses.iter().any(|a| a.device == "RCC" && a.offset == 0x40 && enables(a));
        assert!(clocked, "TIM{} without its clock", bit + 2);
    }
}

/// The enable switch reads as open: PB14 is low before it is an output, and stays so. No overrun: the fault light
/// at PC13, on when low, stays off. Every tick feeds the watchdog.
fn drives_stay_off_and_the_watchdog_is_fed(accesses: &[Access], ticks: usize) {
    let written = |device: &'static str, offset: u32| {
        let is = move |access: &&Access| access.device == device && access.offset == offset;
        accesses.iter().filter(is).filter_map(|access| access.written)
    };
    let low_before = |device, bit: u32, mode: u32| {
        let position = |offset: u32, bits: u32| {
            let is = |access: &Access| {
                let sets = access.written.is_some_and(|value| value & bits != 0);
                access.device == device && access.offset == offset && sets
            };
            accesses.iter().position(is)
        };
        position(0x18, bit).unwrap() < position(0, mode).unwrap()
    };
    assert!(low_before("GPIOB", 1 << (14 + 16), 1 << (2 * 14)), "PB14 is an output before it is low");
    assert!(written("GPIOB", 0x18).all(|bits| bits & 1 << 14 == 0), "PB14 was set");
    assert!(written("GPIOC", 0x18).all(|bits| bits & 1 << (13 + 16) == 0), "the fault light was on");
    // Compare values of PWM channels 1 and 2 of TIM1.
    for offset in [0x34, 0x38] {
        assert!(written("timer[1]", offset).all(|counts| counts == 0), "a duty");
        assert!(written("timer[1]", offset).count() >= ticks, "every tick sets a duty");
    }
    // QEMU maps another device without registers over the watchdog: either name may be logged.
    let key = |value: u32| {
        let keys = written("IWDG", 0).chain(written("I2S2ext", 0));
        keys.filter(move |&written| written == value).count()
    };
    assert_eq!(key(0xcccc), 1, "the watchdog is started once");
    assert!(key(0xaaaa) >= ticks, "{} meals in {ticks} ticks", key(0xaaaa));
}
