//! Counts the instructions of each part of a tick on an emulated Cortex-M4F: `cargo cost`.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use firmware::cost::count::Counter;
use firmware::cost::parts::{of_the_path, of_the_tick, of_the_tick_of_the_board};
use firmware::emulated::InstructionMeter;
use firmware::emulator::end;
use shared::scalar::Fixed;

#[entry]
fn main() -> ! {
    end(run().is_some())
}

/// Prints the table. `None` if the machine rejects its settings or does not complete the motion.
fn run() -> Option<()> {
    let meter = InstructionMeter::new(cortex_m::Peripherals::take()?.SYST);
    let mut counter = Counter::new(meter);
    counter.print_header();
    of_the_path(&mut counter)?;
    of_the_tick_of_the_board(&mut counter)?;
    of_the_tick::<Fixed>(&mut counter)?;
    of_the_tick::<f32>(&mut counter)?;
    of_the_tick::<f64>(&mut counter)
}
