//! What the emulated core has instead of a board: a host at the end of two pipes, and a counter of
//! instructions.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{nr, syscall};
use shared::protocol::FRAME;
use shared::session::Meter;

/// A name that semihosting opens as standard input or output.
const CONSOLE: &[u8] = b":tt\0";

/// Standard input and output of the emulator.
pub struct Host {
    input: usize,
    output: usize,
}

impl Host {
    /// Opens both. `None` where the emulator runs without semihosting.
    #[must_use]
    pub fn open() -> Option<Self> {
        let console = |mode: usize| {
            // SAFETY: SYS_OPEN reads a name of the given length, which lives for ever.
            let handle = unsafe { syscall!(OPEN, CONSOLE.as_ptr(), mode, CONSOLE.len() - 1) };
            (handle != usize::MAX).then_some(handle)
        };
        Some(Self { input: console(nr::open::R)?, output: console(nr::open::W_TRUNC)? })
    }

    /// Waits for a whole frame. `None` once the host has closed its end.
    pub fn receive(&mut self, frame: &mut [u8; FRAME]) -> Option<()> {
        let mut rest = frame.as_mut_slice();
        while !rest.is_empty() {
            let wanted = rest.len();
            // SAFETY: SYS_READ writes at most `wanted` bytes into `rest`.
            let missing = unsafe { syscall!(READ, self.input, rest.as_mut_ptr(), wanted) };
            let read = wanted.checked_sub(missing).filter(|&read| read > 0)?;
            rest = rest.get_mut(read..)?;
        }
        Some(())
    }

    /// Sends a whole frame. `None` once the host has closed its end.
    pub fn send(&mut self, frame: &[u8; FRAME]) -> Option<()> {
        let mut rest = frame.as_slice();
        while !rest.is_empty() {
            let wanted = rest.len();
            // SAFETY: SYS_WRITE reads at most `wanted` bytes of `rest`.
            let missing = unsafe { syscall!(WRITE, self.output, rest.as_ptr(), wanted) };
            let written = wanted.checked_sub(missing).filter(|&written| written > 0)?;
            rest = rest.get(written..)?;
        }
        Some(())
    }
}

/// Nanoseconds of the emulator's clock for an instruction: `-icount shift=10`.
const NS_PER_INSTRUCTION: u32 = 1024;

/// Nanoseconds of a count of the system timer, which runs at 25 MHz.
const NS_PER_COUNT: u32 = 40;

/// The timer counts down from here: 0.67 s, 655,000 instructions.
const RELOAD: u32 = 0x00ff_ffff;

/// Counts instructions with the system timer. With 25.6 counts an instruction the rounding to whole
/// counts, one at most, leaves the number exact.
pub struct InstructionMeter {
    /// Held so that nobody else sets it.
    _timer: SYST,
    started: u32,
    /// Counts of a measurement of nothing.
    overhead: u32,
}

impl InstructionMeter {
    /// Starts the timer and measures nothing once.
    #[must_use]
    pub fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
        let mut meter = Self { _timer: timer, started: 0, overhead: 0 };
        meter.start();
        meter.overhead = meter.counts();
        meter
    }

    #[inline]
    fn counts(&self) -> u32 {
        compiler_fence(Ordering::SeqCst);
        let now = SYST::get_current();
        // Down from `started`, round the 24 bits once at most.
        self.started.wrapping_sub(now) & RELOAD
    }
}

impl Meter for InstructionMeter {
    #[inline]
    fn start(&mut self) {
        self.started = SYST::get_current();
        compiler_fence(Ordering::SeqCst);
    }

    #[inline]
    fn stop(&mut self) -> u32 {
        let ns = self.counts().saturating_sub(self.overhead) * NS_PER_COUNT;
        (ns + NS_PER_INSTRUCTION / 2) / NS_PER_INSTRUCTION
    }
}
