//! Recordings at the tick rate, and the stream.

use shared::capture::{CaptureState, Decoder, FORCE, MOTOR, NO_READING, TABLE, Trigger};
use shared::interpolate::Block;
use shared::link::message::{Reply, Request};
use shared::link::report::CaptureReport;
use shared::link::{Refusal, packet};

use super::rig::{CAPTURE_BYTES, COUNT, Rig, TICK_HZ};
use super::{jog_by, start};

fn report(rig: &mut Rig) -> CaptureReport {
    match rig.request(&Request::Capture) {
        Reply::Capture(report) => report,
        reply => panic!("{reply:?}"),
    }
}

fn read(rig: &mut Rig) -> (CaptureReport, Vec<u8>) {
    let report = report(rig);
    let mut bytes = Vec::new();
    loop {
        let offset = u32::try_from(bytes.len()).unwrap();
        let Reply::Bytes(part) = rig.request(&Request::ReadCapture { offset }) else { panic!("no bytes") };
        if part.is_empty() {
            break;
        }
        bytes.extend_from_slice(&part);
    }
    assert_eq!(bytes.len(), report.bytes as usize);
    (report, bytes)
}

/// Half a second of both axes on a circle at 2 m/min, at 20 kHz, from the start of the motion: it fits the memory, and every
/// sample is the reading of its tick.
#[test]
fn half_a_second_at_the_tick_rate_fits_and_nothing_is_lost() {
    let mut rig = Rig::enabled();
    let arm = Request::Arm { trigger: Trigger::Motion, samples: TICK_HZ / 2 };
    assert_eq!(rig.request(&arm), Reply::Done);
    rig.run(500);
    assert_eq!(report(&mut rig).state, CaptureState::Armed);
    rig.log = true;
    let first_logged = rig.drive.now();
    start(&mut rig, &[Block::arc([0, 1], [-0.03, 0.0], 1.0, 2.0 / 60.0, 1.0)]);
    for _ in 0..12 {
        rig.run(1000);
        assert!(rig.status().power.is_on());
    }
    let (report, bytes) = read(&mut rig);
    assert_eq!((report.state, report.samples, report.period), (CaptureState::Complete, 10_000, 5));
    // A recording that did not compress would take 10,000·2·4·8 = 640 kB. The motion takes a few groups of four bits per
    // channel; less than one each is impossible.
    assert!((40_000..CAPTURE_BYTES).contains(&bytes.len()), "{} bytes", bytes.len());
    println!("{} bytes for 0.5 s", bytes.len());
    let mut decoder = Decoder::<2>::new(report.period, &bytes);
    let mut moved = 0;
    for k in 0..u64::from(report.samples) {
        let sample = decoder.next_sample().unwrap();
        let readings = rig.logged[usize::try_from(report.start + k - first_logged).unwrap()];
        for axis in 0..2 {
            let counts = readings[axis].motor.0 / COUNT;
            assert_eq!((sample[axis][MOTOR], sample[axis][TABLE]), (counts, counts), "sample {k}");
            moved += i64::from(sample[axis][FORCE] != 0);
        }
    }
    assert!(moved > 10_000, "{moved} forces");
}

#[test]
fn a_recording_is_read_only_when_it_is_complete() {
    let mut rig = Rig::new();
    assert_eq!(rig.refusal(&Request::ReadCapture { offset: 0 }), Refusal::NoCapture);
    assert_eq!(rig.request(&Request::Arm { trigger: Trigger::Now, samples: 100 }), Reply::Done);
    assert_eq!(rig.refusal(&Request::ReadCapture { offset: 0 }), Refusal::NoCapture);
    rig.run(200);
    assert_eq!(read(&mut rig).0.samples, 100);
    assert_eq!(rig.request(&Request::ReadCapture { offset: u32::MAX }), Reply::Bytes(heapless::Vec::new()));
}

/// Every fifth tick, numbered without a gap, while the axes move and the link is fast enough.
#[test]
fn a_stream_has_every_sample_in_order() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::Stream { decimation: 5 }), Reply::Done);
    rig.log = true;
    let first_logged = rig.drive.now();
    assert_eq!(rig.request(&jog_by(0.005)), Reply::Done);
    for _ in 0..10 {
        rig.run(1000);
        rig.status();
    }
    assert_eq!(rig.request(&Request::Stream { decimation: 0 }), Reply::Done);
    let (mut next, mut moved) = (0, false);
    for packet in std::mem::take(&mut rig.streamed) {
        assert_eq!((packet.first, packet.lost), (next, 0));
        let mut decoder = Decoder::<2>::new(packet.period, &packet.bytes);
        for k in 0..u64::from(packet.samples) {
            let sample = decoder.next_sample().unwrap();
            let tick = packet.start + 5 * (u64::from(packet.first) + k);
            if let Some(index) = tick.checked_sub(first_logged) {
                let readings = rig.logged[usize::try_from(index).unwrap()];
                assert_eq!(sample[0][MOTOR], readings[0].motor.0 / COUNT);
                moved |= sample[0][MOTOR] > 10_000;
            }
        }
        next = packet.first + u32::from(packet.samples);
    }
    assert!(moved && (1900..2100).contains(&next), "{next} samples");
}

/// A line that takes nothing for 50 ms: samples are lost, and counted by their numbers and by the board.
#[test]
fn lost_samples_are_counted() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&Request::Stream { decimation: 1 }), Reply::Done);
    rig.run(1000);
    // The server is not called.
    for _ in 0..1000 {
        let Rig { drive, plant, .. } = &mut rig;
        drive.tick(plant);
    }
    rig.run(1000);
    let lost = rig.status().lost_samples;
    // The queue has 64 samples.
    assert!((900..=1000).contains(&lost), "{lost} lost");
    let (mut next, mut gaps) = (0, 0);
    for packet in &rig.streamed {
        gaps += packet.first - next;
        next = packet.first + u32::from(packet.samples);
    }
    assert_eq!(gaps, lost);
    // Each packet has the number that was lost up to its end.
    assert_eq!((rig.streamed.first().unwrap().lost, rig.streamed.last().unwrap().lost), (0, lost));
}

#[test]
fn a_lost_scale_is_recorded_as_no_reading() {
    let mut rig = Rig::new();
    assert_eq!(rig.request(&Request::Arm { trigger: Trigger::Now, samples: 100 }), Reply::Done);
    rig.run(50);
    rig.plant.scale_lost = true;
    rig.run(100);
    let (report, bytes) = read(&mut rig);
    let mut decoder = Decoder::<2>::new(report.period, &bytes);
    let samples: Vec<_> = (0..100).map(|_| decoder.next_sample().unwrap()).collect();
    assert!(samples[0][0][TABLE] != NO_READING && samples[99][0][TABLE] == NO_READING);
    assert_eq!(samples[99][0][MOTOR], 0);
}

/// The longest messages of a board fit a packet.
#[test]
fn the_longest_messages_fit_a_packet() {
    use shared::link::message::{FromBoard, HISTORY, READ};
    use shared::link::stream::{STREAM_BYTES, StreamPacket};
    let mut frame = packet::Frame::new();
    let header = packet::Header { session: u32::MAX, sequence: u32::MAX };
    let mut rig = Rig::enabled();
    let Reply::FaultHistory(mut history) = rig.request(&Request::FaultHistory) else { panic!() };
    let entry = shared::link::history::HistoryEntry {
        tick: u64::MAX,
        event: shared::link::history::HistoryEvent::Fault(shared::safety::Fault::Axis {
            axis: u8::MAX,
            kind: shared::safety::FaultKind::LimitSwitch,
        }),
    };
    while history.push(entry).is_ok() {}
    assert_eq!(history.len(), HISTORY);
    let bytes = |n| std::iter::repeat_n(0xff, n).collect();
    let stream = StreamPacket {
        first: u32::MAX,
        start: u64::MAX,
        samples: u16::MAX,
        period: u32::MAX,
        lost: u32::MAX,
        bytes: std::iter::repeat_n(0xff, STREAM_BYTES).collect(),
    };
    for message in [
        FromBoard::Reply(Reply::FaultHistory(history)),
        FromBoard::Reply(Reply::Bytes(bytes(READ))),
        FromBoard::Stream(stream),
    ] {
        assert_eq!(packet::encode(header, &message, &mut frame), Ok(()));
    }
    let Reply::Status(mut status) = rig.request(&Request::Status) else { panic!() };
    let far = shared::units::Position(i64::MIN);
    status.tick = u64::MAX;
    for axis in &mut status.axes {
        (axis.command, axis.motor, axis.table) = (far, far, Some(far));
    }
    assert_eq!(packet::encode(header, &FromBoard::Reply(Reply::Status(status)), &mut frame), Ok(()));
}
