//! Local profile: not committed.
#![no_std]
#![no_main]
use core::hint::black_box;
use core::panic::PanicInfo;
use cortex_m_rt::entry;
use cortex_m_semihosting::debug::{EXIT_FAILURE, EXIT_SUCCESS, exit};
use cortex_m_semihosting::hprintln;
use firmware::cost::motion::{self, PROGRAM, TICKS, Tick};
use firmware::emulated::InstructionMeter;
use shared::machine::Machine;
use shared::scalar::{Fixed, Scalar};
use shared::session::Meter;

#[inline(never)]
#[unsafe(no_mangle)]
fn profiled_tick(machine: &mut Machine<Fixed, 2>, tick: &Tick<Fixed>) {
    black_box(machine.tick(&tick.readings));
}

#[inline(never)]
fn go(meter: &mut InstructionMeter) -> Option<()> {
    let mut ticks: [Tick<Fixed>; TICKS] = core::array::from_fn(|_| Tick::empty());
    motion::record(&mut ticks)?;
    let mut counts = [0u32; TICKS];
    let mut machine = motion::machine::<Fixed>(&PROGRAM)?;
    let machine = black_box(&mut machine);
    for (tick, count) in ticks.iter().zip(&mut counts) {
        meter.start();
        profiled_tick(machine, tick);
        *count = meter.stop();
    }
    let at: usize = counts.iter().enumerate().skip(1).max_by_key(|c| c.1)?.0;
    counts.sort_unstable();
    hprintln!(
        "median {} p90 {} worst {} at {}",
        counts[TICKS / 2],
        counts[TICKS * 9 / 10],
        counts[TICKS - 2],
        at
    );
    let check = ticks.iter().fold(0u64, |h, t| {
        let h = (h ^ t.output.forces[0].bits()).wrapping_mul(0x100_0000_01b3);
        (h ^ t.output.forces[1].bits() ^ (t.output.commands[0].0 as u64)).wrapping_mul(0x100_0000_01b3)
    });
    hprintln!("check {:016x}", check);
    Some(())
}

#[entry]
fn main() -> ! {
    let mut meter = InstructionMeter::new(cortex_m::Peripherals::take().unwrap().SYST);
    let ended = go(&mut meter);
    exit(if ended.is_some() { EXIT_SUCCESS } else { EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    hprintln!("{}", info);
    exit(EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
