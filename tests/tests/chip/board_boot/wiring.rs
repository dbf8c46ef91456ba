//! Each wire reaches what it is for: the program that is flashed reads the limit switches of both ends, the home switches, the scales
//! and the index pulses of the axes that the table of `docs/firmware.md` gives them to.

use shared::interpolate::PathError;
use shared::link::message::Jog;
use shared::link::report::AxisStatus;
use shared::link::{Refusal, Reply, Request, Status};
use shared::probing::{ProbeError, ProbeSettings, ProbeStatus};
use shared::units::Position;
use tests::board::Chip;
use tests::board::inputs::{INDEX_STATUS, SCALE_COUNTS};

use super::host::Host;
use super::{End, enabled_by_a_host};

/// Runs for some ticks.
fn run(chip: &mut Chip, ticks: usize) {
    let reached = chip.ticks();
    assert_eq!(chip.run(reached + ticks), Ok(End::Ticked), "{}", chip.diagnostics());
}

fn ask(chip: &mut Chip, host: &mut Host, request: &Request) -> Reply {
    host.send(request);
    run(chip, 40);
    host.reply().unwrap_or_else(|| panic!("no reply to {request:?}; {}", chip.diagnostics()))
}

/// The state of both axes.
fn axes(chip: &mut Chip, host: &mut Host) -> [AxisStatus; 2] {
    status(chip, host).axes.into_array().unwrap()
}

fn status(chip: &mut Chip, host: &mut Host) -> Status {
    match ask(chip, host, &Request::Status) {
        Reply::Status(status) => status,
        reply => panic!("{reply:?}"),
    }
}

/// A jog onto an active switch is refused, and one away from it is accepted. PB1 and PB5 are the ends of X, PB9 and PB13 those of Y.
#[test]
fn each_limit_switch_is_that_of_its_end_and_axis() {
    for (bit, axis, outwards) in [(1, 0, -1.0), (5, 0, 1.0), (9, 1, -1.0), (13, 1, 1.0)] {
        let (mut chip, mut host) = enabled_by_a_host();
        if let Some(inputs) = &mut chip.inputs {
            inputs.open = 1 << bit;
        }
        run(&mut chip, 3);
        let jog = |sign: f64| {
            let distance_m = Some(sign * 1e-3);
            Request::Jog(Jog { axis, distance_m, velocity_m_per_s: 0.01, acceleration_m_per_s2: 0.5 })
        };
        let refused = Refusal::Path { block: 0, error: PathError::LimitSwitch { axis } };
        assert_eq!(ask(&mut chip, &mut host, &jog(outwards)), Reply::Refused(refused), "PB{bit}");
        assert_eq!(ask(&mut chip, &mut host, &jog(-outwards)), Reply::Done, "PB{bit}");
    }
}

/// A homing backs off from its switch, in the positive direction, if it is active, and otherwise searches it in the negative direction.
/// PC9 is the switch of X, PC12 that of Y. After 100 ticks, 5 ms, at 0.5 m/s² the command has moved by 6 µm.
#[test]
fn each_home_switch_is_that_of_its_axis() {
    for (bit, axis, direction) in [(9, 0, 1.0), (12, 0, -1.0), (12, 1, 1.0), (9, 1, -1.0)] {
        let (mut chip, mut host) = enabled_by_a_host();
        if let Some(inputs) = &mut chip.inputs {
            inputs.home = 1 << bit;
        }
        run(&mut chip, 3);
        let start = axes(&mut chip, &mut host).map(|axis| axis.command);
        assert_eq!(ask(&mut chip, &mut host, &Request::Home { axis }), Reply::Done);
        run(&mut chip, 100);
        let now = axes(&mut chip, &mut host).map(|axis| axis.command);
        let moved_um = [0, 1].map(|axis| 1e6 * Position(now[axis] - start[axis]).to_m());
        let [of_axis, of_other] = [moved_um[usize::from(axis)], moved_um[1 - usize::from(axis)]];
        assert!((3.0..60.0).contains(&(direction * of_axis)), "PC{bit}, axis {axis}: {moved_um:?} µm");
        assert!(of_other.abs() < 1e-3, "PC{bit}, axis {axis}: {moved_um:?} µm");
    }
}

/// PA15 is the probe: with an open contact nothing is probed; with a closed one the axis moves until it opens, 3 to 60 µm as in the test above,
/// and the readings are kept, which stand still here.
#[test]
fn the_probe_is_that_of_its_pin() {
    let (mut chip, mut host) = enabled_by_a_host();
    let settings =
        ProbeSettings { distance_m: 1e-3, speed_m_per_s: 0.01, acceleration_m_per_s2: 0.5, retracts: false };
    let request = Request::Probe { axis: 1, settings };
    let refused = Reply::Refused(Refusal::Probe(ProbeError::Active));
    assert_eq!(ask(&mut chip, &mut host, &request), refused);
    let start = status(&mut chip, &mut host).axes[1].command;
    for (contact, is_running) in [(1 << 15, true), (0, false)] {
        if let Some(inputs) = &mut chip.inputs {
            inputs.probe = contact;
        }
        run(&mut chip, 3);
        if is_running {
            assert_eq!(ask(&mut chip, &mut host, &request), Reply::Done);
        }
        run(&mut chip, 100);
        let now = status(&mut chip, &mut host);
        assert_eq!(now.probe == Some(ProbeStatus::Running), is_running, "{:?}", now.probe);
        if let Some(ProbeStatus::Touched(touch)) = now.probe {
            assert_eq!((touch.motor, touch.table), (now.axes[1].motor, now.axes[1].table));
            let moved_um = 1e6 * Position(touch.command - start).to_m();
            assert!((3.0..60.0).contains(&moved_um), "{moved_um} µm");
        } else {
            assert!(is_running, "{:?}", now.probe);
        }
    }
}

/// The scales are displaced by different numbers of counts of 0.5 µm. Without its signal, a scale has no reading, also after the signal
/// has returned; the other one keeps its own.
#[test]
fn each_scale_is_read_on_its_axis_and_lost_with_its_signal() {
    let expected = SCALE_COUNTS.map(|counts| Position::from_m(0.5e-6 * f64::from(counts)));
    // PA3 and PA10.
    for (bit, axis) in [(3, 0), (10, 1)] {
        let (mut chip, mut host) = enabled_by_a_host();
        run(&mut chip, 40);
        let read = axes(&mut chip, &mut host).map(|axis| axis.table);
        for (read, expected) in read.iter().zip(expected) {
            // A position unit for the rounding of a count.
            let off = read.unwrap() - expected.unwrap();
            assert!(off.abs() < 100, "{read:?}, expected {expected:?}");
        }
        for lost in [1 << bit, 0] {
            if let Some(inputs) = &mut chip.inputs {
                inputs.no_signal = lost;
            }
            run(&mut chip, 3);
            let now = axes(&mut chip, &mut host).map(|axis| axis.table);
            let mut expected = read;
            expected[axis] = None;
            assert_eq!(now, expected, "PA{bit}, without a signal: {lost:#x}");
        }
    }
}

/// In each tick the index of the motor and that of the scale are read for X, then for Y.
#[test]
fn each_index_is_read_for_its_axis() {
    let (chip, _host) = enabled_by_a_host();
    let reads = &chip.inputs.as_ref().unwrap().index_reads;
    assert!(reads.len() > 1000, "{}", reads.len());
    for tick in reads.chunks_exact(4) {
        assert_eq!(tick, INDEX_STATUS);
    }
}
