//! The byte stream in frames of CAN FD: any bytes arrive as they were, padding is never data, and frames that are lost, repeated or exchanged are
//! detected by the packets.

use std::collections::VecDeque;

use proptest::prelude::*;
use shared::link::can_frames::{CONTENT, CanFrame, CanPort, DATA, FramePort, LengthCode};
use shared::link::packet::{self, Header};
use shared::link::session::{SessionState, Verdict};
use shared::link::{BytePort, Frame, Receiver, Request};

/// Data bytes of a frame by its length code (ISO 11898-1, table 5).
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// A bus that takes a number of frames.
#[derive(Default)]
struct Bus {
    frames: VecDeque<CanFrame>,
    places: usize,
}

impl FramePort for Bus {
    fn receive(&mut self) -> Option<CanFrame> {
        self.frames.pop_front()
    }

    fn send(&mut self, frame: &CanFrame) -> bool {
        let fits = self.frames.len() < self.places;
        if fits {
            self.frames.push_back(*frame);
        }
        fits
    }
}

fn port(places: usize) -> CanPort<Bus> {
    CanPort::new(Bus { frames: VecDeque::new(), places })
}

/// The frames of a part of the stream.
fn frames(bytes: &[u8]) -> Vec<CanFrame> {
    let mut port = port(usize::MAX);
    assert_eq!(port.write(bytes), bytes.len());
    port.frames().frames.drain(..).collect()
}

fn bytes(frames: impl IntoIterator<Item = CanFrame>) -> Vec<u8> {
    let mut port = port(0);
    port.frames().frames.extend(frames);
    std::iter::from_fn(|| port.read()).collect()
}

/// Each number of bytes has one frame: its count, the bytes, zeros up to the next length.
#[test]
fn every_number_of_bytes_has_the_shortest_frame() {
    assert_eq!(CanFrame::of_stream(&[]), None);
    for count in 1..=200 {
        let stream = vec![0x5a; count];
        let (frame, taken) = CanFrame::of_stream(&stream).unwrap();
        assert_eq!(taken, count.min(CONTENT));
        let length = *LENGTHS.iter().find(|length| **length > taken).unwrap();
        assert_eq!((frame.length().bytes(), LENGTHS[usize::from(frame.length().code())]), (length, length));
        let mut data = [0; DATA];
        data[0] = u8::try_from(taken).unwrap();
        data[1..=taken].fill(0x5a);
        assert_eq!(*frame.data(), data);
        assert_eq!(frame.stream(), Some(&stream[..taken]));
    }
}

/// No bytes, more bytes than the frame has, a longer frame than they need, and padding that is not zero are refused and counted; what is behind the
/// length of a frame is not looked at.
#[test]
fn other_frames_are_refused() {
    let frame = |code: u8, count: u8, last: Option<(usize, u8)>| {
        let mut data = [0; DATA];
        data[0] = count;
        if let Some((at, byte)) = last {
            data[at] = byte;
        }
        CanFrame::received(LengthCode::from_low_bits(code), data)
    };
    let refused = [
        frame(0, 0, None),
        frame(8, 0, None),
        frame(15, 64, None),
        frame(15, 255, None),
        frame(7, 7, None),
        frame(9, 7, None),
        frame(15, 47, None),
        // Twelve bytes: ten of the stream, the last of padding.
        frame(9, 10, Some((11, 1))),
    ];
    let good = [
        frame(1, 0, Some((0, 0))),
        frame(9, 10, None),
        // Behind the length.
        frame(9, 11, Some((12, 1))),
        frame(0, 63, None),
    ];
    assert!(refused.iter().all(|frame| frame.stream().is_none()), "{refused:?}");
    assert_eq!(good.map(|frame| frame.stream().map(<[u8]>::len)), [None, Some(10), Some(11), None]);
    let mut port = port(0);
    port.frames().frames.extend(refused);
    port.frames().frames.extend(frames(&[1, 2, 3]));
    let read: Vec<u8> = std::iter::from_fn(|| port.read()).collect();
    assert_eq!((read, port.refused()), (vec![1, 2, 3], 8));
}

/// A bus with few places takes the beginning of what is written, and says how much.
#[test]
fn a_full_bus_takes_whole_frames() {
    let mut port = port(2);
    assert_eq!(port.write(&[7; 150]), 2 * CONTENT);
    assert_eq!(port.write(&[7; 24]), 0);
    assert_eq!(port.frames().frames.len(), 2);
    let _ = port.frames().receive();
    assert_eq!(port.write(&[7; 24]), 24);
}

/// Requests of a session as packets, each in frames of its own.
fn requests(count: u32) -> Vec<(u32, Vec<CanFrame>)> {
    let request = |sequence: u32| {
        let mut part = heapless::Vec::new();
        let length = [3, 40, 128, 250][sequence as usize % 4];
        part.extend((0..length).map(|at: u8| at.wrapping_mul(31) ^ sequence.to_le_bytes()[0]));
        let request = Request::Upload { offset: 0, bytes: part };
        let mut frame = Frame::new();
        packet::encode(Header { session: 9, sequence }, &request, &mut frame).unwrap();
        (sequence, frames(&frame))
    };
    (1..=count).map(request).collect()
}

/// The numbers of the packets that arrive, and how many stretches were none.
fn received(frames: impl IntoIterator<Item = CanFrame>) -> (Vec<u32>, usize) {
    let (mut receiver, mut numbers, mut errors) = (Receiver::NEW, Vec::new(), 0);
    for byte in bytes(frames) {
        match receiver.push(byte) {
            Some(Ok(packet)) => {
                let Request::Upload { bytes, .. } = packet::message(packet.message).unwrap() else {
                    panic!("another request")
                };
                let sequence = packet.header.sequence;
                let expected = (0..bytes.len())
                    .map(|at| u8::try_from(at).unwrap().wrapping_mul(31) ^ sequence.to_le_bytes()[0]);
                assert!(bytes.iter().copied().eq(expected), "packet {sequence} has changed");
                numbers.push(sequence);
            }
            Some(Err(_)) => errors += 1,
            None => {}
        }
    }
    (numbers, errors)
}

proptest! {
    /// Any bytes, written in any parts, arrive as they were.
    #[test]
    fn any_bytes_arrive(parts in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..300), 0..12)) {
        let mut port = port(usize::MAX);
        for part in &parts {
            prop_assert_eq!(port.write(part), part.len());
        }
        let read: Vec<u8> = std::iter::from_fn(|| port.read()).collect();
        prop_assert_eq!(read, parts.concat());
        prop_assert_eq!(port.refused(), 0);
    }

    /// Any frame is either refused, or is the one of its bytes.
    #[test]
    fn a_frame_is_that_of_its_bytes_or_refused(code in 0_u8..16, count in 0_u8..70, data in prop::array::uniform32(any::<u8>()), zeros in 0_usize..64) {
        let mut content = [0; DATA];
        content[..32].copy_from_slice(&data);
        content[32..].copy_from_slice(&data);
        content[0] = count;
        content[DATA - zeros..].fill(0);
        let frame = CanFrame::received(LengthCode::from_low_bits(code), content);
        if let Some(stream) = frame.stream() {
            prop_assert_eq!(CanFrame::of_stream(stream), Some((frame, stream.len())));
        }
    }

    /// Frames that are lost, repeated or exchanged: no packet arrives that was not sent, and those that no such frame belongs to arrive.
    #[test]
    fn a_changed_sequence_of_frames_gives_no_other_packet(changes in prop::collection::vec((0_usize..40, 0_u8..3), 0..4)) {
        let sent = requests(12);
        let mut touched = std::collections::BTreeSet::new();
        let mut line: Vec<(u32, CanFrame)> =
            sent.iter().flat_map(|(number, frames)| frames.iter().map(|frame| (*number, *frame))).collect();
        for (at, change) in changes {
            let at = at % line.len();
            // A packet whose end is gone takes the next one with it.
            touched.extend([line[at].0, line[at].0 + 1, line[(at + 1) % line.len()].0, line[(at + 1) % line.len()].0 + 1]);
            match change {
                0 => { line.remove(at); }
                1 => { let copy = line[at]; line.insert(at, copy); }
                _ => { let next = (at + 1) % line.len(); line.swap(at, next); }
            }
        }
        let (numbers, _) = received(line.into_iter().map(|(_, frame)| frame));
        for number in 1..=12 {
            if !touched.contains(&number) {
                prop_assert_eq!(numbers.iter().filter(|found| **found == number).count(), 1, "packet {}", number);
            }
        }
    }
}

/// A frame that the bus repeats: within a packet its checksum fails; as a whole packet its request is executed once.
#[test]
fn a_repeated_frame_executes_nothing_twice() {
    let sent = requests(4);
    let long = &sent[1].1;
    assert!(long.len() > 2);
    let repeated = long.iter().take(2).chain(long.iter().skip(1)).copied();
    assert_eq!(received(repeated), (vec![], 1));
    let mut frame = Frame::new();
    let mut state = SessionState::NEW;
    let session = state.hello(5, 6);
    packet::encode(Header { session, sequence: 1 }, &Request::Status, &mut frame).unwrap();
    let single = frames(&frame);
    assert_eq!(single.len(), 1);
    let (mut receiver, mut verdicts) = (Receiver::NEW, Vec::new());
    for byte in bytes([single[0], single[0]]) {
        if let Some(Ok(packet)) = receiver.push(byte) {
            verdicts.push(state.judge(&packet));
            state.executed(&packet);
        }
    }
    assert_eq!(verdicts, [Verdict::Execute, Verdict::Repeat]);
}
