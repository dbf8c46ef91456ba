//! A USB bus with a host, as the controller of a chip shows it to usb-device.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard};

use usb_device::bus::PollResult;
use usb_device::endpoint::{EndpointAddress, EndpointType};
use usb_device::{Result, UsbDirection, UsbError};

/// What happens on the bus.
#[derive(Default)]
pub struct Wires {
    /// Greatest packet of each endpoint, by its address.
    pub endpoints: BTreeMap<u8, u16>,
    /// Packets for the device that it has not read, by the number of the endpoint; whether each is a SETUP packet.
    pub out: BTreeMap<u8, VecDeque<(Vec<u8>, bool)>>,
    /// The packet of an endpoint that the host has not taken.
    pub ready: BTreeMap<u8, Vec<u8>>,
    /// Endpoints whose packet the host has taken since the last poll, as bits.
    taken: u16,
    /// Endpoints that are stalled, by address.
    pub stalled: Vec<u8>,
    /// Address of the device.
    pub address: u8,
    /// Events that come before packets.
    pub events: VecDeque<Event>,
}

/// An event of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    Reset,
    Suspend,
    Resume,
}

/// The side of the device.
#[derive(Clone, Default)]
pub struct Bus(Arc<Mutex<Wires>>);

impl Bus {
    pub fn wires(&self) -> MutexGuard<'_, Wires> {
        self.0.lock().unwrap()
    }

    /// The host takes the packet of an endpoint.
    pub fn take(&self, endpoint: u8) -> Option<Vec<u8>> {
        let mut wires = self.wires();
        let packet = wires.ready.remove(&endpoint)?;
        wires.taken |= 1 << endpoint;
        Some(packet)
    }

    /// The host sends a packet; `setup` for a SETUP packet, which ends the stall of the control endpoint.
    pub fn send(&self, endpoint: u8, packet: &[u8], setup: bool) {
        let mut wires = self.wires();
        if setup {
            wires.stalled.retain(|address| address & 15 != 0);
            wires.ready.remove(&0);
            wires.out.remove(&0);
        }
        wires.out.entry(endpoint).or_default().push_back((packet.to_vec(), setup));
    }
}

impl usb_device::bus::UsbBus for Bus {
    fn alloc_ep(
        &mut self,
        direction: UsbDirection,
        address: Option<EndpointAddress>,
        _: EndpointType,
        max_packet_size: u16,
        _: u8,
    ) -> Result<EndpointAddress> {
        let mut wires = self.wires();
        let wanted = address.map_or(1..4, |address| {
            let number = u8::try_from(address.index()).unwrap();
            number..number + 1
        });
        for number in wanted {
            let address = EndpointAddress::from_parts(usize::from(number), direction);
            if !wires.endpoints.contains_key(&u8::from(address)) {
                wires.endpoints.insert(address.into(), max_packet_size);
                return Ok(address);
            }
        }
        Err(UsbError::EndpointOverflow)
    }

    fn enable(&mut self) {}

    fn reset(&self) {
        let mut wires = self.wires();
        (wires.address, wires.taken) = (0, 0);
        wires.out.clear();
        wires.ready.clear();
        wires.stalled.clear();
    }

    fn set_device_address(&self, address: u8) {
        self.wires().address = address;
    }

    fn write(&self, address: EndpointAddress, bytes: &[u8]) -> Result<usize> {
        let mut wires = self.wires();
        let number = u8::try_from(address.index()).unwrap();
        assert!(address.is_in() && bytes.len() <= usize::from(wires.endpoints[&u8::from(address)]));
        if wires.ready.contains_key(&number) {
            return Err(UsbError::WouldBlock);
        }
        wires.ready.insert(number, bytes.to_vec());
        Ok(bytes.len())
    }

    fn read(&self, address: EndpointAddress, bytes: &mut [u8]) -> Result<usize> {
        let mut wires = self.wires();
        let number = u8::try_from(address.index()).unwrap();
        let packets = wires.out.entry(number).or_default();
        let (packet, _) = packets.front().ok_or(UsbError::WouldBlock)?;
        let place = bytes.get_mut(..packet.len()).ok_or(UsbError::BufferOverflow)?;
        place.copy_from_slice(packet);
        let length = packet.len();
        packets.pop_front();
        Ok(length)
    }

    fn set_stalled(&self, address: EndpointAddress, stalled: bool) {
        let mut wires = self.wires();
        wires.stalled.retain(|other| *other != u8::from(address));
        wires.stalled.extend(stalled.then_some(u8::from(address)));
    }

    fn is_stalled(&self, address: EndpointAddress) -> bool {
        self.wires().stalled.contains(&u8::from(address))
    }

    fn suspend(&self) {}

    fn resume(&self) {}

    fn poll(&self) -> PollResult {
        let mut wires = self.wires();
        match wires.events.pop_front() {
            Some(Event::Reset) => return PollResult::Reset,
            Some(Event::Suspend) => return PollResult::Suspend,
            Some(Event::Resume) => return PollResult::Resume,
            None => {}
        }
        let (mut ep_out, mut ep_setup) = (0, 0);
        for (number, packets) in &wires.out {
            match packets.front() {
                Some((_, true)) => ep_setup |= 1 << number,
                Some((_, false)) => ep_out |= 1 << number,
                None => {}
            }
        }
        let ep_in_complete = std::mem::take(&mut wires.taken);
        if ep_out | ep_setup | ep_in_complete == 0 {
            PollResult::None
        } else {
            PollResult::Data { ep_out, ep_in_complete, ep_setup }
        }
    }
}
