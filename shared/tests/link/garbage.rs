//! A million frames that are wrong in every way: nothing of them is accepted, nothing moves, and the link works afterwards.

use shared::capture::Trigger;
use shared::interpolate::Block;
use shared::link::message::{Reply, Request, UploadKind};
use shared::link::packet::{self, Frame, Header};
use shared::link::{LinkCounts, Refusal};
use shared::safety::Power;

use super::rig::{Draws, Rig};
use super::{jog_at, jog_by};

/// Frames per test.
const FRAMES: u32 = 500_000;

/// Requests that would move or change something.
fn requests() -> Vec<Request> {
    vec![
        Request::Enable,
        jog_by(0.01),
        jog_at(0.03),
        Request::add_block(Block::line([0.05, 0.0], 0.03, 0.5)),
        Request::StartMotion { blocks: 1 },
        Request::Resume,
        Request::Apply { kind: UploadKind::Settings, length: 0, checksum: 0 },
        Request::Arm { trigger: Trigger::Now, samples: 10 },
        Request::Stream { decimation: 1 },
        Request::Status,
    ]
}

/// A frame that is not to be executed: of another session, with another number, damaged, cut, with random bytes within, or
/// random as a whole.
fn wrong_frame(rig: &Rig, draws: &mut Draws, requests: &[Request]) -> Vec<u8> {
    let request = &requests[draws.below(requests.len())];
    let (mut session, mut sequence) = (rig.session, rig.sequence + 1);
    let kind = draws.below(6);
    match kind {
        0 => session ^= 1 << draws.below(32),
        1 => sequence = sequence.wrapping_add(1 + u32::try_from(draws.next() >> 33).unwrap()),
        _ => {}
    }
    let mut frame = Frame::new();
    packet::encode(Header { session, sequence }, request, &mut frame).unwrap();
    let mut bytes = frame.to_vec();
    match kind {
        2 => {
            let at = draws.below(bytes.len() - 1);
            bytes[at] ^= 1 << draws.below(8);
        }
        3 => bytes.truncate(1 + draws.below(bytes.len() - 2)),
        4 => {
            // A burst of at most 32 bits, which CRC-32 detects for certain.
            let at = draws.below(bytes.len() - 4);
            for byte in &mut bytes[at..at + 3] {
                *byte ^= draws.byte();
            }
            bytes[at + 3] ^= draws.byte() | 1;
        }
        5 => bytes = (0..draws.below(700)).map(|_| draws.byte()).collect(),
        _ => {}
    }
    bytes.push(0);
    bytes
}

/// Sends wrong frames to a board whose switch permits an enable. The tick runs all the time.
#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
fn garbage_is_never_accepted_and_nothing_moves() {
    let mut rig = Rig::new();
    rig.close_switch();
    let (mut draws, requests) = (Draws(0x5eed), requests());
    let executed = rig.sequence;
    for _ in 0..FRAMES {
        let bytes = wrong_frame(&rig, &mut draws, &requests);
        rig.line.to_board.extend(&bytes);
        while !rig.line.to_board.is_empty() {
            rig.poll();
        }
        rig.poll();
        rig.run(1);
        for reply in rig.replies() {
            // Whole frames of another session or number are answered, with the number that is expected.
            assert!(
                matches!(reply, Reply::Refused(Refusal::Session))
                    || reply == Reply::Refused(Refusal::Sequence { expected: executed + 1 }),
                "{reply:?}"
            );
        }
    }
    let LinkCounts { packets, too_long, too_short, encoding, checksum, version } = rig.status().link;
    // Every kind has occurred, and none was taken for a packet of another version. Only a cut within the first bytes is both
    // COBS and too short.
    for (count, least) in [(packets, 10_000), (too_short, 10), (encoding, 10_000), (checksum, 10_000)] {
        assert!(count > least, "{packets} {too_short} {encoding} {checksum}");
    }
    assert!(too_long > 100 && version == 0, "{too_long} {version}");
    let status = rig.status();
    assert_eq!((status.power, status.not_armed, status.at_rest), (Power::Off, None, true));
    assert_eq!(rig.plant.position_m.map(f64::to_bits), [0; 2]);
    // The link works.
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
}

/// Requests with right numbers in any order, everything but an enable: the board answers each, and the drives stay off.
#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
fn without_an_enable_no_sequence_of_requests_moves_anything() {
    let mut rig = Rig::new();
    rig.close_switch();
    let (mut draws, mut requests) = (Draws(0xfeed), requests());
    requests.retain(|request| *request != Request::Enable);
    requests.extend([
        Request::NewMotion,
        Request::Hold,
        Request::Stop,
        Request::Clear,
        Request::Disable,
        Request::Home { axis: 0 },
        Request::EndCapture,
        Request::Capture,
        Request::FaultHistory,
    ]);
    for _ in 0..FRAMES {
        let request = if draws.below(4) == 0 {
            let bytes = (0..draws.below(380)).map(|_| draws.byte()).collect();
            Request::Upload { offset: u16::try_from(draws.below(1000)).unwrap(), bytes }
        } else {
            requests[draws.below(requests.len())].clone()
        };
        let reply = rig.request(&request);
        assert!(!matches!(reply, Reply::Welcome(_)), "{request:?}");
        assert!(!rig.plant.enabled);
    }
    assert_eq!(rig.status().power, Power::Off);
    assert_eq!(rig.plant.position_m.map(f64::to_bits), [0; 2]);
    // The hello, and every request before the status itself.
    let packets = rig.status().link.packets;
    assert_eq!(packets, rig.sequence);
}
