//! Hold, stop and disable by somebody without the session: at once, whatever else is on the line, and the host is told.

use std::collections::VecDeque;

use shared::drive::direction_check::{DirectionCheckSettings, DirectionResult};
use shared::interpolate::feed_hold::FeedState;
use shared::link::halt::Halt;
use shared::link::message::{FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::report::{Activity, DirectionReport};
use shared::link::{BytePort, Receiver, Refusal};
use shared::safety::{Fault, Power};

use super::rig::{Rig, TICK_HZ, TIMES};
use super::{jog_at, jog_by};

/// Ticks within which a halt is executed and answered: 2 ms.
const ANSWER_TICKS: u32 = TICK_HZ / 500;

/// Ticks in which 30 mm/s decelerate at 2 m/s², with a margin: 30 ms.
const DECELERATION_TICKS: u32 = 600;

/// Ticks in which an axis reaches a command that stands: ten time constants of its position loop (25 per second).
const SETTLING_TICKS: u32 = 8000;

fn frame(header: Header, request: &Request) -> Frame {
    let mut frame = Frame::new();
    packet::encode(header, request, &mut frame).unwrap();
    frame
}

/// Whether a halt has begun to act on a jog.
fn acts(halt: Halt, rig: &Rig) -> bool {
    let machine = rig.drive.machine();
    match halt {
        Halt::Hold => matches!(machine.feed_state(), FeedState::Holding | FeedState::Held),
        Halt::Stop => machine.feed_state() == FeedState::Discarding,
        Halt::Disable => machine.power() == Power::Off,
    }
}

/// Without a session, with that of an earlier one, and with a wrong number of the present one, each halt is executed. After it the jog
/// of 90 mm has gone less than 10 mm.
#[test]
fn a_halt_needs_no_session() {
    for halt in Halt::ALL {
        for kind in 0..3 {
            let mut rig = Rig::enabled();
            assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
            rig.run(4000);
            let header = match kind {
                0 => Header::without_session(9),
                1 => Header { session: rig.session ^ 5, sequence: 77 },
                _ => Header { session: rig.session, sequence: rig.sequence + 5 },
            };
            assert!(!acts(halt, &rig));
            assert_eq!(rig.send(header, &Request::from(halt)), Reply::Done);
            assert!(acts(halt, &rig), "{halt:?} {kind}");
            rig.run(DECELERATION_TICKS + SETTLING_TICKS);
            let (machine, activity) = (rig.drive.machine(), rig.drive.activity());
            match halt {
                Halt::Hold => assert_eq!((machine.feed_state(), activity), (FeedState::Held, Activity::Jog)),
                Halt::Stop => assert_eq!((machine.power(), activity), (Power::On, Activity::Idle)),
                Halt::Disable => assert!(!rig.plant.enabled),
            }
            let at_m = rig.plant.position_m[0];
            assert!((0.003..0.010).contains(&at_m), "{halt:?} {kind}: {at_m}");
            rig.run(4000);
            let later_m = rig.plant.position_m[0];
            assert!((later_m - at_m).abs() < 1e-6, "{halt:?} {kind}: {at_m} {later_m}");
            // Its own host is not told what it has done itself.
            let told = rig.request(&Request::Status) == Reply::Refused(Refusal::HaltedByOther(halt));
            assert_eq!(told, kind < 2, "{halt:?} {kind}");
        }
    }
}

/// The next request of the session is refused by name and has no effect, a repetition of it gets the same reply, and the one after it
/// is executed. The host's own halts are executed in any case, and leave what it is to be told.
#[test]
fn the_host_is_told_once_and_starts_nothing() {
    for halt in Halt::ALL {
        for request in [jog_by(0.01), jog_at(0.03), Request::Enable, Request::Resume, Request::Status] {
            let mut rig = Rig::enabled();
            assert_eq!(rig.send(Header::without_session(1), &Request::from(halt)), Reply::Done);
            let before = rig.drive.machine().command();
            assert_eq!(rig.request(&Request::Stop), Reply::Done);
            for _ in 0..2 {
                rig.sequence += 1;
                let header = Header { session: rig.session, sequence: rig.sequence };
                let refused = Reply::Refused(Refusal::HaltedByOther(halt));
                assert_eq!(rig.send(header, &request), refused, "{halt:?} {request:?}");
                assert_eq!(rig.send(header, &request), refused, "{halt:?} {request:?}");
                rig.run(2000);
                assert_eq!(rig.drive.machine().command(), before, "{halt:?} {request:?}");
                assert_eq!(rig.drive.machine().power().is_on(), halt != Halt::Disable);
                assert!(rig.status().at_rest);
                assert_eq!(rig.send(Header::without_session(2), &Request::from(halt)), Reply::Done);
            }
        }
    }
}

/// A jog at a speed that is renewed goes on without the halt; with it, the renewal is refused and starts no other jog.
#[test]
fn a_renewal_after_a_stop_starts_no_other_jog() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_at(0.03)), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.request(&jog_at(0.03)), Reply::Done);
    assert_eq!(rig.send(Header::without_session(3), &Request::Stop), Reply::Done);
    rig.run(DECELERATION_TICKS);
    assert_eq!(rig.refusal(&jog_at(0.03)), Refusal::HaltedByOther(Halt::Stop));
    rig.run(DECELERATION_TICKS);
    assert!(rig.status().at_rest);
}

/// Of several halts the strongest is told, in any order. Another session is told nothing.
#[test]
fn the_strongest_of_several_halts_is_told() {
    for first in Halt::ALL {
        for second in Halt::ALL {
            let mut rig = Rig::enabled();
            for halt in [first, second] {
                assert_eq!(rig.send(Header::without_session(1), &Request::from(halt)), Reply::Done);
            }
            assert_eq!(rig.refusal(&Request::Status), Refusal::HaltedByOther(first.max(second)));
            assert_eq!(rig.send(Header::without_session(1), &Request::from(first)), Reply::Done);
            rig.hello(44);
            assert!(rig.status().at_rest);
        }
    }
    assert!(Halt::Hold < Halt::Stop && Halt::Stop < Halt::Disable);
}

/// Halts and questions without a session do not keep the path going, nor the drives on: the times of the silence are those without
/// them, to the tick.
#[test]
fn requests_without_a_session_are_no_sign_of_life() {
    let ticks_to_off = |request: Option<Request>| {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
        let start = rig.drive.now();
        while rig.drive.machine().power().is_on() {
            rig.run(1);
            if (rig.drive.now() - start).is_multiple_of(500)
                && let Some(request) = &request
            {
                rig.line.to_board.extend(frame(Header::without_session(8), request));
            }
        }
        assert_eq!(rig.drive.machine().power(), Power::Faulted(Fault::HostSilent));
        rig.drive.now() - start
    };
    let alone = ticks_to_off(None);
    let off_ticks = u64::from(TIMES.off_ms) * u64::from(TICK_HZ) / 1000;
    assert!((off_ticks - 10..=off_ticks + 1).contains(&alone), "{alone}");
    for request in [Request::Hold, Request::Status, Request::Identify, Request::FaultHistory] {
        assert_eq!(ticks_to_off(Some(request.clone())), alone, "{request:?}");
    }
}

/// What changes nothing is answered to session 0, with the board's identity and without a session. A session of somebody else gets its
/// refusal, so that its host learns that it has lost the board.
#[test]
fn what_changes_nothing_needs_no_session() {
    let mut rig = Rig::enabled();
    let none = Header::without_session(5);
    assert!(matches!(rig.send(none, &Request::Status), Reply::Status(status) if status.power == Power::On));
    assert!(matches!(rig.send(none, &Request::FaultHistory), Reply::FaultHistory(_)));
    let Reply::Welcome(welcome) = rig.send(none, &Request::Identify) else { panic!("no welcome") };
    assert_eq!((welcome.session, welcome.board.as_str()), (0, "test board"));
    let other = Header { session: rig.session ^ 1, sequence: 1 };
    for request in [Request::Status, Request::Identify, Request::FaultHistory] {
        assert_eq!(rig.send(other, &request), Reply::Refused(Refusal::Session));
    }
    // The session goes on.
    assert_eq!(rig.request(&jog_by(1e-3)), Reply::Done);
}

/// A direction check that waits for the switch is ended by each halt: closing the switch pushes nothing. Without one it does.
#[test]
fn a_direction_check_is_ended_from_outside() {
    let settings = DirectionCheckSettings { force_n: 40.0, time_s: 0.2, detect_m: 1e-4 };
    for halt in [None, Some(Halt::Hold), Some(Halt::Stop), Some(Halt::Disable)] {
        let mut rig = Rig::new();
        assert_eq!(rig.request(&Request::CheckDirection { axis: 0, settings }), Reply::Done);
        if let Some(halt) = halt {
            assert_eq!(rig.send(Header::without_session(1), &Request::from(halt)), Reply::Done);
            assert_eq!(rig.refusal(&Request::Status), Refusal::HaltedByOther(halt));
        }
        rig.close_switch();
        rig.run(4000);
        assert_eq!(rig.plant.position_m[0] > 0.0, halt.is_none(), "{halt:?}");
        let result = if halt.is_some() { DirectionResult::Aborted } else { DirectionResult::Ok };
        assert_eq!(rig.status().direction, DirectionReport::Ended { axis: 0, result }, "{halt:?}");
    }
}

/// A serial port of 1 Mbaud: 5 bytes in a tick each way, and a queue of 511 bytes that wait to be sent, as on the board.
#[derive(Default)]
struct SlowLine {
    on_the_way: VecDeque<u8>,
    received: VecDeque<u8>,
    waiting: VecDeque<u8>,
    to_host: Vec<u8>,
    blocked: bool,
}

impl SlowLine {
    const BYTES_PER_TICK: usize = 5;
    const QUEUE: usize = 511;

    fn tick(&mut self) {
        for _ in 0..Self::BYTES_PER_TICK {
            self.received.extend(self.on_the_way.pop_front());
            if !self.blocked {
                self.to_host.extend(self.waiting.pop_front());
            }
        }
    }
}

impl BytePort for SlowLine {
    fn read(&mut self) -> Option<u8> {
        self.received.pop_front()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        let taken = bytes.len().min(Self::QUEUE - self.waiting.len());
        self.waiting.extend(&bytes[..taken]);
        taken
    }
}

/// A board at a slow line, with a jog of 90 mm and a stream of every fifth tick, as of a recording.
struct SlowRig {
    rig: Rig,
    line: SlowLine,
}

impl SlowRig {
    fn streaming(decimation: u32) -> Self {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&Request::Stream { decimation }), Reply::Done);
        assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
        Self { rig, line: SlowLine::default() }
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.rig.plant.step();
            self.rig.drive.tick(&mut self.rig.plant);
            self.line.tick();
            self.rig.server.poll(&mut self.line, &mut self.rig.drive, &mut self.rig.memory);
        }
    }

    /// The headers and replies that have reached the host.
    fn replies(&self) -> Vec<(Header, Reply)> {
        let mut receiver = Receiver::NEW;
        let mut replies = Vec::new();
        for byte in &self.line.to_host {
            if let Some(Ok(packet)) = receiver.push(*byte)
                && let FromBoard::Reply(reply) = packet::message(packet.message).unwrap()
            {
                replies.push((packet.header, reply));
            }
        }
        replies
    }
}

/// In every phase of the stream of a recording: the halt acts as soon as its last byte
/// has arrived, and its answer has reached the host within 2 ms of its first byte. Neither is faster than the line.
#[test]
fn a_halt_is_answered_within_two_milliseconds_beside_a_stream() {
    let mut slowest = 0;
    for halt in Halt::ALL {
        for phase in 0..125 {
            let mut slow = SlowRig::streaming(5);
            slow.run(2000 + phase);
            slow.line.to_host.clear();
            let header = Header::without_session(0xdead_beef);
            let request = frame(header, &Request::from(halt));
            let arrival = u32::try_from(request.len().div_ceil(SlowLine::BYTES_PER_TICK)).unwrap();
            slow.line.on_the_way.extend(&request);
            slow.run(arrival - 1);
            assert!(!acts(halt, &slow.rig), "{halt:?} {phase}");
            // Its last byte, and the tick for which it was received.
            slow.run(2);
            assert!(acts(halt, &slow.rig), "{halt:?} {phase}");
            let mut ticks = arrival + 1;
            while slow.replies().is_empty() {
                slow.run(1);
                ticks += 1;
                assert!(ticks <= ANSWER_TICKS, "{halt:?} {phase}: {ticks} ticks");
            }
            assert_eq!(slow.replies(), [(header, Reply::Done)]);
            assert!(ticks >= 2 * arrival - 1, "{halt:?} {phase}: {ticks} ticks");
            slowest = slowest.max(ticks);
        }
    }
    // The stream has been in the way.
    assert!(slowest > ANSWER_TICKS / 2, "{slowest}");
}

/// A host that reads nothing, here at a stream of every tick, cannot be answered, and can be halted all the same: with its session and
/// without. What waited before is answered once the port takes bytes again.
#[test]
fn a_port_that_takes_no_bytes_keeps_no_halt_out() {
    for halt in Halt::ALL {
        for of_session in [true, false] {
            let mut slow = SlowRig::streaming(1);
            slow.line.blocked = true;
            slow.run(2000);
            assert_eq!(slow.line.waiting.len(), SlowLine::QUEUE);
            let header = if of_session {
                Header { session: slow.rig.session, sequence: slow.rig.sequence + 1 }
            } else {
                Header::without_session(6)
            };
            slow.line.on_the_way.extend(frame(header, &Request::from(halt)));
            slow.run(10);
            assert!(acts(halt, &slow.rig), "{halt:?}");
            slow.line.blocked = false;
            slow.run(1000);
            assert_eq!(slow.replies(), [(header, Reply::Done)], "{halt:?}");
        }
    }
}

/// A request that waits behind a blocked reply is executed later, but not after a halt of its own host, and refused by name after one
/// from outside.
#[test]
fn a_request_that_waits_is_not_executed_after_a_halt() {
    for halt in [None, Some(true), Some(false)] {
        let mut slow = SlowRig::streaming(1);
        slow.line.blocked = true;
        slow.run(2000);
        let next = Header { session: slow.rig.session, sequence: slow.rig.sequence + 1 };
        slow.line.on_the_way.extend(frame(next, &Request::Enable));
        let own = Header { sequence: next.sequence + 1, ..next };
        let outside = Header::without_session(6);
        if let Some(is_own) = halt {
            slow.line.on_the_way.extend(frame(if is_own { own } else { outside }, &Request::Stop));
        }
        slow.run(20);
        slow.line.blocked = false;
        slow.run(1000);
        let expected = match halt {
            None => vec![(next, Reply::Done)],
            Some(true) => vec![(own, Reply::Done)],
            Some(false) => {
                vec![(outside, Reply::Done), (next, Reply::Refused(Refusal::HaltedByOther(Halt::Stop)))]
            }
        };
        assert_eq!(slow.replies(), expected, "{halt:?}");
    }
}
