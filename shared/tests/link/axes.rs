//! Messages of boards of 1 to 4 axes: each carries its number, and only a board with that number takes it.

use proptest::prelude::*;
use shared::capture::ChannelSteps;
use shared::config::{AxisSettings, Rates};
use shared::figures::{AxisRms, SignalFigures};
use shared::interpolate::{Block, BlockOf};
use shared::link::board_settings::UploadedSettings;
use shared::link::message::{BoardSettings, FromBoard, MAX_AXES, PerAxis, Reply, Request};
use shared::link::packet;
use shared::link::refusal::UploadError;
use shared::link::report::{AxisStatus, GantryStatus};
use shared::link::steps::ListedSteps;
use shared::link::{Frame, Header, Refusal};
use shared::units::Position;

use super::rig::Rig;

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

/// The request as a board reads it.
fn sent(request: &Request) -> Request {
    let mut frame = Frame::new();
    packet::encode(Header { session: 1, sequence: 1 }, request, &mut frame).unwrap();
    let end = frame.len() - 1;
    packet::message(packet::decode(&mut frame[..end]).unwrap().message).unwrap()
}

/// An upload.
fn bytes_of(settings: &impl serde::Serialize) -> Vec<u8> {
    let mut bytes = vec![0; 4096];
    postcard::to_slice(settings, &mut bytes).unwrap().to_vec()
}

/// What boards of 1 to 4 axes read of a block.
fn read_by_all(block: &BlockOf<PerAxis<f64>>) -> [Option<Vec<f64>>; MAX_AXES] {
    fn end<const N: usize>(block: &BlockOf<PerAxis<f64>>) -> Option<Vec<f64>> {
        let Block { shape, .. } = block.of_axes::<N>()?;
        match shape {
            shared::interpolate::block::Shape::Line { to_m } => Some(to_m.to_vec()),
            _ => None,
        }
    }
    [end::<1>(block), end::<2>(block), end::<3>(block), end::<4>(block)]
}

/// What boards of 1 to 4 axes read of settings.
fn settings_of_all(bytes: &[u8]) -> [Result<Vec<AxisSettings>, Refusal>; MAX_AXES] {
    fn axes<const N: usize>(bytes: &[u8]) -> Result<Vec<AxisSettings>, Refusal> {
        Ok(BoardSettings::<N>::read(bytes)?.axes.to_vec())
    }
    [axes::<1>(bytes), axes::<2>(bytes), axes::<3>(bytes), axes::<4>(bytes)]
}

fn axes_of_settings() -> impl Strategy<Value = Vec<AxisSettings>> {
    let axis = (1.0..100.0f64, 1.0..300.0f64).prop_map(|(position_gain_per_s, force_limit_n)| AxisSettings {
        position_gain_per_s,
        force_limit_n,
        ..AxisSettings::default()
    });
    proptest::collection::vec(axis, 1..=MAX_AXES)
}

proptest! {
    /// A line is read by the board with as many axes, to the bit, and by no other.
    #[test]
    fn a_line_is_of_a_number_of_axes(to_m in proptest::collection::vec(-1.0..1.0f64, 1..=MAX_AXES)) {
        let request = Request::AddBlock(BlockOf::line_to(to_m.iter().copied().collect(), 0.03, 0.5));
        let read = sent(&request);
        prop_assert_eq!(&read, &request);
        let Request::AddBlock(block) = read else { panic!("{read:?}") };
        for (index, end) in read_by_all(&block).into_iter().enumerate() {
            prop_assert_eq!(end, (index + 1 == to_m.len()).then(|| to_m.clone()));
        }
    }

    /// Settings are read by the board with as many axes, and refused by every other with its number.
    #[test]
    fn settings_are_of_a_number_of_axes(axes in axes_of_settings(), rest in proptest::collection::vec(any::<u8>(), 1..8)) {
        let bytes = bytes_of(&UploadedSettings { rates: RATES, axes: &axes });
        for (board, read) in (1u8..).zip(settings_of_all(&bytes)) {
            let is_its_own = usize::from(board) == axes.len();
            prop_assert_eq!(read, if is_its_own { Ok(axes.clone()) } else { Err(Refusal::Axes { board }) });
        }
        let unreadable = Err(Refusal::Upload(UploadError::Unreadable));
        let longer = [&bytes[..], &rest].concat();
        for wrong in [&bytes[..bytes.len() - 1], &longer] {
            prop_assert_eq!(&settings_of_all(wrong)[axes.len() - 1], &unreadable);
        }
    }
}

/// The upload of a host, which knows the number at run time, is the one of the board's own type.
#[test]
fn both_forms_of_the_settings_have_the_same_bytes() {
    let axis = AxisSettings::default();
    let of_board = bytes_of(&BoardSettings { rates: RATES, axes: [axis; 3] });
    let of_host = bytes_of(&UploadedSettings { rates: RATES, axes: &[axis; 3] });
    assert_eq!(of_board, of_host);
}

#[test]
fn steps_are_of_a_number_of_axes() {
    let steps = ChannelSteps::<3>::of_counts([1e-6, 2e-6, 3e-6], [0.1e-6; 3], 5);
    let listed = ListedSteps::from(&steps);
    assert_eq!(listed.of_axes::<3>(), Some(steps));
    assert_eq!((listed.of_axes::<2>(), listed.of_axes::<4>()), (None, None));
}

/// A board of two axes refuses what is meant for another number, and nothing has changed.
#[test]
fn a_board_refuses_another_number_of_axes() {
    let mut rig = Rig::enabled();
    let refused = Refusal::Axes { board: 2 };
    assert_eq!(rig.request(&Request::NewMotion), Reply::Done);
    assert_eq!(rig.refusal(&Request::add_block(Block::line([0.01], 0.03, 0.5))), refused);
    assert_eq!(rig.refusal(&Request::add_block(Block::line([0.01, 0.0, 0.0], 0.03, 0.5))), refused);
    assert_eq!(rig.refusal(&Request::StartMotion { blocks: 1 }), Refusal::BlockCount { found: 0 });
    assert_eq!(rig.refusal(&Request::Home { axis: 2 }), Refusal::NoSuchAxis);
}

/// The longest state of the largest board fits a packet.
#[test]
fn the_state_of_four_axes_fits_a_packet() {
    let mut rig = Rig::enabled();
    let mut status = rig.status();
    let far = Position(i64::MIN);
    status.tick = u64::MAX;
    status.blocks_left = u16::MAX;
    status.lost_samples = u32::MAX;
    let figures =
        SignalFigures { amplitude_counts: 1e30, level_db: 1e30, phase_deg: 1e30, health_percent: 1e30 };
    let axis = AxisStatus {
        command: far,
        motor: far,
        table: Some(far),
        force_n: 1e30,
        homed: true,
        signals: Some(figures),
        rms: Some(AxisRms { error_nm: 1e30, force_n: 1e30 }),
        counter: Some(u32::MAX),
        lag: Some(i64::MIN),
        gantry: Some(GantryStatus { first: u8::MAX, skew: i64::MIN }),
    };
    status.axes = std::iter::repeat_n(axis, MAX_AXES).collect();
    status.link.packets = u32::MAX;
    let mut frame = Frame::new();
    let header = Header { session: u32::MAX, sequence: u32::MAX };
    assert_eq!(packet::encode(header, &FromBoard::Reply(Reply::Status(status)), &mut frame), Ok(()));
}
