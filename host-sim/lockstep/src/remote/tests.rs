use shared::lockstep::session::{NoMeter, Session};

use super::*;

/// A direct connection to the session of the chip's program.
#[derive(Default)]
struct Direct {
    session: Session,
    /// Whether answers are overwritten.
    is_damaged: bool,
}

impl Connection for Direct {
    fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
        let answer = self.session.answer(frame, &mut NoMeter).ok_or("ended")?;
        protocol::encode(&answer, frame).map_err(|error| error.to_string())?;
        if self.is_damaged {
            frame.fill(0xff);
        }
        Ok(())
    }
}

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
const FORMATS: [Format; 3] = [Format::Fixed, Format::F32, Format::F64];

fn line(to_m: &[f64]) -> PathBlock {
    PathBlock::new(PathShape::Line { to_m: to_m.to_vec() }, 0.1, 2.0)
}

fn arc(plane: [u8; 2]) -> PathBlock {
    let shape = PathShape::Arc { plane, centre_m: [0.02, 0.0], turns: 0.3 };
    PathBlock { shape, ..line(&[]) }
}

/// Runs both controllers with the command of the previous tick plus a drift as readings, and compares their outputs.
fn assert_same(
    mut local: Box<dyn Controller>,
    mut remote: Remote<Direct>,
    blocks: &[PathBlock],
    axes: usize,
) {
    for controller in [local.as_mut(), &mut remote as &mut dyn Controller] {
        for block in blocks {
            controller.push(block).unwrap();
        }
        controller.enable().unwrap();
    }
    let mut outputs = vec![AxisOutput::default(); axes];
    let mut others = outputs.clone();
    for k in 0..5000 {
        let reading =
            |out: &AxisOutput| Reading { motor: out.command + 1000 * k, table: Some(out.command + 500 * k) };
        let readings: Vec<_> = outputs.iter().map(reading).collect();
        let status = local.tick(&readings, &mut outputs).unwrap();
        let other = remote.tick(&readings, &mut others).unwrap();
        assert_eq!((&outputs, status.power, status.done), (&others, other.power, other.done), "tick {k}");
    }
}

#[test]
fn one_axis_gives_the_same_bits_as_in_this_process() {
    let sensors =
        shared::config::Sensors::Dual { time_constant_s: 0.01, limits: shared::config::ScaleLimits::DEFAULT };
    let settings = [AxisSettings { sensors, ..AxisSettings::default() }];
    // This position has no exact value in f64 metres.
    let start = [Position((1 << 56) + 12_345_677)];
    for format in FORMATS {
        let local = in_process(format, RATES, &settings, &start).unwrap();
        let remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
        assert_same(local, remote, &[line(&[68.73]), line(&[68.71])], 1);
    }
}

#[test]
fn two_axes_give_the_same_bits_as_in_this_process() {
    let settings =
        [AxisSettings::default(), AxisSettings { law: shared::config::Law::Hpc, ..AxisSettings::default() }];
    let start = [Position(0), Position(0)];
    for format in FORMATS {
        let local = in_process(format, RATES, &settings, &start).unwrap();
        let remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
        assert_same(local, remote, &[arc([0, 1]), line(&[0.0, 0.0])], 2);
    }
}

#[test]
fn settings_are_refused_with_the_same_message_as_in_this_process() {
    let here = |settings: &[AxisSettings], start: &[Position]| {
        in_process(Format::Fixed, RATES, settings, start).err().map(|error| error.to_string())
    };
    let there = |settings: &[AxisSettings], start: &[Position]| {
        Remote::set_up(Direct::default(), Format::Fixed, RATES, settings, start)
            .err()
            .map(|error| error.to_string())
    };
    let good = AxisSettings::default();
    let bad = AxisSettings { position_gain_per_s: -1.0, ..good };
    for settings in [&[good, bad][..], &[bad], &[], &[good; 4]] {
        let start = vec![Position(0); settings.len()];
        assert!(here(settings, &start).is_some());
        assert_eq!(there(settings, &start), here(settings, &start));
    }
    assert_eq!(
        there(&[good; 3], &[Position(0); 3]).unwrap(),
        "port: expected a machine of 1 to 2 axes, found 3"
    );
}

#[test]
fn blocks_are_refused_with_the_same_message_as_in_this_process() {
    let far =
        PathBlock { shape: PathShape::Arc { plane: [0, 0], centre_m: [1e9, 0.0], turns: 1.0 }, ..line(&[]) };
    let to = PathBlock {
        shape: PathShape::ArcTo { plane: [0, 1], centre_m: [0.01, 0.0], to_m: [0.5, 0.0], positive: true },
        ..line(&[])
    };
    let blocks = [line(&[0.0]), line(&[0.0, 0.0]), line(&[f64::NAN, 1.0]), arc([0, 1]), arc([0, 2]), far, to];
    for axes in [1, 2] {
        let settings = vec![AxisSettings::default(); axes];
        let start = vec![Position(0); axes];
        for block in &blocks {
            let mut local = in_process(Format::Fixed, RATES, &settings, &start).unwrap();
            let mut remote =
                Remote::set_up(Direct::default(), Format::Fixed, RATES, &settings, &start).unwrap();
            let words = |pushed: Result<(), ControllerError>| pushed.map_err(|error| error.to_string());
            assert_eq!(words(remote.push(block)), words(local.push(block)), "{axes} axes, {block:?}");
        }
    }
}

/// With a compensation on each axis, set before the motion: the same bits as in this process, and other bits than
/// without it.
#[test]
fn a_compensation_gives_the_same_bits_as_in_this_process() {
    let settings = [AxisSettings::default(); 2];
    let start = [Position(0), Position(0)];
    let compensation = CompensationSettings {
        backlash_width_m: Some(5e-6),
        squareness: Some((1, 3e-5)),
        ..CompensationSettings::default()
    };
    for format in FORMATS {
        let mut local = in_process(format, RATES, &settings, &start).unwrap();
        let mut remote = Remote::set_up(Direct::default(), format, RATES, &settings, &start).unwrap();
        local.compensate(0, &compensation).unwrap();
        remote.compensate(0, &compensation).unwrap();
        assert_same(local, remote, &[arc([0, 1]), line(&[0.0, 0.0])], 2);
    }
}

#[test]
fn compensations_are_refused_with_the_same_message_as_in_this_process() {
    let none = CompensationSettings::default();
    let wide = CompensationSettings { backlash_width_m: Some(1.0), ..none.clone() };
    let other_axis = CompensationSettings { squareness: Some((1, 3e-5)), ..none.clone() };
    for axes in [1, 2] {
        let settings = vec![AxisSettings::default(); axes];
        let start = vec![Position(0); axes];
        for (axis, compensation) in [(0, &none), (0, &wide), (0, &other_axis), (1, &none), (2, &none)] {
            let mut local = in_process(Format::Fixed, RATES, &settings, &start).unwrap();
            let mut remote =
                Remote::set_up(Direct::default(), Format::Fixed, RATES, &settings, &start).unwrap();
            let words = |set: Result<(), ControllerError>| set.map_err(|error| error.to_string());
            let here = words(local.compensate(axis, compensation));
            assert_eq!(words(remote.compensate(axis, compensation)), here);
            let is_refused = std::ptr::eq(compensation, &raw const wide)
                || axis >= axes
                || axes == 1 && compensation.squareness.is_some();
            assert_eq!(here.is_err(), is_refused, "{axes} axes, axis {axis}: {here:?}");
        }
    }
}

#[test]
fn a_damaged_answer_is_an_error_of_the_link() {
    let connection = Direct { is_damaged: true, ..Direct::default() };
    let error =
        Remote::set_up(connection, Format::Fixed, RATES, &[AxisSettings::default()], &[Position(0)]).err();
    let Some(ControllerError::Link(message)) = error else { panic!("{error:?}") };
    assert!(message.contains("unexpected answer") && !message.contains('\n'), "{message}");
}

/// Answers every frame by the same answer.
struct Other(Answer);

impl Connection for Other {
    fn exchange(&mut self, frame: &mut Frame) -> Result<(), String> {
        protocol::encode(&self.0, frame).map_err(|error| error.to_string())
    }
}

#[test]
fn a_program_of_another_version_is_refused() {
    assert!(identify(&mut Direct::default()).is_ok());
    // A version that does not know the order answers that it cannot read it.
    for answer in [Answer::Sources(SOURCES ^ 1), Answer::Rejected(Rejection::Unreadable), Answer::Ready] {
        let message = identify(&mut Other(answer)).unwrap_err().to_string();
        assert!(message.contains("build it with `cargo emulated`"), "{message}");
    }
}
