//! The controller on an emulated Cortex-M4F, in step with a host: one frame in, one frame out.
//!
//! `docs/firmware.md` describes how to start QEMU.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use firmware::emulated::{Host, InstructionMeter};
use firmware::emulator::end;
use shared::lockstep::protocol::{FRAME, encode};
use shared::lockstep::session::Session;

#[entry]
fn main() -> ! {
    end(run().is_some())
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
