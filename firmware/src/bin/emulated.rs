//! The controller on an emulated Cortex-M4F, in step with a host: one frame in, one frame out.
//!
//! `docs/firmware.md` describes how to start QEMU.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use firmware::emulated::{Host, InstructionMeter};
use shared::protocol::{FRAME, encode};
use shared::session::Session;

#[entry]
fn main() -> ! {
    let ended = run();
    exit(if ended.is_some() { EXIT_SUCCESS } else { EXIT_FAILURE });
    stop()
}

/// Answers orders until the host ends the run. `None` if the connection is lost before.
fn run() -> Option<()> {
    let mut host = Host::open()?;
    let mut meter = InstructionMeter::new(cortex_m::Peripherals::take()?.SYST);
    let session = cortex_m::singleton!(: Session = Session::NEW)?;
    let mut frame = [0; FRAME];
    loop {
        host.receive(&mut frame)?;
        let Some(answer) = session.answer(&frame, &mut meter) else {
            return Some(());
        };
        encode(&answer, &mut frame).ok()?;
        host.send(&frame)?;
    }
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    exit(EXIT_FAILURE);
    stop()
}

/// Not reached: the emulator has ended.
fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
