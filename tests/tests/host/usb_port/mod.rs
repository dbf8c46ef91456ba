//! The USB port of the board on an emulated bus: what a USB host sees, and the link over it.
//!
//! The class, the device and the port are those of the board; its bus (`firmware/src/board/usb.rs`) is replaced.

mod bus;
#[allow(dead_code, reason = "written for the tests of `shared`")]
#[path = "../../../../shared/tests/link/rig.rs"]
mod rig;

use bus::{Bus, Event};
use firmware::f405::IDENTITY;
use firmware::setup::{USB_IDS, USB_MANUFACTURER};
use firmware::usb_port::{CdcPort, UsbIdentity};
use rig::{Draws, Line, Rig, TICK_HZ, TIMES};
use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::report::UsbState;
use shared::link::two_ports::{TwoPorts, UsbPort};
use shared::link::{BytePort, Receiver};
use usb_device::bus::UsbBusAllocator;

const SERIAL: &str = "0123456789abcdef01234567";
/// Endpoints of the data interface.
const DATA_IN: u8 = 2;
const DATA_OUT: u8 = 1;

const IDS: UsbIdentity =
    UsbIdentity { ids: USB_IDS, manufacturer: USB_MANUFACTURER, product: IDENTITY.board, serial: SERIAL };

fn port() -> (Bus, CdcPort<Bus>) {
    let bus = Bus::default();
    let allocator = Box::leak(Box::new(UsbBusAllocator::new(bus.clone())));
    (bus, CdcPort::new(allocator, &IDS).unwrap())
}

/// A control transfer with data from the device: SETUP, packets, status. `None`: stalled.
fn control_in(
    bus: &Bus,
    port: &mut CdcPort<Bus>,
    request: [u8; 4],
    index: u16,
    length: u16,
) -> Option<Vec<u8>> {
    let [index, length] = [index, length].map(u16::to_le_bytes);
    bus.send(0, &[&request[..], &index, &length].concat(), true);
    port.poll();
    let mut data = Vec::new();
    while let Some(packet) = bus.take(0) {
        data.extend(&packet);
        port.poll();
        if packet.len() < 64 {
            break;
        }
    }
    if bus.wires().stalled.contains(&0x80) {
        return None;
    }
    bus.send(0, &[], false);
    port.poll();
    Some(data)
}

/// A control transfer without data, or with data to the device.
fn control_out(bus: &Bus, port: &mut CdcPort<Bus>, request: [u8; 4], data: &[u8]) {
    let length = u16::try_from(data.len()).unwrap().to_le_bytes();
    bus.send(0, &[&request[..], &[0, 0], &length].concat(), true);
    port.poll();
    if !data.is_empty() {
        bus.send(0, data, false);
        port.poll();
    }
    assert_eq!(bus.take(0).as_deref(), Some(&[][..]), "the status of {request:?}");
    port.poll();
}

/// DTR: whether a program has opened the port (CDC PSTN 1.2, 6.3.12).
fn set_open(bus: &Bus, port: &mut CdcPort<Bus>, open: bool) {
    control_out(bus, port, [0x21, 0x22, u8::from(open), 0], &[]);
}

/// Reset, address, configuration (USB 2.0, 9.4).
fn attach(bus: &Bus, port: &mut CdcPort<Bus>) {
    bus.wires().events.push_back(Event::Reset);
    port.poll();
    control_out(bus, port, [0, 5, 9, 0], &[]);
    control_out(bus, port, [0, 9, 1, 0], &[]);
}

#[test]
fn a_host_sees_a_serial_port_with_its_names() {
    let (bus, mut port) = port();
    assert_eq!(port.usb(), UsbState::Detached);
    attach(&bus, &mut port);
    assert_eq!((port.usb(), bus.wires().address), (UsbState::Attached, 9));
    let mut descriptor =
        |kind, index, length| control_in(&bus, &mut port, [0x80, 6, index, kind], 0x409, length);
    // 9.6.1: class 2 is communication; the numbers of vendor and product.
    let device = descriptor(1, 0, 18).unwrap();
    let number = |at: usize| u16::from_le_bytes([device[at], device[at + 1]]);
    assert_eq!((device.len(), device[4], device[7]), (18, 2, 64));
    assert_eq!((number(8), number(10)), USB_IDS);
    for (place, expected) in [(14, IDS.manufacturer), (15, IDS.product), (16, SERIAL)] {
        let text = descriptor(3, device[place], 255).unwrap();
        let units: Vec<u16> =
            text[2..].chunks(2).map(|unit| u16::from_le_bytes([unit[0], unit[1]])).collect();
        assert_eq!(String::from_utf16(&units).unwrap(), expected);
    }
    // 9.6.3, 9.6.5 and 9.6.6: own supply; two interfaces, CDC-ACM and its data; the endpoints with their kinds and sizes.
    let configuration = descriptor(2, 0, 255).unwrap();
    assert_eq!(usize::from(u16::from_le_bytes([configuration[2], configuration[3]])), configuration.len());
    assert_eq!((configuration[4], configuration[7] & 0x40), (2, 0x40));
    let (mut interfaces, mut endpoints) = (Vec::new(), Vec::new());
    let mut rest = &configuration[..];
    while let [length, kind, ..] = rest {
        let (part, others) = rest.split_at(usize::from(*length));
        match kind {
            4 => interfaces.push((part[5], part[6])),
            5 => endpoints.push((part[2], part[3], part[4])),
            _ => {}
        }
        rest = others;
    }
    assert_eq!(interfaces, [(2, 2), (0x0a, 0)]);
    assert_eq!(endpoints, [(0x81, 3, 8), (0x80 | DATA_IN, 2, 64), (DATA_OUT, 2, 64)]);
    // The cable is pulled: the bus is idle.
    bus.wires().events.push_back(Event::Suspend);
    port.poll();
    assert_eq!(port.usb(), UsbState::Detached);
}

/// A board with a serial and a USB port, and a host at USB.
struct Board {
    rig: Rig,
    bus: Bus,
    ports: TwoPorts<'static, Line, CdcPort<Bus>>,
    receiver: Receiver,
    header: Header,
}

impl Board {
    /// Attached and open, without a session.
    fn new() -> Self {
        let (bus, port) = port();
        let receiver = Box::leak(Box::new(Receiver::NEW));
        let ports = TwoPorts::new(Line::default(), Some(UsbPort { port, receiver }));
        let header = Header { session: 0, sequence: 0 };
        let mut board = Self { rig: Rig::new(), bus, ports, receiver: Receiver::NEW, header };
        board.run(u32::from(TIMES.hold_ms) * TICK_HZ / 1000);
        board.control(attach);
        board.control(|bus, port| set_open(bus, port, true));
        board
    }

    fn control(&mut self, transfer: impl FnOnce(&Bus, &mut CdcPort<Bus>)) {
        transfer(&self.bus, self.ports.usb_port().unwrap());
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.rig.plant.step();
            self.rig.drive.tick(&mut self.rig.plant);
            self.ports.usb_port().unwrap().poll();
            self.ports.service(&mut self.rig.drive);
            self.rig.server.poll(&mut self.ports, &mut self.rig.drive, &mut self.rig.memory);
        }
    }

    /// Sends a request in packets of at most 64 bytes.
    fn send(&mut self, request: &Request) {
        let mut frame = Frame::new();
        packet::encode(self.header, request, &mut frame).unwrap();
        for part in frame.chunks(64) {
            self.bus.send(DATA_OUT, part, false);
        }
    }

    /// Takes what the board sends in some ticks.
    fn replies(&mut self, ticks: u32) -> Vec<Reply> {
        let mut replies = Vec::new();
        for _ in 0..ticks {
            self.run(1);
            let packet = self.bus.take(DATA_IN).unwrap_or_default();
            // A full packet would not end the transfer.
            assert!(packet.len() < 64);
            for byte in packet {
                let Some(packet) = self.receiver.push(byte) else { continue };
                if let FromBoard::Reply(reply) = packet::message(packet.unwrap().message).unwrap() {
                    replies.push(reply);
                }
            }
        }
        replies
    }

    fn request(&mut self, request: &Request) -> Reply {
        self.header.sequence += 1;
        self.send(request);
        let [reply] = &self.replies(40)[..] else { panic!("no reply, or several: {request:?}") };
        reply.clone()
    }

    fn hello(&mut self, nonce: u32) {
        self.header = Header { session: 0, sequence: 0 };
        self.send(&Request::Hello { nonce });
        let [Reply::Welcome(welcome)] = &self.replies(40)[..] else { panic!("no welcome") };
        self.header.session = welcome.session;
    }
}

#[test]
fn requests_and_replies_of_any_length_go_over_usb() {
    let mut board = Board::new();
    board.hello(1);
    let Reply::Status(status) = board.request(&Request::Status) else { panic!("no status") };
    assert_eq!((status.usb, status.link.packets), (UsbState::Attached, 2));
    // Six packets of 64 bytes and a rest, and one whose last packet is full or not, as the length falls.
    for length in 300..384 {
        let bytes = (0..length).map(|at| u8::try_from(at % 251).unwrap()).collect();
        assert_eq!(board.request(&Request::Upload { offset: 0, bytes }), Reply::Done);
    }
}

/// The packets that the link had received, by each of the replies.
fn packets(replies: &[Reply]) -> Vec<u32> {
    let of = |reply: &Reply| match reply {
        Reply::Status(status) => status.link.packets,
        other => panic!("{other:?}"),
    };
    replies.iter().map(of).collect()
}

/// A host that takes nothing for some time: one request waits until the reply before it has gone. A further one, which a host does not have, is
/// not answered, and executed when it is repeated. The board goes on reading: a stop would act.
#[test]
fn a_host_that_is_slow_loses_nothing() {
    let mut board = Board::new();
    board.hello(1);
    for _ in 0..3 {
        board.header.sequence += 1;
        board.send(&Request::Status);
    }
    board.run(200);
    assert!(board.bus.wires().out[&DATA_OUT].is_empty(), "the board reads everything");
    let replies = board.replies(200);
    // Two hellos were before the first. It is longer than what the bus takes at once, so that the board keeps the rest of it, and the second is
    // executed when that has gone: after all three have been read.
    let mut frame = Frame::new();
    packet::encode(board.header, &FromBoard::Reply(replies[0].clone()), &mut frame).unwrap();
    assert!(frame.len() > 63, "{} B", frame.len());
    assert_eq!(packets(&replies), [2, 5]);
    // The third is executed when it is repeated.
    board.send(&Request::Status);
    assert_eq!(packets(&board.replies(200)), [5]);
    // Of short replies the bus takes the first one, so that the second waits as a reply and the third as a request.
    for _ in 0..3 {
        board.header.sequence += 1;
        board.send(&Request::Clear);
    }
    board.run(200);
    assert_eq!(board.replies(200), [Reply::Done, Reply::Done, Reply::Done]);
}

/// Replies for a program that has closed the port are discarded: the next program gets none of them.
#[test]
fn a_program_that_opens_the_port_gets_nothing_of_the_one_before() {
    let mut board = Board::new();
    board.hello(1);
    assert_eq!(board.request(&Request::Stream { decimation: 1 }), Reply::Done);
    // In the middle of a packet of the stream.
    board.run(100);
    board.control(|bus, port| set_open(bus, port, false));
    board.bus.take(DATA_IN);
    board.run(100);
    assert_eq!(board.bus.wires().ready.get(&DATA_IN), None);
    board.control(|bus, port| set_open(bus, port, true));
    board.receiver = Receiver::NEW;
    // As the client of the host does, and the session is a new one: the stream has ended.
    board.bus.send(DATA_OUT, &[0], false);
    board.send(&Request::Hello { nonce: 2 });
    board.bus.take(DATA_IN);
    let welcomes = |bytes: &[Reply]| bytes.iter().filter(|reply| matches!(reply, Reply::Welcome(_))).count();
    let mut seen = Vec::new();
    for _ in 0..80 {
        board.run(1);
        for byte in board.bus.take(DATA_IN).unwrap_or_default() {
            if let Some(Ok(packet)) = board.receiver.push(byte)
                && let FromBoard::Reply(reply) = packet::message(packet.message).unwrap()
            {
                seen.push(reply);
            }
        }
    }
    assert_eq!(welcomes(&seen), 1);
}

/// A cable that is pulled with a stream running: the serial port gets the link after the silence.
#[test]
fn a_cable_that_is_pulled_leaves_the_link_to_the_serial_port() {
    let mut board = Board::new();
    board.hello(1);
    assert_eq!(board.request(&Request::Stream { decimation: 1 }), Reply::Done);
    board.bus.wires().events.push_back(Event::Suspend);
    board.run(1);
    board.bus.wires().ready.clear();
    board.run(u32::from(TIMES.hold_ms) * TICK_HZ / 1000 + 1);
    assert_eq!(board.bus.wires().ready.get(&DATA_IN), None, "sent to a host that is not there");
    let mut frame = Frame::new();
    packet::encode(Header { session: 0, sequence: 0 }, &Request::Hello { nonce: 3 }, &mut frame).unwrap();
    board.ports.uart().to_board.extend(&frame);
    board.run(20);
    let bytes = std::mem::take(&mut board.ports.uart().to_host);
    let packets: Vec<_> = bytes.split(|byte| *byte == 0).filter(|part| !part.is_empty()).collect();
    let [welcome] = packets[..] else { panic!("{} packets", packets.len()) };
    let mut welcome = welcome.to_vec();
    let packet = packet::decode(&mut welcome).unwrap();
    assert!(matches!(packet::message(packet.message), Ok(FromBoard::Reply(Reply::Welcome(_)))));
}

/// Any requests, packets and events: no panic, and the device can be attached afterwards.
#[test]
fn a_host_that_sends_anything_causes_no_panic() {
    let mut draws = Draws(0x0dd_ba11);
    for _ in 0..300 {
        let (bus, mut port) = port();
        attach(&bus, &mut port);
        for _ in 0..200 {
            match draws.below(8) {
                0 => bus
                    .wires()
                    .events
                    .push_back([Event::Reset, Event::Suspend, Event::Resume][draws.below(3)]),
                1 => _ = bus.take(0),
                2 => _ = port.read(),
                3 => _ = port.write(&[7; 100]),
                4 => {
                    let bytes: Vec<u8> = (0..draws.below(65)).map(|_| draws.byte()).collect();
                    bus.send([0, DATA_OUT][draws.below(2)], &bytes, false);
                }
                _ => {
                    // Requests of the standard and of the class, with any values; descriptors among them.
                    let mut setup: [u8; 8] = std::array::from_fn(|_| draws.byte());
                    setup[0] &= 0xe3;
                    setup[1] %= 0x24;
                    setup[3] %= 16;
                    if draws.below(2) == 0 {
                        setup[5] = 0;
                        setup[7] = 0;
                    }
                    bus.send(0, &setup, true);
                }
            }
            port.poll();
        }
        attach(&bus, &mut port);
        assert_eq!(port.usb(), UsbState::Attached);
    }
}
