//! Ticks of the program that is flashed: they preempt the server, and late and missed ones are counted.

use shared::drive::TickCounts;
use shared::link::{Reply, Request};
use shared::safety::{Fault, Power};
use tests::board::End;
use tests::firmware::TICK;
use tests::gdb::{PC, SP, Watch};

use super::checks::power_stages;
use super::enabled_by_a_host;

/// Offset of the return address in the frame of an exception (ARMv7-M reference manual, B1.5.6).
const RETURN_ADDRESS: u32 = 24;

/// A part of the mangled name of the function of the server that executes a request.
const SERVER: &str = "21execute_without_flash";

/// A tick that is pended while the server executes a request starts there, ends, and returns to the same instruction; then the request is
/// answered.
#[test]
fn a_tick_preempts_the_server() {
    let (mut chip, mut host) = enabled_by_a_host();
    let ticks = chip.ticks();
    let [server] = chip.image.named(|name| name.contains(SERVER))[..] else { panic!("one function") };
    let tick = chip.vectors.handler(TICK);
    chip.target.watch(Watch::Run, server).unwrap();
    host.send(&Request::Status);
    let Ok(End::Entered(_)) = chip.run(ticks + 100) else { panic!("{}", chip.diagnostics()) };
    assert_eq!(chip.target.register(PC), Ok(server));

    chip.target.watch(Watch::Run, tick).unwrap();
    chip.pend_tick().unwrap();
    let Ok(End::Entered(_)) = chip.run(ticks + 100) else { panic!("{}", chip.diagnostics()) };
    assert_eq!(chip.target.register(PC), Ok(tick));
    let frame = chip.target.register(SP).unwrap();
    assert_eq!(chip.target.word(frame + RETURN_ADDRESS), Ok(server));
    chip.target.unwatch(Watch::Run, tick).unwrap();

    let Ok(End::Entered(_)) = chip.run(ticks + 100) else { panic!("{}", chip.diagnostics()) };
    assert_eq!(chip.target.register(PC), Ok(server));
    chip.target.unwatch(Watch::Run, server).unwrap();
    let ticks = chip.ticks();
    assert_eq!(chip.run(ticks + 40), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status; {}", chip.diagnostics()) };
    assert_eq!(status.power, Power::On);
}

/// A tick that starts two periods late, by the cycles of the core, counts two missed ones and switches the drives off itself.
#[test]
fn missed_ticks_are_counted_and_switch_the_drives_off() {
    let (mut chip, mut host) = enabled_by_a_host();
    if let Some(inputs) = &mut chip.inputs {
        inputs.lost = 2;
    }
    let ticks = chip.ticks();
    assert_eq!(chip.run(ticks + 3), Ok(End::Ticked), "{}", chip.diagnostics());
    assert_eq!(power_stages(&chip.log.accesses()), [false, false]);
    host.send(&Request::Status);
    let ticks = chip.ticks();
    assert_eq!(chip.run(ticks + 40), Ok(End::Ticked), "{}", chip.diagnostics());
    let Some(Reply::Status(status)) = host.reply() else { panic!("no status") };
    assert_eq!(status.power, Power::Faulted(Fault::Overrun));
    assert_eq!(status.ticks, TickCounts { late: 0, missed: 2, longest_delay_permille: 2000 });
}
