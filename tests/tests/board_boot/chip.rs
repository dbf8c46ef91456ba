//! The emulator with the program, and how it is run.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use tempfile::TempDir;
use tests::chip::image::Image;
use tests::chip::vectors::Vectors;
use tests::chip::walk::panics;
use tests::firmware::{FLASH, RAM, TICK};
use tests::gdb::{Halt, PC, Target, Trouble, Watch};

use crate::clocks::Clocks;
use crate::log::Log;

/// All ticks have to be over within this time: a thousand take four seconds on a slow machine.
const DEADLINE: Duration = Duration::from_secs(40);

/// How often the log is looked at.
const LOOK: Duration = Duration::from_millis(50);

/// What the free RAM is filled with.
const PATTERN: u8 = 0xa5;

/// The emulated chip with its program, halted.
pub struct Chip {
    pub image: Image,
    pub vectors: Vectors,
    pub target: Target,
    pub clocks: Clocks,
    pub log: Log,
    /// For the log and for what the emulator says.
    folder: TempDir,
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
    pub fn start(program: &Path) -> Self {
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
        let mut chip = Self { image, vectors, target, clocks: Clocks::new(), log, folder };
        chip.prepare().unwrap();
        chip
    }

    /// Fills the free RAM and says where to halt.
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

    /// Runs until so many ticks have begun, or until it is at one of its ends, and halts it there.
    pub fn run(&mut self, ticks: usize) -> Result<End, Trouble> {
        let began = Instant::now();
        self.target.run()?;
        loop {
            // A program that waits for a bit that never comes halts at each look at it.
            assert!(began.elapsed() < DEADLINE, "too slow; {}", self.words());
            match self.target.halted(LOOK)? {
                Some(Halt::Read(address) | Halt::Write(address)) => {
                    self.clocks.answer(&mut self.target, &self.image, address)?;
                    self.target.run()?;
                }
                Some(Halt::Here) => {
                    let at = self.target.register(PC)?;
                    let (_, function) = self.image.function_at(at).unwrap();
                    return Ok(End::Entered(function.names[0].clone()));
                }
                None if self.log.exceptions().len() >= ticks => break,
                None => {}
            }
        }
        self.target.stop().map(|_| End::Ticked)
    }

    /// What the emulator has said.
    pub fn words(&self) -> String {
        let errors = fs::read_to_string(self.folder.path().join("errors")).unwrap_or_default();
        let begun = self.log.exceptions().len();
        format!("{begun} exceptions so far. The emulator: {errors}\n{}", self.log.end())
    }

    fn floor(&self) -> u32 {
        self.vectors.stack_floor(&self.image, &RAM)
    }

    /// Bytes below the start of the stack that are not the pattern any more, and those above the data.
    pub fn stack(&mut self) -> Result<[u32; 2], Trouble> {
        let (floor, top) = (self.floor(), self.vectors.initial_sp);
        let bytes = self.target.memory(floor, (top - floor) as usize)?;
        let untouched = bytes.iter().take_while(|&&byte| byte == PATTERN).count();
        Ok([top - floor - u32::try_from(untouched).unwrap(), top - floor])
    }
}
