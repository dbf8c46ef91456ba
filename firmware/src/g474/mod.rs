//! An STM32G474RE with two drives. The wiring table is in `docs/firmware.md`.
//!
//! All of it is written for a [`Bus`](bus::Bus): a test runs it on a model of the registers. It has never run on a chip.

mod address;
pub mod bus;
mod can;
pub mod can_port;
#[cfg(feature = "board-g474")]
pub mod chip;
mod clock;
mod converter;
pub mod counters;
mod dac;
pub mod flash;
mod pins;
mod registers;
pub mod stage;
mod supply;
mod tick;
pub mod uart;
pub mod watchdog;

pub use clock::CORE_HZ;
pub use registers::ChipRegisters;

use shared::link::report::Identity;
use shared::link::two_ports::UsbPort;
use shared::link::{HostedDrive, Receiver, SettingsMemory, TwoPorts};
use shared::machine::Machine;
use shared::safety::Fault;
use shared::scalar::Fixed;
use shared::storage::Store;

use crate::setup::{self, AXES, SetupError};
use crate::two_drives::{self, Drive, zero_volts};
use bus::Bus;
use clock::Device;
use tick::TickTimer;
use watchdog::Watchdog;

/// The pins and timers of a tick.
pub type Hardware<B> = two_drives::Hardware<ChipRegisters<B>>;

/// The ports of the link: the serial port, and CAN where the STM32F405 has USB.
pub type Ports<B> = TwoPorts<'static, uart::Uart<B>, can_port::Can<B>>;

/// The settings in the flash of the chip.
pub type Settings<B> = SettingsMemory<flash::SettingsFlash<B>>;

/// What the board says about itself.
pub const IDENTITY: Identity<AXES> = setup::identity("STM32G474, two drives");

/// Greatest length of a recording, bytes. What the RAM has left.
pub const CAPTURE_BYTES: usize = 5 * 1024;

/// Memory of the board that is used once.
pub struct Memory {
    /// The controller.
    pub machine: &'static mut Machine<Fixed, AXES>,
    /// Queues of the serial port.
    pub serial: &'static mut two_drives::serial::Queues,
    /// Queues of CAN.
    pub can: &'static mut can_port::Queues,
    /// For what is received at the port that is not that of the host.
    pub receiver: &'static mut Receiver,
    /// For a recording.
    pub capture: &'static mut [u8],
}

/// Why the board does not start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StartError {
    /// A value of the table.
    Setup(SetupError),
    /// The option bits of the flash: one bank, or the banks exchanged.
    Banks,
}

impl From<SetupError> for StartError {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

/// The parts of the board that run independently of each other.
pub struct Parts<B: Bus> {
    /// For the tick.
    pub hardware: Hardware<B>,
    /// The controller, for the tick and the server of the link.
    pub drive: Drive,
    /// Ports of the link, for the server.
    pub ports: Ports<B>,
    /// The serial port, for its interrupt.
    pub serial: uart::UartInterrupt<B>,
    /// CAN, for its interrupt.
    pub can: can_port::CanInterrupt<B>,
    /// Fed by each tick.
    pub watchdog: Watchdog<B>,
    /// For the settings.
    pub flash: flash::SettingsFlash<B>,
    /// The fault that ended the previous run.
    pub previous_fault: Option<Fault>,
}

impl<B: Bus> Parts<B> {
    /// Initialises clocks, pins and timers, configures the machine, and starts the ticks with the drives off.
    ///
    /// # Errors
    /// [`StartError`]: the drives are off then.
    pub fn new(bus: B, memory: Memory) -> Result<Self, StartError> {
        let Memory { machine, serial, can, receiver, capture } = memory;
        // Read at run time, so that what is built and tested has every alternative of the table.
        let table = core::hint::black_box(&setup::TABLE);
        // The stages are disabled first, before the wait for the crystal.
        for port in Device::PORTS {
            port.enable(bus);
        }
        pins::set_up_outputs_of_drives(bus);
        let previous_fault = clock::previous_fault(bus);
        Device::PWR.enable(bus);
        clock::set_up(bus);
        if !flash::has_two_banks(bus) {
            return Err(StartError::Banks);
        }
        supply::start(bus);
        dac::start(bus, table.map(zero_volts));
        stage::start(bus);
        pins::set_up(bus);
        converter::start(bus);
        let timers = counters::start(bus, counters::scale_signals(table, counters::MASTERS));
        let (uart, serial_interrupt) = uart::start(bus, serial);
        let (can, can_interrupt) = can_port::start(bus, can);
        let ports = TwoPorts::new(uart, Some(UsbPort { port: can, receiver }));

        let system = setup::drive_system(machine, stage::FULL_COUNTS, setup::tick_clock(CORE_HZ))?;
        let Identity { tick_hz, times, steps, .. } = &IDENTITY;
        let drive = HostedDrive::new(system, *tick_hz, *times, steps, capture);
        let watchdog = Watchdog::start(bus);
        let registers = ChipRegisters { bus, tick_timer: TickTimer::start(bus) };
        let hardware = Hardware::new(table, registers, timers, stage::FULL_COUNTS)?;
        let flash = flash::SettingsFlash::new(bus);
        Ok(Self {
            hardware,
            drive,
            ports,
            serial: serial_interrupt,
            can: can_interrupt,
            watchdog,
            flash,
            previous_fault,
        })
    }
}

/// The settings in the flash.
///
/// # Panics
/// Never: the slots are constants that fit the flash.
pub fn settings_memory<B: Bus>(flash: flash::SettingsFlash<B>) -> Settings<B> {
    let store = Store::new(flash, flash::SLOTS, flash::BOARD);
    SettingsMemory::new(store.expect("the slots are constants that fit the flash"))
}

/// The non-maskable interrupt: true if it was raised by settings that a loss of power has left half programmed, so that the program goes
/// on; otherwise the crystal or the program has failed, and the drives have to be switched off.
pub fn nmi_was_of_settings(bus: impl Bus) -> bool {
    !clock::crystal_has_failed(bus) && flash::take_interrupted_word(bus)
}
