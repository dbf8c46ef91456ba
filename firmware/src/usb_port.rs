//! A USB CDC-ACM port, on any bus, as a port of the link.
//!
//! There is no interrupt: [`CdcPort::poll`] is called repeatedly, between ticks. A USB host waits for an answer: what it sends is
//! not acknowledged until it is read, and a request at the control endpoint may take 50 ms at least (USB 2.0, 9.2.6).

use shared::link::BytePort;
use shared::link::report::UsbState;
use usb_device::bus::{UsbBus, UsbBusAllocator};
use usb_device::descriptor::lang_id::LangID;
use usb_device::device::{StringDescriptors, UsbDevice, UsbDeviceBuilder, UsbDeviceState, UsbVidPid};
use usb_device::prelude::BuilderError;
use usbd_serial::{CdcAcmClass, USB_CLASS_CDC};

/// Greatest packet of a bulk endpoint at full speed, bytes.
const PACKET: usize = 64;

/// Greatest number of bytes that are sent in a packet. A packet of 64 would need another one to end the transfer.
const SENT: usize = PACKET - 1;

/// What a USB host is told.
#[derive(Clone, Copy, Debug)]
pub struct UsbIdentity {
    /// Numbers of vendor and product.
    pub ids: (u16, u16),
    /// Name of the manufacturer.
    pub manufacturer: &'static str,
    /// Name of the product.
    pub product: &'static str,
    /// Serial number.
    pub serial: &'static str,
}

/// The port.
pub struct CdcPort<B: UsbBus + 'static> {
    device: UsbDevice<'static, B>,
    class: CdcAcmClass<'static, B>,
    /// The last packet, and which of its bytes have not been read.
    packet: [u8; PACKET],
    unread: core::ops::Range<usize>,
}

impl<B: UsbBus> CdcPort<B> {
    /// Connects to the bus.
    ///
    /// # Errors
    /// Settings that USB does not allow.
    ///
    /// # Panics
    /// Where the bus has too few endpoints (two beside that for control), or no memory for them.
    pub fn new(bus: &'static UsbBusAllocator<B>, identity: &UsbIdentity) -> Result<Self, BuilderError> {
        #[expect(clippy::cast_possible_truncation, reason = "64")]
        let class = CdcAcmClass::new(bus, PACKET as u16);
        let strings = StringDescriptors::new(LangID::EN_US)
            .manufacturer(identity.manufacturer)
            .product(identity.product)
            .serial_number(identity.serial);
        let device = UsbDeviceBuilder::new(bus, UsbVidPid(identity.ids.0, identity.ids.1))
            .device_class(USB_CLASS_CDC)
            .max_packet_size_0(64)?
            .strings(&[strings])?
            .self_powered(true)
            .build();
        Ok(Self { device, class, packet: [0; PACKET], unread: 0..0 })
    }

    /// Answers the bus. To be called repeatedly.
    // Not inlined: its calls through the table of the class are found there by the test of the stack.
    #[inline(never)]
    pub fn poll(&mut self) {
        self.device.poll(&mut [&mut self.class]);
    }

    /// Whether a host has configured the device and a program there has opened the port.
    fn is_open(&self) -> bool {
        self.device.state() == UsbDeviceState::Configured && self.class.dtr()
    }
}

impl<B: UsbBus> BytePort for CdcPort<B> {
    fn read(&mut self) -> Option<u8> {
        if self.unread.is_empty() {
            self.unread = 0..self.class.read_packet(&mut self.packet).ok()?;
        }
        self.packet.get(self.unread.next()?).copied()
    }

    /// Without a program that has opened the port the bytes are discarded: they would be those of an earlier session.
    fn write(&mut self, bytes: &[u8]) -> usize {
        if !self.is_open() {
            return bytes.len();
        }
        let (packet, _) = bytes.split_at(bytes.len().min(SENT));
        self.class.write_packet(packet).unwrap_or(0)
    }

    fn usb(&self) -> UsbState {
        match self.device.state() {
            UsbDeviceState::Configured => UsbState::Attached,
            _ => UsbState::Detached,
        }
    }
}
