//! An STM32F405 with two drives. The wiring table is in `docs/firmware.md`.

mod clock;
mod converter;
mod dac;
pub mod flash;
pub mod link;
mod quadrature;
mod registers;
mod stage;
mod supply;
mod switches;
mod tick;
pub mod uart;
pub mod usb;
pub mod watchdog;

use shared::link::report::Identity;
use shared::link::{HostedDrive, TwoPorts};
use shared::machine::Machine;
use shared::safety::Fault;
use shared::scalar::Fixed;
use stm32f4xx_hal::gpio::{PinState, Pull};

use stm32f4xx_hal::pac::{FLASH, Peripherals};
use stm32f4xx_hal::prelude::*;

use crate::f405::{CORE_HZ, IDENTITY};
use crate::setup::{self, AXES, SetupError};
use crate::two_drives::serial::Queues;
use crate::two_drives::{self, Drive, zero_volts};
use converter::Converters;
use dac::AnalogOutputs;
use registers::ChipRegisters;
use stage::{Pins, Stages};
use supply::SupplyDetector;
use tick::TickTimer;
use watchdog::Watchdog;

/// The pins and timers of a tick.
pub type Hardware = two_drives::Hardware<ChipRegisters>;

/// The parts of the board that run independently of each other.
pub struct Parts {
    /// For the tick.
    pub hardware: Hardware,
    /// The controller, for the tick and the server of the link.
    pub drive: Drive,
    /// Ports of the link, for the server.
    pub ports: usb::Ports,
    /// The serial port, for its interrupt.
    pub interrupt: uart::UartInterrupt,
    /// Fed by each tick.
    pub watchdog: Watchdog,
    /// For the settings.
    pub flash: FLASH,
    /// The fault that ended the previous run.
    pub previous_fault: Option<Fault>,
}

impl Parts {
    /// Initialises clocks, pins and timers, configures the machine, and starts the ticks with the drives off.
    ///
    /// # Errors
    /// [`SetupError`] for an invalid value in [`setup`].
    pub fn new(
        device: Peripherals,
        machine: &'static mut Machine<Fixed, AXES>,
        queues: &'static mut Queues,
    ) -> Result<Self, SetupError> {
        // Read at run time, so that what is built and tested has every alternative of the table.
        let table = core::hint::black_box(&setup::TABLE);
        let mut rcc = device.RCC.constrain();
        // The stages are disabled first, before the wait for the crystal.
        let b = device.GPIOB.split(&mut rcc);
        let enable = b.pb14.into_push_pull_output_in_state(PinState::Low);
        let brakes = device.GPIOD.split(&mut rcc).pd2.into_push_pull_output_in_state(PinState::Low);
        let previous_fault = clock::previous_fault(&rcc);

        let mut rcc = clock::set_up(rcc);
        let (a, c) = (device.GPIOA.split(&mut rcc), device.GPIOC.split(&mut rcc));
        let analog = (a.pa4.into_analog(), a.pa5.into_analog());
        let analog = AnalogOutputs::new(device.DAC, analog, table.map(zero_volts), &mut rcc);
        let pins = Pins::new(enable, brakes, (c.pc10, c.pc11));
        // With the pull-down, a broken wire stops the drives.
        let stop = b.pb12.into_alternate().internal_resistor(Pull::Down);
        let pwm = (a.pa8.into_alternate(), a.pa9.into_alternate(), stop);
        let stages = Stages::new(device.TIM1, pins, pwm, analog, &mut rcc);
        // Pull-ups: an open input does not float.
        macro_rules! counter_inputs {
            ($($pin:expr => $function:literal,)*) => {
                let _ = ($($pin.into_alternate::<$function>().internal_resistor(Pull::Up),)*);
            };
        }
        counter_inputs! {
            a.pa6 => 2, a.pa7 => 2, b.pb0 => 2,
            b.pb6 => 2, b.pb7 => 2, b.pb8 => 2,
            a.pa0 => 2, a.pa1 => 2, a.pa2 => 2,
            c.pc6 => 3, c.pc7 => 3, c.pc8 => 3,
        }
        let (supply, x) =
            ((c.pc0.into_analog(), c.pc1.into_analog()), (c.pc2.into_analog(), c.pc3.into_analog()));
        let pins = (supply, x, (c.pc4.into_analog(), c.pc5.into_analog()));
        let converters = Converters::new(device.ADC1, device.ADC2, &device.ADC_COMMON, pins, &mut rcc);
        let timers = quadrature::start((device.TIM3, device.TIM4, device.TIM5, device.TIM8), &mut rcc);
        switches::set_up(
            (a.pa3, a.pa10, a.pa15),
            (b.pb1, b.pb2, b.pb3, b.pb5, b.pb9, b.pb13, b.pb15),
            (c.pc9, c.pc12),
        );
        // With the pull-up, a port without a cable receives nothing.
        let pins = (b.pb10.into_alternate(), b.pb11.into_alternate().internal_resistor(Pull::Up));
        let (uart, interrupt) = uart::start(device.USART3, pins, queues, &mut rcc);
        // SAFETY: the peripherals exist once.
        let (capture, usb_memory) = unsafe { link::core_coupled_memory() };
        let core = (device.OTG_FS_GLOBAL, device.OTG_FS_DEVICE, device.OTG_FS_PWRCLK);
        let usb_pins = (a.pa11.into_alternate(), a.pa12.into_alternate());
        let ports = TwoPorts::new(uart, usb::start(core, usb_pins, usb_memory, &mut rcc));

        let system = setup::drive_system(machine, stages.full_counts(), setup::tick_clock(CORE_HZ))?;
        let Identity { tick_hz, times, steps, .. } = &IDENTITY;
        let drive = HostedDrive::new(system, *tick_hz, *times, steps, capture);
        let watchdog = Watchdog::start(device.IWDG);

        let full_counts = stages.full_counts();
        let registers = ChipRegisters {
            stages,
            supply: SupplyDetector::start(device.PWR, &mut rcc),
            converters,
            fault_light: c.pc13.into_push_pull_output_in_state(PinState::High),
            tick_timer: TickTimer::new(device.TIM2, &mut rcc),
        };
        let hardware = Hardware::new(table, registers, timers, full_counts)?;
        Ok(Self { hardware, drive, ports, interrupt, watchdog, flash: device.FLASH, previous_fault })
    }
}

/// Starts the counter of the clock cycles of the core, by which the ticks are timed. To be called before they start.
pub fn start_cycle_counter(mut processor: cortex_m::Peripherals) {
    processor.DCB.enable_trace();
    processor.DWT.enable_cycle_counter();
}

/// Disables the power stages and closes the brakes, from any context and in any state of the program.
pub fn drives_off() {
    Stages::cut();
}
