//! The controller on an STM32G474: a timer interrupt runs the tick, 20,000 times a second. It has never run on a chip.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use firmware::g474::chip::Chip;
use firmware::g474::{nmi_was_of_settings, stage};

#[rtic::app(device = stm32g4::stm32g474)]
mod app {
    use firmware::g474::can_port;
    use firmware::g474::chip::Chip;
    use firmware::g474::flash::SettingsFlash;
    use firmware::g474::{self, CAPTURE_BYTES, IDENTITY, Memory, Parts, Settings, settings_memory, uart};
    use firmware::setup::{AXES, LINK_SETTINGS};
    use firmware::two_drives::Drive;
    use firmware::two_drives::locked::Locked;
    use firmware::two_drives::serial::Queues;
    use shared::link::{Receiver, Server, SharedDrive};
    use shared::machine::Machine;
    use shared::safety::Fault;
    use shared::scalar::Fixed;

    type Hardware = g474::Hardware<Chip>;
    type Ports = g474::Ports<Chip>;
    type Watchdog = g474::watchdog::Watchdog<Chip>;

    #[shared]
    struct Shared {
        drive: Drive,
    }

    #[local]
    struct Local {
        hardware: Hardware,
        watchdog: Watchdog,
        serial: uart::UartInterrupt<Chip>,
        can: can_port::CanInterrupt<Chip>,
        ports: Ports,
        /// Taken by the idle loop, with the fault that ended the previous run.
        start: Option<(SettingsFlash<Chip>, Option<Fault>)>,
    }

    #[init(local = [
        machine: Machine<Fixed, AXES> = Machine::UNCONFIGURED,
        serial_queues: Queues = [const { heapless::spsc::Queue::new() }; 2],
        can_queues: can_port::Queues = [const { heapless::spsc::Queue::new() }; 2],
        receiver: Receiver = Receiver::NEW,
        capture: [u8; CAPTURE_BYTES] = [0; CAPTURE_BYTES],
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources { machine, serial_queues, can_queues, receiver, capture, .. } =
            context.local;
        let mut processor = context.core;
        processor.DCB.enable_trace();
        processor.DWT.enable_cycle_counter();
        let memory = Memory { machine, serial: serial_queues, can: can_queues, receiver, capture };
        // SAFETY: the devices of the context are used by nothing else.
        let parts = Parts::new(unsafe { Chip::new() }, memory);
        let Parts { hardware, drive, ports, serial, can, watchdog, flash, previous_fault } =
            parts.expect("the values are verified by a test on the host, and the flash has two banks");
        let start = Some((flash, previous_fault));
        (Shared { drive }, Local { hardware, watchdog, serial, can, ports, start })
    }

    /// One round of the idle loop.
    #[inline(never)]
    fn serve(
        server: &mut Server<AXES>,
        ports: &mut Ports,
        drive: &mut impl SharedDrive<'static, Fixed, AXES>,
        memory: &mut Settings<Chip>,
    ) {
        ports.service(drive);
        server.poll(ports, drive, memory);
    }

    /// Loads the settings, then serves the link, between ticks.
    #[idle(
        local = [ports, start, server: Server<AXES> = Server::new(IDENTITY, LINK_SETTINGS)],
        shared = [drive]
    )]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { ports, start, server, .. } = context.local;
        let mut drive = Locked(context.shared.drive);
        let (flash, previous_fault) = start.take().expect("set by init");
        let mut memory = settings_memory(flash);
        server.load(&mut drive, &mut memory, previous_fault);
        loop {
            serve(server, ports, &mut drive, &mut memory);
        }
    }

    #[task(binds = TIM2, priority = 1, local = [hardware, watchdog], shared = [drive])]
    fn tick(context: tick::Context) {
        let tick::LocalResources { hardware, watchdog, .. } = context.local;
        let mut drive = context.shared.drive;
        hardware.begin_tick();
        watchdog.feed();
        drive.lock(|drive| drive.tick(hardware));
    }

    /// Above the tick: a byte arrives every 10 µs.
    #[task(binds = USART3, priority = 2, local = [serial])]
    fn serial(context: serial::Context) {
        context.local.serial.service();
    }

    /// Above the tick: a frame of 64 bytes arrives every 350 µs, and the device holds three.
    #[task(binds = FDCAN1_IT0, priority = 2, local = [can])]
    fn can(context: can::Context) {
        context.local.can.service();
    }
}

/// The registers, for what switches the drives off.
fn chip() -> Chip {
    // SAFETY: only what switches off, and the flags of an interrupt.
    unsafe { Chip::new() }
}

/// A panic, possible only during start-up: drives off until a reset by the watchdog or by hand.
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    stop()
}

/// A processor fault. The default handler would leave the drives as they are.
#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    stop()
}

/// Failure of the crystal, of which the hardware has stopped the PWM; or settings that a loss of power has left half programmed, which are
/// being read: these are refused by their checksums.
#[exception]
unsafe fn NonMaskableInt() {
    if !nmi_was_of_settings(chip()) {
        stop();
    }
}

/// An interrupt or exception without a handler.
#[exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    stop()
}

fn stop() -> ! {
    cortex_m::interrupt::disable();
    loop {
        stage::cut(chip());
    }
}
