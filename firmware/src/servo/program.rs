//! The program of an emulated servo board: the system timer runs the tick, the idle loop serves the link.
//!
//! It is a module of each of the programs that differ in their number of axes ([`AXES`](crate::AXES)), as a static has one type.

use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::{self, Mutex};
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SCB, SYST};
use cortex_m_rt::{entry, exception};
use firmware::bench::{Bench, COUNTER_HZ, Constants, drive_system};
use firmware::emulator::end;
use firmware::servo::{END, Uart, operate, settings_memory};
use firmware::setup::TICK_HZ;
use shared::drive::{Board, DriveSignal, Inputs};
use shared::feedback::Reading;
use shared::link::{BytePort, HostedDrive, Identity, Server, SharedDrive};
use shared::machine::Machine;
use shared::scalar::Fixed;

use crate::AXES;

/// Clock of the system timer, Hz.
const CLOCK_HZ: u32 = 25_000_000;

/// The counter of the board, which runs freely at [`COUNTER_HZ`].
const COUNTER: *const u32 = 0x4002_8018 as *const u32;

/// Its counts in a period of the ticks.
const COUNTS_PER_TICK: u32 = COUNTER_HZ / TICK_HZ;

/// Memory for a recording, bytes: half a second of all axes at 20 kHz.
const CAPTURE_BYTES: usize = AXES * 40 * 1024;

/// What the board says about itself.
const IDENTITY: Identity<AXES> = Constants::<AXES>::IDENTITY;

/// The server at the start: a constant, so that it is not assembled on the stack.
const SERVER: Server<AXES> = Server::new(IDENTITY, Constants::<AXES>::SETTINGS);

/// Ticks without a byte from the link or the bench after which the emulator ends: ten minutes.
const ABANDONED_TICKS: u64 = 600 * TICK_HZ as u64;

/// Ticks after which an input of the bench has settled: 50 ms, beyond the 20 ms of the enable switch.
const SETTLED_TICKS: u64 = 1000;

/// Ticks after the last byte in which the program does not sleep: 0.2 s. The drives come on within them.
const AWAKE_TICKS: u64 = TICK_HZ as u64 / 5;

/// Ticks that one tick stands for while the program sleeps: it has one every 10 ms. Nothing that a tick could change is going on
/// then.
const ASLEEP: u32 = TICK_HZ / 100;

/// Ticks that each tick stands for.
static PACE: AtomicU32 = AtomicU32::new(1);

/// The drives, and the machine that they move.
struct Plant {
    drive: HostedDrive<'static, Fixed, AXES>,
    bench: Bench<AXES>,
}

/// Used by the tick and, between ticks, by the idle loop.
static PLANT: Mutex<RefCell<Option<Plant>>> = Mutex::new(RefCell::new(None));

/// The present count of the counter.
fn count() -> u32 {
    // SAFETY: a register of the chip, and a read has no effect.
    unsafe { COUNTER.read_volatile() }
}

/// Waits until the counter has gone on by a number of counts since a count.
fn wait_since(start: u32, counts: u32) {
    while count().wrapping_sub(start) < counts {}
}

/// The bench as a board whose next tick is due when the system timer has expired again.
struct Ticking<'a> {
    bench: &'a mut Bench<AXES>,
    started_at: u32,
}

impl Board<AXES, DriveSignal> for Ticking<'_> {
    fn readings(&mut self) -> [Reading; AXES] {
        self.bench.readings()
    }

    fn inputs(&mut self) -> Inputs<AXES> {
        self.bench.inputs()
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.bench.enable_switch_closed()
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.bench.hardware_stop_active()
    }

    fn set_signals(&mut self, signals: [DriveSignal; AXES]) {
        self.bench.set_signals(signals);
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.bench.set_enabled(enabled);
    }

    fn set_brakes_open(&mut self, open: bool) {
        self.bench.set_brakes_open(open);
    }

    fn set_light(&mut self, lit: bool) {
        self.bench.set_light(lit);
    }

    fn next_tick_due(&mut self) -> bool {
        if core::mem::take(&mut self.bench.operator_inputs().slow_tick) {
            wait_since(self.started_at, COUNTS_PER_TICK * 3 / 2);
        }
        SCB::is_pendst_pending()
    }

    fn started_at(&mut self) -> Option<u32> {
        Some(self.started_at)
    }
}

#[exception]
fn SysTick() {
    let started_at = count();
    interrupt::free(|section| {
        // Borrowed nowhere else: the idle loop borrows it with interrupts disabled.
        if let Ok(mut plant) = PLANT.borrow(section).try_borrow_mut()
            && let Some(Plant { drive, bench }) = plant.as_mut()
        {
            bench.step();
            drive.tick(&mut Ticking { bench, started_at });
            drive.skip(PACE.load(Ordering::Relaxed) - 1);
        }
    });
}

/// The drives, for the server.
struct Idle;

impl SharedDrive<'static, Fixed, AXES> for Idle {
    fn with<R>(&mut self, access: impl FnOnce(&mut HostedDrive<'static, Fixed, AXES>) -> R) -> R {
        with_plant(|plant| access(&mut plant.drive))
    }
}

fn with_plant<R>(access: impl FnOnce(&mut Plant) -> R) -> R {
    interrupt::free(|section| {
        let mut plant = PLANT.borrow(section).borrow_mut();
        access(plant.as_mut().expect("set before the idle loop"))
    })
}

#[entry]
fn main() -> ! {
    let _ = run();
    end(false)
}

/// Starts the ticks and serves the link. `None` if the board cannot be started.
#[expect(clippy::large_stack_arrays, reason = "the initial value of a static")]
fn run() -> Option<()> {
    let machine = cortex_m::singleton!(: Machine<Fixed, AXES> = Machine::UNCONFIGURED)?;
    let capture = cortex_m::singleton!(: [u8; CAPTURE_BYTES] = [0; CAPTURE_BYTES])?;
    let server = cortex_m::singleton!(: Server<AXES> = SERVER)?;
    let mut memory = settings_memory()?;
    let system = drive_system(machine).ok()?;
    let drive = HostedDrive::new(system, TICK_HZ, IDENTITY.times, &IDENTITY.steps, capture);
    let plant = Plant { drive, bench: Bench::new() };
    interrupt::free(|section| PLANT.borrow(section).replace(Some(plant)));
    // SAFETY: called once.
    let (mut link, mut bench) = unsafe { (Uart::link(), Uart::bench()) };
    let mut timer = cortex_m::Peripherals::take()?.SYST;
    timer.set_clock_source(SystClkSource::Core);
    timer.set_reload(CLOCK_HZ / TICK_HZ - 1);
    timer.clear_current();
    timer.enable_counter();
    timer.enable_interrupt();
    server.load(&mut Idle, &mut memory, None);
    // A host may have sent its requests before: the first reply has readings of a tick.
    while with_plant(|plant| plant.drive.now()) == 0 {
        cortex_m::asm::delay(PAUSE);
    }
    let mut served_at = 0;
    let (mut confirmed, mut settled_at) = (None, SETTLED_TICKS);
    loop {
        let mut port = Counted { port: &mut link, bytes: 0 };
        server.poll(&mut port, &mut Idle, &mut memory);
        let mut active = port.bytes > 0;
        let now = with_plant(|plant| plant.drive.now());
        // A switch is operated, and confirmed, when it has been as it was for longer than its settling time.
        if now >= settled_at {
            if let Some(byte) = confirmed.take() {
                bench.write(&[byte]);
            }
            if let Some(byte) = bench.read() {
                if byte == END {
                    end(true);
                }
                let known = with_plant(|plant| operate(plant.bench.operator_inputs(), byte));
                if with_plant(|plant| core::mem::take(&mut plant.bench.operator_inputs().held_off)) {
                    hold_off_ticks();
                }
                (confirmed, settled_at) = (Some(if known { byte } else { b'?' }), now + SETTLED_TICKS);
                active = true;
            }
        }
        if active {
            set_pace(&mut timer, 1);
            served_at = now;
        } else {
            if now - served_at > ABANDONED_TICKS {
                end(true);
            }
            let awake = now < AWAKE_TICKS + served_at || !with_plant(|plant| plant.drive.rests());
            set_pace(&mut timer, if awake { 1 } else { ASLEEP });
            wait(awake);
        }
    }
}

/// Holds off the ticks for two periods, from behind one on: the second tick is due before the first one can start.
fn hold_off_ticks() {
    let tick = || with_plant(|plant| plant.drive.now());
    let last = tick();
    while tick() == last {}
    let start = count();
    interrupt::free(|_| wait_since(start, 2 * COUNTS_PER_TICK));
}

/// Sets how many ticks a tick stands for.
#[inline(never)]
fn set_pace(timer: &mut SYST, ticks: u32) {
    interrupt::free(|_| {
        if PACE.load(Ordering::Relaxed) != ticks {
            PACE.store(ticks, Ordering::Relaxed);
            timer.set_reload(ticks * (CLOCK_HZ / TICK_HZ) - 1);
            timer.clear_current();
        }
    });
}

/// Counts the bytes that are received.
struct Counted<'a> {
    port: &'a mut Uart,
    bytes: usize,
}

impl BytePort for Counted<'_> {
    fn read(&mut self) -> Option<u8> {
        let byte = self.port.read();
        self.bytes += usize::from(byte.is_some());
        byte
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        self.port.write(bytes)
    }
}

/// Interrupts of the receivers of UART0 and UART1.
const RECEIVERS: [Interrupt; 2] = [Interrupt(0), Interrupt(2)];

#[derive(Clone, Copy)]
struct Interrupt(u16);

// SAFETY: the number of an interrupt of this chip.
unsafe impl interrupt::InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self.0
    }
}

/// Instructions between two looks at the ports: 8 µs of the emulated clock.
const PAUSE: u32 = 2000;

/// Lets time pass. Awake, by instructions: while a processor sleeps, QEMU takes the time from the host, which skips ticks when
/// it is late, and a drive that comes on then would find its next tick due. With the drives off and neither a direction check nor a host
/// there, a skipped tick does not matter, and the host has less to do.
fn wait(awake: bool) {
    if awake {
        cortex_m::asm::delay(PAUSE);
        return;
    }
    for receiver in RECEIVERS {
        // SAFETY: the handler only masks the interrupt again.
        unsafe { NVIC::unmask(receiver) };
    }
    cortex_m::asm::wfi();
}

/// A byte has been received: the idle loop reads it.
#[exception]
unsafe fn DefaultHandler(_: i16) {
    for receiver in RECEIVERS {
        NVIC::mask(receiver);
    }
}
