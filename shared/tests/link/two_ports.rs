//! Two ports: one host, and no way around its supervision.

use proptest::prelude::*;
use shared::interpolate::feed_hold::FeedState;
use shared::link::halt::Halt;
use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::report::UsbState;
use shared::link::two_ports::{Selected, TwoPorts, UsbPort};
use shared::link::{BytePort, Receiver, Refusal, Status};
use shared::safety::{Fault, Power};

use super::jog_by;
use super::rig::{Line, Rig, TICK_HZ, TIMES};

/// A port that may take no bytes.
#[derive(Default)]
struct Wire {
    line: Line,
    blocked: bool,
}

impl BytePort for Wire {
    fn read(&mut self) -> Option<u8> {
        self.line.read()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        if self.blocked { 0 } else { self.line.write(bytes) }
    }

    fn usb(&self) -> UsbState {
        UsbState::Attached
    }
}

/// A board with two ports, and a host at each of them.
struct Pair {
    rig: Rig,
    ports: TwoPorts<'static, Wire, Wire>,
    /// Session and sequence number of each host.
    headers: [Header; 2],
}

const UART: usize = 0;
const USB: usize = 1;
const NO_SESSION: Header = Header { session: 0, sequence: 0 };

impl Pair {
    fn new() -> Self {
        let receiver = Box::leak(Box::new(Receiver::NEW));
        let usb = UsbPort { port: Wire::default(), receiver };
        let ports = TwoPorts::new(Wire::default(), Some(usb));
        let mut pair = Self { rig: Rig::new(), ports, headers: [NO_SESSION; 2] };
        // The session of the rig itself is not one of a port.
        pair.run(ms(TIMES.hold_ms));
        pair
    }

    /// With a session at a port, the drives on, and a jog of 90 mm that takes 3 s.
    fn moving(port: usize) -> Self {
        let mut pair = Self::new();
        assert!(pair.hello(port, 7), "no welcome");
        for closed in [false, true] {
            pair.rig.plant.switch_closed = closed;
            pair.run(1000);
        }
        assert_eq!(pair.request(port, &Request::Enable), Some(Reply::Done));
        pair.run(10);
        assert_eq!(pair.request(port, &jog_by(0.09)), Some(Reply::Done));
        pair
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.rig.plant.step();
            self.rig.drive.tick(&mut self.rig.plant);
            self.ports.service(&mut self.rig.drive);
            self.rig.server.poll(&mut self.ports, &mut self.rig.drive, &mut self.rig.memory);
        }
    }

    fn wire(&mut self, port: usize) -> &mut Wire {
        if port == UART { self.ports.uart() } else { self.ports.usb_port().unwrap() }
    }

    /// Sends bytes at a port and runs for 20 ticks; everything that the port sent.
    fn exchange(&mut self, port: usize, bytes: &[u8]) -> Vec<u8> {
        self.wire(port).line.to_host.clear();
        self.wire(port).line.to_board.extend(bytes);
        self.run(20);
        std::mem::take(&mut self.wire(port).line.to_host)
    }

    /// Sends a request; the only reply of its port.
    fn send(&mut self, port: usize, header: Header, request: &Request) -> Option<Reply> {
        let mut frame = Frame::new();
        packet::encode(header, request, &mut frame).unwrap();
        let [reply] = &replies(&self.exchange(port, &frame))[..] else { return None };
        Some(reply.clone())
    }

    fn request(&mut self, port: usize, request: &Request) -> Option<Reply> {
        self.headers[port].sequence += 1;
        self.send(port, self.headers[port], request)
    }

    /// Whether the port gets a session.
    fn hello(&mut self, port: usize, nonce: u32) -> bool {
        match self.send(port, NO_SESSION, &Request::Hello { nonce }) {
            Some(Reply::Welcome(welcome)) => {
                self.headers[port] = Header { session: welcome.session, sequence: 0 };
                true
            }
            Some(Reply::Refused(Refusal::OtherPort)) => false,
            other => panic!("{other:?}"),
        }
    }

    fn status(&mut self, port: usize) -> Status {
        match self.request(port, &Request::Status) {
            Some(Reply::Status(status)) => status,
            other => panic!("{other:?}"),
        }
    }

    fn feed(&self) -> FeedState {
        self.rig.drive.machine().feed_state()
    }

    fn power(&self) -> Power {
        self.rig.drive.machine().power()
    }
}

fn ms(ms: u16) -> u32 {
    u32::from(ms) * TICK_HZ / 1000
}

/// The packets in bytes; every byte belongs to a packet.
fn replies(bytes: &[u8]) -> Vec<Reply> {
    let mut receiver = Receiver::NEW;
    let mut replies = Vec::new();
    for byte in bytes {
        let Some(packet) = receiver.push(*byte) else { continue };
        match packet::message(packet.expect("a packet").message).expect("a message") {
            FromBoard::Reply(reply) => replies.push(reply),
            FromBoard::Stream(_) => {}
        }
    }
    replies
}

const REFUSED: Option<Reply> = Some(Reply::Refused(Refusal::OtherPort));

/// The host at one port is not disturbed by the other one, which is refused by name.
#[test]
fn a_host_that_is_not_silent_keeps_the_link() {
    for (owner, other) in [(UART, USB), (USB, UART)] {
        let mut pair = Pair::moving(owner);
        // 90 mm at 30 mm/s take 3.06 s; a status every 0.4 s.
        for round in 0..9 {
            pair.run(ms(400) - 100);
            assert!(!pair.hello(other, round), "a session at the other port");
            // With the session of the owner, as it may have been listened to.
            let stolen = Header { sequence: pair.headers[owner].sequence + 1, ..pair.headers[owner] };
            assert_eq!(pair.send(other, stolen, &Request::Clear), REFUSED);
            assert_eq!(pair.status(owner).power, Power::On);
        }
        assert!(pair.status(owner).at_rest && (pair.rig.plant.position_m[0] - 0.09).abs() < 50e-6);
    }
}

/// Whoever is at the other port can hold, stop and disable, without a session and with one that it has listened to. The host at the
/// selected port is told, keeps its session, and can go on.
#[test]
fn a_halt_is_taken_at_the_other_port() {
    for (owner, other) in [(UART, USB), (USB, UART)] {
        for halt in Halt::ALL {
            for stolen in [false, true] {
                let mut pair = Pair::moving(owner);
                pair.run(ms(100));
                let header = if stolen {
                    Header { sequence: pair.headers[owner].sequence + 1, ..pair.headers[owner] }
                } else {
                    NO_SESSION
                };
                assert_eq!(pair.send(other, header, &Request::from(halt)), Some(Reply::Done));
                // The path stands after 15 ms, and the axis has reached it after ten time constants of its loop.
                pair.run(ms(415));
                let at_m = pair.rig.plant.position_m[0];
                let feed = if halt == Halt::Hold { FeedState::Held } else { FeedState::Running };
                let power = if halt == Halt::Disable { Power::Off } else { Power::On };
                assert_eq!((pair.feed(), pair.power()), (feed, power));
                assert_eq!(
                    pair.request(owner, &Request::Status),
                    Some(Reply::Refused(Refusal::HaltedByOther(halt)))
                );
                pair.run(ms(100));
                assert!((pair.rig.plant.position_m[0] - at_m).abs() < 1e-6 && at_m < 0.01, "{at_m}");
                assert_eq!(pair.status(owner).power, power);
                assert_eq!(pair.send(other, NO_SESSION, &Request::Status), REFUSED);
            }
        }
    }
}

/// Requests and hellos at the other port do not end the silence of the host: the path is held, and the drives go off, as without
/// them, to the tick.
#[test]
fn the_other_port_is_no_sign_of_life() {
    let ticks_to = |disturbed: bool| {
        let mut pair = Pair::moving(UART);
        let stolen = Header { sequence: pair.headers[UART].sequence + 1, ..pair.headers[UART] };
        let mut frames = [Frame::new(), Frame::new()];
        packet::encode(stolen, &Request::Status, &mut frames[0]).unwrap();
        packet::encode(NO_SESSION, &Request::Hello { nonce: 3 }, &mut frames[1]).unwrap();
        let (mut held, mut tick) = (None, 0);
        while pair.power().is_on() {
            // The hello at most until the host is silent: afterwards it opens a session.
            if disturbed && tick % 1000 == 0 {
                let hello = tick < ms(TIMES.hold_ms) - 1000;
                let frame = if hello && tick % 2000 == 0 { &frames[1] } else { &frames[0] };
                pair.wire(USB).line.to_board.extend(frame);
            }
            pair.run(1);
            tick += 1;
            if pair.feed() != FeedState::Running {
                held = held.or(Some(tick));
            }
        }
        assert_eq!(pair.power(), Power::Faulted(Fault::HostSilent));
        (held.unwrap(), tick)
    };
    let alone = ticks_to(false);
    assert_eq!(ticks_to(true), alone);
    // The last request was received within the 20 ticks of its exchange.
    let expected = |time: u16| ms(time) - 20..=ms(time) + 1;
    assert!(
        expected(TIMES.hold_ms).contains(&alone.0) && expected(TIMES.off_ms).contains(&alone.1),
        "{alone:?}"
    );
}

/// A session at the other port continues nothing, and its hello alone keeps nothing on.
#[test]
fn a_session_at_the_other_port_needs_a_resume_and_then_requests() {
    let mut pair = Pair::moving(UART);
    pair.run(ms(TIMES.hold_ms) + ms(30));
    assert_eq!((pair.feed(), pair.power()), (FeedState::Held, Power::On));
    let command = pair.rig.drive.machine().command();
    assert!(pair.hello(USB, 8));
    assert_eq!(pair.ports.selected(), Selected::Usb);
    pair.run(ms(100));
    assert_eq!((pair.feed(), pair.rig.drive.machine().command()), (FeedState::Held, command));
    // The first host is told so, and its requests have no effect.
    assert_eq!(pair.request(UART, &Request::Resume), REFUSED);
    assert_eq!(pair.feed(), FeedState::Held);
    assert_eq!(pair.request(USB, &Request::Resume), Some(Reply::Done));
    pair.run(ms(100));
    assert_eq!(pair.feed(), FeedState::Running);
    // Hellos alone: the path is held again, and the drives go off 10 s after the resume.
    for nonce in 0..99 {
        pair.hello(USB, 100 + nonce);
        pair.run(ms(100) - 20);
        if nonce == 5 {
            assert_eq!(pair.feed(), FeedState::Held);
        }
    }
    assert_eq!(pair.power(), Power::Faulted(Fault::HostSilent));
}

/// The link goes back and forth, each time after the silence.
#[test]
fn the_port_can_be_changed_after_the_silence_of_its_host() {
    let mut pair = Pair::new();
    for (round, port) in [(0, USB), (1, UART), (2, USB)] {
        assert!(pair.hello(port, round));
        assert_eq!(pair.status(port).usb, UsbState::Attached);
        pair.run(ms(TIMES.hold_ms) - 100);
        assert!(!pair.hello(1 - port, round), "20 ticks before it is silent");
        assert_eq!(pair.status(port).power, Power::Off);
        pair.run(ms(TIMES.hold_ms));
    }
}

/// A USB host that stops reading in the middle of a stream does not lock the other port out, which gets no byte of the stream.
#[test]
fn a_port_that_takes_no_bytes_does_not_block_the_other_one() {
    let mut pair = Pair::new();
    assert!(pair.hello(USB, 1));
    assert_eq!(pair.request(USB, &Request::Stream { decimation: 1 }), Some(Reply::Done));
    pair.wire(USB).blocked = true;
    pair.run(ms(TIMES.hold_ms));
    assert!(pair.hello(UART, 2));
    assert_eq!(pair.status(UART).power, Power::Off);
    // And back: the first bytes at the port end the frame that was interrupted.
    pair.wire(USB).blocked = false;
    pair.run(ms(TIMES.hold_ms));
    let mut frame = Frame::new();
    packet::encode(NO_SESSION, &Request::Hello { nonce: 3 }, &mut frame).unwrap();
    let bytes = pair.exchange(USB, &frame);
    assert_eq!(bytes.first(), Some(&0));
    assert!(matches!(replies(&bytes)[..], [Reply::Welcome(_)]));
}

/// What the server has received of a frame does not spoil the hello of the other port.
#[test]
fn a_frame_that_was_begun_at_one_port_is_not_continued_by_the_other() {
    let mut pair = Pair::new();
    assert!(pair.hello(UART, 1));
    assert!(pair.exchange(UART, &[9, 1, 2, 3]).is_empty());
    pair.run(ms(TIMES.hold_ms));
    assert!(pair.hello(USB, 2));
    assert_eq!(pair.status(USB).link.encoding, 1);
}

/// The longest hello: numbers of five bytes without a zero.
#[test]
fn the_longest_hello_selects_its_port() {
    let mut pair = Pair::new();
    let header = Header { session: u32::MAX, sequence: u32::MAX };
    let reply = pair.send(USB, header, &Request::Hello { nonce: u32::MAX });
    assert!(matches!(reply, Some(Reply::Welcome(_))), "{reply:?}");
}

#[test]
fn another_version_is_named_at_the_other_port() {
    let mut pair = Pair::new();
    let mut frame = Frame::new();
    packet::encode_version(packet::VERSION + 1, NO_SESSION, &Request::Status, &mut frame).unwrap();
    let refused = Reply::Refused(Refusal::Version { supported: packet::VERSION });
    assert_eq!(replies(&pair.exchange(USB, &frame)), [refused]);
    assert_eq!(pair.ports.selected(), Selected::Uart);
}

#[test]
fn a_usb_port_that_does_not_answer_is_reported_and_the_serial_port_remains() {
    let mut ports = TwoPorts::<Wire, Wire>::new(Wire::default(), None);
    assert_eq!((ports.usb(), ports.usb_port().is_none()), (UsbState::NotAnswering, true));
    ports.uart().line.to_board.push_back(5);
    ports.service(&mut Rig::new().drive);
    assert_eq!((ports.read(), ports.read(), ports.write(&[1, 2])), (Some(5), None, 2));
    assert_eq!(ports.uart().line.to_host, [1, 2]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Bytes that are no packet, at the port that is not selected: no answer, and nothing of them reaches the server.
    #[test]
    fn garbage_at_the_other_port_has_no_effect(bytes in proptest::collection::vec(any::<u8>(), 0..1500)) {
        let is_packet = |part: &[u8]| packet::decode(&mut part.to_vec()).is_ok();
        prop_assume!(!bytes.split(|byte| *byte == 0).any(is_packet));
        let mut pair = Pair::new();
        prop_assert!(pair.hello(UART, 1));
        let before = pair.status(UART).link;
        pair.wire(USB).line.to_board.extend(bytes);
        pair.wire(USB).line.to_board.push_back(0);
        pair.run(40);
        prop_assert!(pair.wire(USB).line.to_host.is_empty() && pair.wire(USB).line.to_board.is_empty());
        let after = pair.status(UART).link;
        prop_assert_eq!((after.packets, after.encoding), (before.packets + 1, before.encoding));
        prop_assert_eq!(pair.ports.selected(), Selected::Uart);
    }
}
