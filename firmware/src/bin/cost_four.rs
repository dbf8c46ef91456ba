//! Counts the instructions of the tick of four axes on an emulated Cortex-M4F: `cargo cost-four`.
//!
//! A program of its own: what the compiler inlines in `cost` depends on everything that is in it.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use firmware::cost::count::Counter;
use firmware::cost::four_axes::of_the_tick_of_four_axes;
use firmware::emulated::InstructionMeter;
use firmware::emulator::end;

#[entry]
fn main() -> ! {
    end(run().is_some())
}

/// Prints the table. `None` if the machine rejects its settings or does not complete the motion.
fn run() -> Option<()> {
    let mut counter = Counter::new(InstructionMeter::new(cortex_m::Peripherals::take()?.SYST));
    counter.print_header();
    of_the_tick_of_four_axes(&mut counter)
}
