//! What is watched, at its limits: on either side of zero, the last value that is let pass and the first that is not,
//! and the fault in the tick that sees it.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use proptest::prelude::*;
use shared::config::{AxisConfig, AxisSettings, Rates, Sensors};
use shared::interpolate::Block;
use shared::machine::{Machine, Output, Reading};
use shared::monitor::{Monitor, MonitorInput, State};
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

/// A power of two, so that times of 2⁻ⁿ s are whole numbers of ticks.
const RATE_HZ: f64 = 4096.0;

fn rates(position_loop_divider: u32) -> Rates {
    Rates { velocity_loop_hz: RATE_HZ, position_loop_divider }
}

fn place(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn on(axis: u8, kind: FaultKind) -> Power {
    Power::Faulted(Fault::Axis { axis, kind })
}

/// A machine that has been on for a tick at zero, with its second axis watched.
fn standing<S: Scalar>(second: &AxisSettings, divider: u32) -> Machine<S, 2> {
    let settings = [AxisSettings::default(), *second];
    let mut machine = Machine::new(rates(divider), &settings, [Position(0); 2]).unwrap();
    machine.enable();
    assert!(second_at(&mut machine, Position(0), Some(Position(0))).enabled);
    machine
}

/// A tick with the second axis somewhere.
fn second_at<S: Scalar>(
    machine: &mut Machine<S, 2>,
    motor: Position,
    table: Option<Position>,
) -> Output<S, 2> {
    let first = Reading { motor: Position(0), table: Some(Position(0)) };
    machine.tick(&[first, Reading { motor, table }])
}

#[test]
fn motor_and_scale_may_differ_by_the_limit_and_no_unit_more_either_way() {
    // 2⁻¹⁰ m is a whole number of position units.
    let limit_m = 1.0 / 1024.0;
    let limit = place(limit_m).0;
    for sensors in [Sensors::Motor, Sensors::Dual { time_constant_s: 1.0 }] {
        for sign in [1, -1] {
            let axis = AxisSettings {
                sensors,
                scale_disagreement_limit_m: Some(limit_m),
                ..AxisSettings::default()
            };
            let mut machine = standing::<Fixed>(&axis, 1);
            second_at(&mut machine, Position(0), Some(Position(sign * limit)));
            assert_eq!(machine.power(), Power::On, "{sensors:?} {sign}");
            second_at(&mut machine, Position(0), Some(Position(sign * (limit + 1))));
            assert_eq!(machine.power(), on(1, FaultKind::Disagreement), "{sensors:?} {sign}");
        }
    }
}

#[test]
fn a_scale_that_is_not_watched_may_be_anywhere() {
    let mut machine = standing::<Fixed>(&AxisSettings::default(), 1);
    for table in [Some(place(-99.0)), None, Some(place(99.0))] {
        let output = second_at(&mut machine, Position(0), table);
        assert_eq!((machine.power(), output.warning), (Power::On, None));
    }
}

/// Half a step of a signal in fixed point, 2⁻¹⁵ of 1000, and 2⁻²⁴ of the value in f32 are less than this share.
const ROUNDING: f64 = 1e-6;

/// One reading that is `m` from the one before; whether the drives stay on.
fn survives<S: Scalar>(axis: &AxisSettings, m: f64) -> Power {
    let mut machine = standing::<S>(axis, 1);
    let output = second_at(&mut machine, place(m), Some(place(m)));
    assert_eq!(output.enabled, machine.power() == Power::On);
    assert!(output.enabled || output.forces.iter().all(|force| force.value().to_bits() == 0));
    machine.power()
}

/// A motor cannot move faster than v: v·T in a tick is let pass, more is a fault, either way.
fn steps<S: Scalar>() {
    let fastest = 0.5;
    let axis = AxisSettings { fastest_m_per_s: Some(fastest), ..AxisSettings::default() };
    let step = fastest / RATE_HZ;
    for sign in [1.0, -1.0] {
        assert_eq!(survives::<S>(&axis, sign * step * (1.0 - ROUNDING)), Power::On, "{} {sign}", S::NAME);
        let beyond = survives::<S>(&axis, sign * step * (1.0 + ROUNDING));
        assert_eq!(beyond, on(1, FaultKind::EncoderStep), "{} {sign}", S::NAME);
    }
}

#[test]
fn a_motor_may_step_by_its_greatest_speed_either_way() {
    steps::<Fixed>();
    steps::<f32>();
    steps::<f64>();
}

/// Also in the ticks between two position loops.
#[test]
fn a_step_is_seen_in_its_own_tick() {
    for ticks in 1..=5 {
        for sign in [1.0, -1.0] {
            let axis = AxisSettings { fastest_m_per_s: Some(0.5), ..AxisSettings::default() };
            let mut machine = standing::<Fixed>(&axis, 5);
            for _ in 1..ticks {
                assert!(second_at(&mut machine, Position(0), None).enabled);
            }
            assert!(!second_at(&mut machine, place(sign * 0.6 / RATE_HZ), None).enabled);
            assert_eq!(machine.power(), on(1, FaultKind::EncoderStep));
        }
    }
}

fn follows<S: Scalar>() {
    let limit = 2e-3;
    let axis = AxisSettings { following_error_limit_m: limit, ..AxisSettings::default() };
    for sign in [1.0, -1.0] {
        assert_eq!(survives::<S>(&axis, sign * limit * (1.0 - ROUNDING)), Power::On, "{} {sign}", S::NAME);
        let beyond = survives::<S>(&axis, sign * limit * (1.0 + ROUNDING));
        assert_eq!(beyond, on(1, FaultKind::FollowingError), "{} {sign}", S::NAME);
    }
}

#[test]
fn an_axis_may_be_off_its_command_by_the_limit_either_way() {
    follows::<Fixed>();
    follows::<f32>();
    follows::<f64>();
}

/// Axes that are where they are commanded to be, along a line from zero, until the machine is off or done: the
/// commands, and the state in each tick. The travel is narrowed once the line is taken: one that leads out of it is not.
fn travelled(settings: &[AxisSettings; 2], to_m: [f64; 2], feed: f64) -> Vec<([f64; 2], Power)> {
    let wide = settings.map(|axis| AxisSettings { travel_m: None, ..axis });
    let mut machine = Machine::<Fixed, 2>::new(rates(1), &wide, [Position(0); 2]).unwrap();
    machine.push(&Block::line(to_m, feed, 0.5)).unwrap();
    for (number, axis) in settings.iter().enumerate() {
        machine.change(number, axis).unwrap();
    }
    machine.enable();
    let (mut at, mut rows) = ([Position(0); 2], Vec::new());
    loop {
        let output = machine.tick(&at.map(|motor| Reading { motor, table: None }));
        at = output.commands;
        rows.push((at.map(Position::to_m), machine.power()));
        if output.done || !machine.power().is_on() {
            return rows;
        }
        assert!(rows.len() < 100_000, "no end");
    }
}

#[test]
fn a_command_stops_where_it_passes_either_end_of_the_travel_and_not_on_it() {
    let travel = [-0.02, 0.03];
    let limited = AxisSettings { travel_m: Some(travel), ..AxisSettings::default() };
    for axis in [0, 1] {
        let mut settings = [AxisSettings::default(); 2];
        settings[usize::from(axis)] = limited;
        for end in travel {
            let to_m = |m: f64| if axis == 0 { [m, 0.0] } else { [0.0, m] };
            let rows = travelled(&settings, to_m(end), 0.05);
            assert!(rows.iter().all(|(_, power)| *power == Power::On), "stopped on the way to {end} m");
            assert_eq!(place(rows.last().unwrap().0[usize::from(axis)]), place(end));

            let stopping = Power::Stopping(Fault::Axis { axis, kind: FaultKind::SoftLimit });
            let rows = travelled(&settings, to_m(2.0 * end), 0.05);
            let first = rows.iter().position(|(_, power)| *power == stopping).unwrap();
            let beyond = |row: &([f64; 2], Power)| row.0[usize::from(axis)].abs() > end.abs();
            assert!(rows[..first].iter().all(|row| !beyond(row) && row.1 == Power::On));
            assert!(beyond(&rows[first]));
            assert_eq!(rows.last().unwrap().1, on(axis, FaultKind::SoftLimit));
        }
    }
}

/// A path that stops with a takes v/a and v²/2a: a the least of the axes' decelerations, whichever axis has it and
/// whichever is at fault.
#[test]
fn a_path_stops_with_the_least_deceleration_of_its_axes() {
    let feed = 0.1;
    for decelerations in [[4.0, 1.0], [1.0, 4.0], [2.0, 2.0]] {
        let [x, y] = decelerations.map(|stop_deceleration_m_per_s2| AxisSettings {
            stop_deceleration_m_per_s2,
            ..AxisSettings::default()
        });
        let least = decelerations[0].min(decelerations[1]);
        let settings = [AxisSettings { travel_m: Some([-0.06, 0.06]), ..x }, y];
        // 3-4-5: five metres of path are three of x.
        let rows = travelled(&settings, [0.3, 0.4], feed);
        let stopping = rows.iter().filter(|(_, power)| matches!(power, Power::Stopping(_))).count();
        // One tick more sees the command beyond its end, one that it stands; both slow down already.
        let expected = feed / least * RATE_HZ;
        assert!((stopping as f64 - expected).abs() <= 2.0, "{stopping} ticks of {expected}");
        let path_m = (rows[rows.len() - 2].0[0] - 0.06) / 0.6;
        let expected = feed * feed / (2.0 * least);
        // One tick at full speed, before and behind: 24 µm each.
        assert!((path_m - expected).abs() < 2.0 * feed / RATE_HZ, "{path_m} m of {expected}");
    }
}

/// What a monitor sees of an axis that is where it is commanded to be, but for its motor reading.
fn sees(
    monitor: &Monitor<Fixed>,
    state: &mut State<Fixed>,
    [command, motor]: [i64; 2],
    velocity: f64,
) -> Vec<FaultKind> {
    let seen = MonitorInput {
        following_error: Fixed::ZERO,
        command: Position(command),
        velocity_command: Fixed::signal(velocity),
        motor: Position(motor),
        table: None,
        uses_scale: false,
    };
    monitor.position(state, &seen).iter().collect()
}

/// 1 pm, by which the filters behind the path may miss an end, in position units.
const PICOMETRE: i64 = PER_NM / 1000;

/// An axis that comes on beyond its travel may stand there and go back. What it has come back by is closed behind it, and
/// a command that goes out again, by more than the filters behind the path may, is seen in every tick.
#[test]
fn the_way_back_from_beyond_the_travel_is_open_and_closes_behind_the_axis() {
    let axis = AxisSettings { travel_m: Some([-0.02, 0.03]), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    for (end, outwards) in [(0.03, 1), (-0.02, -1)] {
        let at = |units: i64| place(end).0 + outwards * units;
        let mut state = State::at(Position(at(1_000_000)), Position(0));
        let mut sees = |units| sees(&monitor, &mut state, [at(units), 0], 0.0);
        let none: [FaultKind; 0] = [];
        for units in [1_000_000, 1_000_000 + PICOMETRE, 999_999, 500_000, 500_000 + PICOMETRE] {
            assert_eq!(sees(units), none, "{units}");
        }
        for units in [500_001 + PICOMETRE, 600_000, 1_000_000, 500_001 + PICOMETRE] {
            assert_eq!(sees(units), [FaultKind::SoftLimit], "{units}");
        }
        // Where it was last, inside, on the end, and as little out as makes no difference.
        for units in [500_000, 1, 0, -1000, 0, PICOMETRE] {
            assert_eq!(sees(units), none, "{units}");
        }
        assert_eq!(sees(PICOMETRE + 1), [FaultKind::SoftLimit]);
    }
}

/// A command that goes out in steps smaller than that is not let pass for it.
#[test]
fn small_steps_do_not_lead_out_of_the_travel() {
    let axis = AxisSettings { travel_m: Some([-0.02, 0.03]), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    for (end, outwards) in [(0.03, 1), (-0.02, -1)] {
        let end = place(end).0;
        let mut state = State::at(Position(end), Position(0));
        let step = |k: i64| end + outwards * k * PICOMETRE / 2;
        let first = (1..10).find(|&k| !sees(&monitor, &mut state, [step(k), 0], 0.0).is_empty());
        assert_eq!(first, Some(3), "{outwards}: two halves of a picometre pass, a third does not");
    }
}

/// While the motor reading stands, the velocity loop may ask for the limit, and command for as much, either way; the
/// reading stands until it has moved by more than a 64th of the limit.
#[test]
fn a_motor_reading_may_stand_while_no_more_than_the_limit_is_asked_for() {
    // 2⁻¹⁰ m is a whole number of position units, and of 64 times that.
    let axis = AxisSettings { frozen_encoder_limit_m: Some(1.0 / 1024.0), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    let (limit, part) = (place(1.0 / 1024.0).0, place(1.0 / 65_536.0).0);
    // A velocity unit is 2⁴ units of error a second, 2⁻⁸ of them in a tick of 2⁻¹² s, and these are 2³⁰ position units.
    let velocity = 4096.0;
    // The tick after the one that goes beyond the limit sees it.
    let ticks = usize::try_from(limit / (4096 << 22) + 1).unwrap();
    for sign in [1, -1] {
        let frozen = |command: i64, motor: i64, state: &mut State<Fixed>| {
            let asked = f64::from(i32::try_from(sign).unwrap()) * velocity;
            let seen = (1..200).map(|_| sees(&monitor, state, [sign * command, sign * motor], asked));
            seen.take_while(Vec::is_empty).count()
        };
        let start = || State::at(Position(0), Position(0));
        assert_eq!(frozen(limit + 1, part, &mut start()), ticks, "{sign}");
        assert_eq!(frozen(limit + 1, -part, &mut start()), ticks, "{sign}");
        // A command that has not gone further than the limit: a load may be what the loop asks a velocity against.
        assert_eq!(frozen(limit, part, &mut start()), 199, "{sign}");
        // A motor that moves begins it anew.
        let mut state = start();
        assert_eq!(frozen(10 * limit, part, &mut state), ticks, "{sign}");
        assert!(sees(&monitor, &mut state, [sign * 10 * limit, sign * (part + 1)], 0.0).is_empty());
        assert_eq!(frozen(11 * limit, 2 * part + 1, &mut state), 199, "{sign}");
        // Enough has been asked for by then: what is left is the command.
        assert_eq!(frozen(11 * limit + 1, 2 * part + 1, &mut state), 0, "{sign}");
    }
    let unwatched = AxisConfig::<Fixed>::new(&AxisSettings::default(), rates(1)).unwrap().monitor;
    assert_eq!(sees(&unwatched, &mut State::at(Position(0), Position(0)), [1 << 50, 0], 1e5), []);
}

/// The monitor of an axis whose force may stand at its limit for so many ticks.
fn patient<S: Scalar>(ticks: u32) -> Monitor<S> {
    let axis = AxisSettings { saturation_time_s: f64::from(ticks) / RATE_HZ, ..AxisSettings::default() };
    AxisConfig::new(&axis, rates(1)).unwrap().monitor
}

/// The tick, counted from 1, in which the force has been at its limit for too long.
fn too_long(ticks: u32, at_limit: impl IntoIterator<Item = bool>) -> Option<usize> {
    let (monitor, mut state) = (patient::<Fixed>(ticks), State::at(Position(0), Position(0)));
    let seen = at_limit.into_iter().map(|limited| monitor.velocity(&mut state, Fixed::default(), limited));
    let found = seen.enumerate().find_map(|(tick, faults)| faults.iter().next().map(|kind| (tick + 1, kind)));
    found.map(|(tick, kind)| {
        assert_eq!(kind, FaultKind::ForceSaturated);
        tick
    })
}

#[test]
fn a_force_may_stand_at_its_limit_for_its_time_and_no_tick_longer() {
    for ticks in [1usize, 2, 40, 4096] {
        let time = u32::try_from(ticks).unwrap();
        assert_eq!(too_long(time, vec![true; ticks]), None);
        assert_eq!(too_long(time, vec![true; ticks + 1]), Some(ticks + 1));
    }
}

/// Of n ticks at the limit, four ticks off it take one: after 4k of them k more are let pass. One tick off it less
/// leaves a part of a tick, which is not a tick; one more gives a tick back.
#[test]
fn ticks_off_the_limit_take_a_quarter_of_theirs_back() {
    let ticks = 40;
    let (n, k) = (40, 7);
    for (off, more) in [(4 * k - 1, k), (4 * k, k), (4 * k + 1, k + 1), (4 * k + 4, k + 1)] {
        let sequence = [vec![true; n], vec![false; off], vec![true; 2 * n]].concat();
        assert_eq!(too_long(ticks, sequence), Some(n + off + more + 1), "{off} off");
    }
    // However long it was off, there are never more than n ticks to spend.
    let sequence = [vec![true; n], vec![false; 100_000], vec![true; 2 * n]].concat();
    assert_eq!(too_long(ticks, sequence), Some(n + 100_000 + n + 1));
}

/// One tick of five at the limit: 1 − 4/4 = 0 a period, for ever. One of four: 1 − ¾ a period, so that the k-th
/// period begins with k/4, and its first tick is one too many where k/4 + 1 is n + 1.
#[test]
fn a_fifth_of_the_time_at_the_limit_is_let_pass_for_ever_and_a_quarter_is_not() {
    let every = |period: usize| (0..1_000_000).map(move |tick| tick % period == 0);
    for ticks in [1, 10, 300] {
        assert_eq!(too_long(ticks, every(5)), None);
        assert_eq!(too_long(ticks, every(4)), Some(4 * 4 * ticks as usize + 1));
    }
}

proptest! {
    /// Against the same sum in fractions of a tick, which f64 holds exactly.
    #[test]
    fn any_sequence_is_the_sum_of_its_ticks(
        ticks in 1u32..60,
        runs in prop::collection::vec((any::<bool>(), 0usize..80), 1..30),
    ) {
        let sequence: Vec<bool> = runs.into_iter().flat_map(|(limited, ticks)| vec![limited; ticks]).collect();
        let mut stood = 0.0f64;
        let expected = sequence.iter().position(|limited| {
            stood = if *limited { stood + 1.0 } else { (stood - 0.25).max(0.0) };
            *limited && stood.floor() > f64::from(ticks)
        });
        prop_assert_eq!(too_long(ticks, sequence), expected.map(|tick| tick + 1));
    }
}

/// A motor that is held 1 mm off asks for Kv·Kp·1 mm = 1650 N; at a limit of 100 N the path stops in the tick after the
/// declared number of them.
fn stops_after<S: Scalar>() {
    for sign in [1.0, -1.0] {
        let axis =
            AxisSettings { force_limit_n: 100.0, saturation_time_s: 1.0 / 64.0, ..AxisSettings::default() };
        let mut machine = standing::<S>(&axis, 1);
        let ticks = (1..1000).find(|_| {
            second_at(&mut machine, place(sign * 1e-3), None);
            machine.power() != Power::On
        });
        assert_eq!(ticks, Some(64 + 1), "{}", S::NAME);
        let stopping = Power::Stopping(Fault::Axis { axis: 1, kind: FaultKind::ForceSaturated });
        assert_eq!(machine.power(), stopping, "{}", S::NAME);
    }
}

#[test]
fn a_machine_stops_when_a_force_has_stood_at_its_limit_for_too_long() {
    stops_after::<Fixed>();
    stops_after::<f32>();
    stops_after::<f64>();
}
