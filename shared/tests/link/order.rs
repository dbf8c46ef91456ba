//! Repeated, lost, reordered and foreign requests.

use shared::link::message::{Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::{Refusal, Status};
use shared::safety::Power;
use shared::units::Position;

use super::jog_by;
use super::rig::Rig;

fn frame(session: u32, sequence: u32, request: &Request) -> Frame {
    let mut frame = Frame::new();
    packet::encode(Header { session, sequence }, request, &mut frame).unwrap();
    frame
}

/// The only reply to bytes.
fn reply(rig: &mut Rig, bytes: &[u8]) -> Reply {
    let mut replies = rig.send_bytes(bytes);
    assert_eq!(replies.len(), 1, "{replies:?}");
    replies.remove(0)
}

/// A jog whose reply is lost is sent three times: the axis moves once.
#[test]
fn a_repeated_request_is_executed_once() {
    let mut rig = Rig::enabled();
    rig.sequence += 1;
    let jog = frame(rig.session, rig.sequence, &jog_by(1e-3));
    for _ in 0..3 {
        assert_eq!(reply(&mut rig, &jog), Reply::Done);
    }
    rig.run(8000);
    assert_eq!(rig.status().axes[0].command, Position::from_m(1e-3).unwrap());
}

/// A repeated status is the same reply, not a new one.
#[test]
fn a_repetition_gets_the_kept_reply() {
    let mut rig = Rig::new();
    rig.sequence += 1;
    let request = frame(rig.session, rig.sequence, &Request::Status);
    let first = reply(&mut rig, &request);
    rig.run(100);
    assert_eq!(reply(&mut rig, &request), first);
    let Reply::Status(Status { tick, .. }) = first else { panic!("{first:?}") };
    assert!(rig.status().tick > tick + 100);
}

#[test]
fn a_gap_and_an_old_number_are_refused_with_the_expected_one() {
    let mut rig = Rig::enabled();
    let (session, last) = (rig.session, rig.sequence);
    for sequence in [last + 2, last + 100, last - 1, 0] {
        let refused = Reply::Refused(Refusal::Sequence { expected: last + 1 });
        assert_eq!(reply(&mut rig, &frame(session, sequence, &jog_by(1e-3))), refused);
    }
    // The number of the last request with other contents is no repetition.
    let refused = Reply::Refused(Refusal::Sequence { expected: last + 1 });
    assert_eq!(reply(&mut rig, &frame(session, last, &jog_by(1e-3))), refused);
    rig.run(4000);
    assert_eq!(rig.status().axes[0].command, Position(0));
}

/// What a host sent in an earlier session, an enable and a jog included, is refused in the next one.
#[test]
fn an_earlier_session_cannot_be_replayed() {
    let mut rig = Rig::new();
    let recorded: Vec<Frame> = [Request::Status, Request::Enable, jog_by(1e-3)]
        .iter()
        .zip(1..)
        .map(|(request, sequence)| frame(rig.session, sequence, request))
        .collect();
    rig.close_switch();
    for request in &recorded {
        assert!(!matches!(reply(&mut rig, request), Reply::Refused(_)));
    }
    rig.run(8000);
    rig.sequence = 3;
    assert_eq!(rig.request(&Request::Disable), Reply::Done);
    let before = rig.plant.position_m;
    rig.hello(2);
    for request in &recorded {
        assert_eq!(reply(&mut rig, request), Reply::Refused(Refusal::Session));
    }
    rig.run(8000);
    assert_eq!(rig.status().power, Power::Off);
    assert_eq!(rig.plant.position_m.map(f64::to_bits), before.map(f64::to_bits));
}

#[test]
fn without_a_session_nothing_can_be_started_or_changed() {
    let mut rig = Rig::new();
    let other = rig.session ^ 1;
    for request in [Request::Clear, Request::Enable, Request::Resume, jog_by(1e-3), Request::BeginSave] {
        assert_eq!(reply(&mut rig, &frame(other, 1, &request)), Reply::Refused(Refusal::Session));
        assert_eq!(reply(&mut rig, &frame(0, 1, &request)), Reply::Refused(Refusal::Session));
    }
}

#[test]
fn another_version_is_refused_by_name() {
    let mut rig = Rig::new();
    let mut other = Frame::new();
    let header = Header { session: rig.session, sequence: 1 };
    packet::encode_version(packet::VERSION + 1, header, &Request::Status, &mut other).unwrap();
    let refused = Reply::Refused(Refusal::Version { supported: packet::VERSION });
    assert_eq!(reply(&mut rig, &other), refused);
    assert_eq!(rig.status().link.version, 1);
}

/// Bytes with a right checksum that are no request are refused, and count as a request: a repetition gets the same reply.
#[test]
fn an_unreadable_request_is_refused_by_name() {
    let mut rig = Rig::new();
    let mut unknown = Frame::new();
    rig.sequence += 1;
    let header = Header { session: rig.session, sequence: rig.sequence };
    packet::encode(header, &[250u8, 1, 2], &mut unknown).unwrap();
    for _ in 0..2 {
        assert_eq!(reply(&mut rig, &unknown), Reply::Refused(Refusal::Unreadable));
    }
    assert_eq!(rig.status().power, Power::Off);
}
