//! Counts the instructions of each part of a tick on an emulated Cortex-M4F: `cargo cost`.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hprintln;
use firmware::cost::count::Counter;
use firmware::cost::parts::{of_the_path, of_the_tick};
use firmware::emulated::InstructionMeter;
use shared::scalar::Fixed;

#[entry]
fn main() -> ! {
    let ended = run();
    exit(if ended.is_some() { EXIT_SUCCESS } else { EXIT_FAILURE });
    stop()
}

/// Prints the table. `None` if the machine rejects its settings or does not complete the motion.
fn run() -> Option<()> {
    let meter = InstructionMeter::new(cortex_m::Peripherals::take()?.SYST);
    let mut counter = Counter::new(meter);
    counter.print_header();
    of_the_path(&mut counter)?;
    of_the_tick::<Fixed>(&mut counter)?;
    of_the_tick::<f32>(&mut counter)?;
    of_the_tick::<f64>(&mut counter)
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    hprintln!("{}", info);
    exit(EXIT_FAILURE);
    stop()
}

/// Not reached: the emulator has ended.
fn stop() -> ! {
    loop {
        cortex_m::asm::wfi();
    }
}
