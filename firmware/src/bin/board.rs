//! The controller on an STM32F405: a timer interrupt runs the tick, 20,000 times a second.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};
use firmware::board::drives_off;

#[rtic::app(device = stm32f4xx_hal::pac)]
mod app {
    use firmware::board::link::{Drive, Locked};
    use firmware::board::uart::{Queues, Uart, UartInterrupt};
    use firmware::board::{Hardware, Parts};
    use firmware::setup::{AXES, IDENTITY, LINK_SETTINGS};
    use shared::link::{Server, SharedDrive};
    use shared::machine::Machine;
    use shared::scalar::Fixed;

    #[shared]
    struct Shared {
        drive: Drive,
    }

    #[local]
    struct Local {
        hardware: Hardware,
        interrupt: UartInterrupt,
        uart: Uart,
    }

    #[init(local = [
        machine: Machine<Fixed, AXES> = Machine::UNCONFIGURED,
        queues: Queues = [const { heapless::spsc::Queue::new() }; 2],
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let init::LocalResources { machine, queues, .. } = context.local;
        let Parts { hardware, drive, uart, interrupt } = Parts::new(context.device, machine, queues)
            .expect("the values are verified by a test on the host");
        (Shared { drive }, Local { hardware, interrupt, uart })
    }

    /// One round of the idle loop. A function of its own, which the test on the emulated chip counts.
    #[inline(never)]
    fn serve(server: &mut Server, uart: &mut Uart, drive: &mut impl SharedDrive<'static, Fixed>) {
        server.poll(uart, drive);
    }

    /// Serves the link between ticks.
    #[idle(local = [uart, server: Server = Server::new(IDENTITY, LINK_SETTINGS)], shared = [drive])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources { uart, server, .. } = context.local;
        let mut drive = Locked(context.shared.drive);
        loop {
            serve(server, uart, &mut drive);
        }
    }

    #[task(binds = TIM2, priority = 1, local = [hardware], shared = [drive])]
    fn tick(mut context: tick::Context) {
        let hardware = context.local.hardware;
        hardware.begin_tick();
        context.shared.drive.lock(|drive| drive.tick(hardware));
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
