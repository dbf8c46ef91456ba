//! The controller on an STM32F405: a timer interrupt runs the tick, 20,000 times a second.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use firmware::board::drives_off;

#[rtic::app(device = stm32f4xx_hal::pac)]
mod app {
    use firmware::board::flash::{Settings, settings_memory};
    use firmware::board::uart::UartInterrupt;
    use firmware::board::usb::{self, Ports};
    use firmware::board::watchdog::Watchdog;
    use firmware::board::{Hardware, Parts, start_cycle_counter};
    use firmware::f405::IDENTITY;
    use firmware::setup::{AXES, LINK_SETTINGS};
    use firmware::two_drives::Drive;
    use firmware::two_drives::locked::Locked;
    use firmware::two_drives::serial::Queues;
    use rtic::Mutex;
    use shared::link::{Server, SharedDrive};
    use shared::machine::Machine;
    use shared::safety::Fault;
    use shared::scalar::Fixed;
    use stm32f4xx_hal::pac::FLASH;

    #[shared]
    struct Shared {
        drive: Drive,
        watchdog: Watchdog,
    }

    #[local]
    struct Local {
        hardware: Hardware,
        interrupt: UartInterrupt,
        ports: Ports,
        /// Taken by the idle loop, with the fault that ended the previous run.
        start: Option<(FLASH, Option<Fault>)>,
    }

    #[init(local = [
        machine: Machine<Fixed, AXES> = Machine::UNCONFIGURED,
        queues: Queues = [const { heapless::spsc::Queue::new() }; 2],
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources { machine, queues, .. } = context.local;
        start_cycle_counter(context.core);
        let parts = Parts::new(context.device, machine, queues);
        let Parts { hardware, drive, ports, interrupt, watchdog, flash, previous_fault } =
            parts.expect("the values are verified by a test on the host");
        let start = Some((flash, previous_fault));
        (Shared { drive, watchdog }, Local { hardware, interrupt, ports, start })
    }

    /// One round of the idle loop. A function of its own, which the test on the emulated chip counts.
    #[inline(never)]
    fn serve<W: Mutex<T = Watchdog>>(
        server: &mut Server<AXES>,
        ports: &mut Ports,
        drive: &mut impl SharedDrive<'static, Fixed, AXES>,
        memory: &mut Settings<W>,
    ) {
        usb::service(ports, drive);
        server.poll(ports, drive, memory);
    }

    /// Loads the settings, then serves the link, between ticks.
    #[idle(
        local = [ports, start, server: Server<AXES> = Server::new(IDENTITY, LINK_SETTINGS)],
        shared = [drive, watchdog]
    )]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { ports, start, server, .. } = context.local;
        let idle::SharedResources { drive, watchdog, .. } = context.shared;
        let mut drive = Locked(drive);
        let (flash, previous_fault) = start.take().expect("set by init");
        let mut memory = settings_memory(flash, watchdog);
        server.load(&mut drive, &mut memory, previous_fault);
        loop {
            serve(server, ports, &mut drive, &mut memory);
        }
    }

    #[task(binds = TIM2, priority = 1, local = [hardware], shared = [drive, watchdog])]
    fn tick(context: tick::Context) {
        let hardware = context.local.hardware;
        let tick::SharedResources { mut drive, mut watchdog, .. } = context.shared;
        hardware.begin_tick();
        watchdog.lock(Watchdog::feed);
        drive.lock(|drive| drive.tick(hardware));
    }

    /// Above the tick: a byte arrives every 10 µs.
    #[task(binds = USART3, priority = 2, local = [interrupt])]
    fn serial(context: serial::Context) {
        context.local.interrupt.service();
    }
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

/// Failure of the crystal: the clock security system has switched to the internal oscillator and has stopped the PWM by its
/// break.
#[exception]
unsafe fn NonMaskableInt() -> ! {
    stop()
}

/// An interrupt or exception without a handler.
#[exception]
unsafe fn DefaultHandler(_: i16) -> ! {
    stop()
}

fn stop() -> ! {
    cortex_m::interrupt::disable();
    loop {
        drives_off();
    }
}
