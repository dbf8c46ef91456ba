//! The USB port of the link: `OTG_FS` as a full-speed device on PA11 and PA12, without an interrupt and without VBUS sensing.
//!
//! VBUS sensing is at PA9, which is the PWM of Y: synopsys-usb-otg sets NOVBUSSENS for the cores in [`CORES`].
//!
//! Everything that belongs to it is in the core-coupled memory, which is accessed only if the core answers.

use core::mem::MaybeUninit;

use shared::link::two_ports::{TwoPorts, UsbPort};
use shared::link::{Receiver, SharedDrive};
use shared::scalar::Fixed;
use stm32f4xx_hal::gpio::{Alternate, PA11, PA12};
use stm32f4xx_hal::otg_fs::{USB, UsbBus};
use stm32f4xx_hal::pac::{OTG_FS_DEVICE, OTG_FS_GLOBAL, OTG_FS_PWRCLK};
use stm32f4xx_hal::rcc::{Enable, Rcc, Reset};
use usb_device::bus::UsbBusAllocator;

use super::uart::Uart;
use crate::f405::IDENTITY;
use crate::setup::{self, AXES};
use crate::usb_port::{CdcPort, UsbIdentity};

/// Product numbers of the cores whose VBUS sensing is switched off by NOVBUSSENS (RM0090, 34.16.2): STM32F405 and STM32F429.
const CORES: [u32; 2] = [0x1100, 0x1200];

/// Greatest number of reads of a register that is waited for, and processor cycles between them: 1 ms. A reset takes three cycles of
/// the 48 MHz clock (RM0090, 34.16.2, CSRST).
const READS: u32 = 1000;
const CYCLES: u32 = 168;

/// Bits of the reset register: the bus side is idle; a reset of the core, which the core clears.
const AHBIDL: u32 = 1 << 31;
const CSRST: u32 = 1;

/// Words of the endpoints that receive: 64 bytes each for control and data.
const ENDPOINT_WORDS: usize = 32;

/// Unique number of the chip (RM0090, 39.1): 96 bits.
const UNIQUE_NUMBER: *const [u32; 3] = core::ptr::with_exposed_provenance(0x1fff_7a10);

/// The bus.
pub type Bus = UsbBus<USB>;

/// The ports of the link.
pub type Ports = TwoPorts<'static, Uart, &'static mut CdcPort<Bus>>;

/// The registers of the core.
pub type Core = (OTG_FS_GLOBAL, OTG_FS_DEVICE, OTG_FS_PWRCLK);

/// D− and D+.
pub type UsbPins = (PA11<Alternate<10>>, PA12<Alternate<10>>);

/// What belongs to the port.
pub struct Memory {
    endpoints: [u32; ENDPOINT_WORDS],
    allocator: Option<UsbBusAllocator<Bus>>,
    port: Option<CdcPort<Bus>>,
    receiver: Receiver,
    serial: heapless::String<24>,
}

/// Starts the port. `None` if the core does not answer within a bounded time: its memory has not been accessed then.
pub fn start(
    core: Core,
    pins: UsbPins,
    memory: &'static mut MaybeUninit<Memory>,
    rcc: &mut Rcc,
) -> Option<UsbPort<'static, &'static mut CdcPort<Bus>>> {
    OTG_FS_GLOBAL::enable(rcc);
    OTG_FS_GLOBAL::reset(rcc);
    if !answers(&core.0) {
        OTG_FS_GLOBAL::disable(rcc);
        return None;
    }
    let memory = memory.write(Memory {
        endpoints: [0; ENDPOINT_WORDS],
        allocator: None,
        port: None,
        receiver: Receiver::NEW,
        serial: serial_number(),
    });
    let usb = USB::new(core, pins, &rcc.clocks);
    let allocator = memory.allocator.insert(UsbBus::new(usb, &mut memory.endpoints));
    let identity = UsbIdentity {
        ids: setup::USB_IDS,
        manufacturer: setup::USB_MANUFACTURER,
        product: IDENTITY.board,
        serial: &memory.serial,
    };
    let port = CdcPort::new(allocator, &identity).ok()?;
    Some(UsbPort { port: memory.port.insert(port), receiver: &mut memory.receiver })
}

/// Whether the core is there and ends a reset. The driver waits for the same without a limit.
fn answers(core: &OTG_FS_GLOBAL) -> bool {
    if !CORES.contains(&core.cid().read().bits()) || !within_time(core, AHBIDL, AHBIDL) {
        return false;
    }
    core.grstctl().modify(|_, w| w.csrst().set_bit());
    within_time(core, CSRST, 0)
}

/// Waits until bits of the reset register have a value. False if they do not.
// Not inlined: a test replaces its reads.
#[inline(never)]
fn within_time(core: &OTG_FS_GLOBAL, bits: u32, value: u32) -> bool {
    (0..READS).any(|_| {
        cortex_m::asm::delay(CYCLES);
        core.grstctl().read().bits() & bits == value
    })
}

/// The unique number of the chip in hexadecimal digits.
fn serial_number() -> heapless::String<24> {
    // SAFETY: a constant in the flash of the chip, which reads of words may access.
    let words = unsafe { UNIQUE_NUMBER.read_volatile() };
    let digit = |nibble: u32| char::from_digit(nibble & 15, 16).unwrap_or('0');
    words.iter().flat_map(|word| (0..8).rev().map(move |at| digit(word >> (4 * at)))).collect()
}

/// Answers the USB host, and decides which port is that of the link's host.
pub fn service(ports: &mut Ports, drive: &mut impl SharedDrive<'static, Fixed, AXES>) {
    if let Some(port) = ports.usb_port() {
        port.poll();
    }
    ports.service(drive);
}
