//! The environment of the emulated core: a host connected by two pipes, and an instruction counter.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_semihosting::{nr, syscall};
use shared::lockstep::protocol::FRAME;
use shared::lockstep::session::Meter;

/// The name by which semihosting opens standard input or output.
const CONSOLE: &[u8] = b":tt\0";

/// Standard input and output of the emulator.
pub struct Host {
    input: usize,
    output: usize,
}

impl Host {
    /// Opens both. `None` if the emulator runs without semihosting.
    #[must_use]
    pub fn open() -> Option<Self> {
        let console = |mode: usize| {
            // SAFETY: SYS_OPEN reads a name of the given length, which is static.
            let handle = unsafe { syscall!(OPEN, CONSOLE.as_ptr(), mode, CONSOLE.len() - 1) };
            (handle != usize::MAX).then_some(handle)
        };
        Some(Self { input: console(nr::open::R)?, output: console(nr::open::W_TRUNC)? })
    }

    /// Waits for a whole frame. `None` once the host has closed its end.
    pub fn receive(&mut self, frame: &mut [u8; FRAME]) -> Option<()> {
        let mut remaining = frame.as_mut_slice();
        while !remaining.is_empty() {
            let requested = remaining.len();
            // SAFETY: SYS_READ writes at most `requested` bytes into `remaining`.
            let missing = unsafe { syscall!(READ, self.input, remaining.as_mut_ptr(), requested) };
            let read = requested.checked_sub(missing).filter(|&read| read > 0)?;
            remaining = remaining.get_mut(read..)?;
        }
        Some(())
    }

    /// Sends a whole frame. `None` once the host has closed its end.
    pub fn send(&mut self, frame: &[u8; FRAME]) -> Option<()> {
        let mut remaining = frame.as_slice();
        while !remaining.is_empty() {
            let requested = remaining.len();
            // SAFETY: SYS_WRITE reads at most `requested` bytes of `remaining`.
            let missing = unsafe { syscall!(WRITE, self.output, remaining.as_ptr(), requested) };
            let written = requested.checked_sub(missing).filter(|&written| written > 0)?;
            remaining = remaining.get(written..)?;
        }
        Some(())
    }
}

/// Emulated time per instruction, ns: `-icount shift=10`.
const NS_PER_INSTRUCTION: u32 = 1024;

/// Period of the system timer, ns: 25 MHz.
const NS_PER_COUNT: u32 = 40;

/// Start value of the down-counting timer, 24 bits: 0.67 s, 655,000 instructions.
const RELOAD: u32 = 0x00ff_ffff;

/// Counts instructions with the system timer. An instruction takes 25.6 counts, so that the rounding to a whole count does not
/// affect the result.
pub struct InstructionMeter {
    /// Owned, so that it is not reconfigured.
    _timer: SYST,
    started: u32,
    /// Counts of an empty measurement.
    overhead: u32,
}

impl InstructionMeter {
    /// Starts the timer and measures the overhead.
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
        // The timer counts down from `started` and wraps at most once.
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
