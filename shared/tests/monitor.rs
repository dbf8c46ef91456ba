//! The limits of the monitor, for both signs: the greatest value that passes, the least that is a fault, and the tick in
//! which the fault is raised.

use proptest::prelude::*;
use shared::config::{AxisConfig, AxisSettings, Rates, ScaleLimits, Sensors};
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

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

const fn on(axis: u8, kind: FaultKind) -> Power {
    Power::Faulted(Fault::Axis { axis, kind })
}

const fn frozen_alone(limit_m: f64) -> Sensors {
    Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(limit_m) }
}

/// A machine that has been on for a tick at zero, with these settings of the second axis.
fn at_standstill<S: Scalar>(second: &AxisSettings, divider: u32) -> Machine<S, 2> {
    let settings = [AxisSettings::default(), *second];
    let mut machine = Machine::new(rates(divider), &settings, [Position(0); 2]).unwrap();
    machine.enable();
    assert!(tick_second_axis(&mut machine, Position(0), Some(Position(0))).enabled);
    machine
}

/// A tick with these readings of the second axis; the first axis is at zero.
fn tick_second_axis<S: Scalar>(
    machine: &mut Machine<S, 2>,
    motor: Position,
    table: Option<Position>,
) -> Output<S, 2> {
    let first = Reading { motor: Position(0), table: Some(Position(0)) };
    machine.tick(&[first, Reading { motor, table }])
}

#[test]
fn motor_and_scale_may_differ_by_the_limit_and_no_unit_more_either_way() {
    // 2⁻¹² m is a whole number of position units, and less than what one reading may move alone.
    let limit_m = 1.0 / 4096.0;
    let limit = position(limit_m).0;
    let alone = Sensors::Motor { scale_disagreement_limit_m: Some(limit_m), frozen_encoder_limit_m: None };
    let limits = ScaleLimits { disagreement_m: limit_m, ..ScaleLimits::DEFAULT };
    for sensors in [alone, Sensors::Dual { time_constant_s: 1.0, limits }] {
        for sign in [1, -1] {
            let axis = AxisSettings { sensors, ..AxisSettings::default() };
            let mut machine = at_standstill::<Fixed>(&axis, 1);
            tick_second_axis(&mut machine, Position(0), Some(Position(sign * limit)));
            assert_eq!(machine.power(), Power::On, "{sensors:?} {sign}");
            tick_second_axis(&mut machine, Position(0), Some(Position(sign * (limit + 1))));
            assert_eq!(machine.power(), on(1, FaultKind::Disagreement), "{sensors:?} {sign}");
        }
    }
}

#[test]
fn an_unmonitored_scale_raises_no_fault() {
    let mut machine = at_standstill::<Fixed>(&AxisSettings::default(), 1);
    for table in [Some(position(-99.0)), None, Some(position(99.0))] {
        let output = tick_second_axis(&mut machine, Position(0), table);
        assert_eq!((machine.power(), output.warning), (Power::On, None));
    }
}

/// Greater than the relative rounding of a limit: 2⁻¹⁵ of more than 1000 units in fixed point, 2⁻²⁴ in f32.
const ROUNDING: f64 = 1e-6;

/// The power state after a reading that is `m` metres from the one before.
fn after_jump<S: Scalar>(axis: &AxisSettings, m: f64) -> Power {
    let mut machine = at_standstill::<S>(axis, 1);
    let output = tick_second_axis(&mut machine, position(m), Some(position(m)));
    assert_eq!(output.enabled, machine.power() == Power::On);
    assert!(output.enabled || output.forces.iter().all(|force| force.value().to_bits() == 0));
    machine.power()
}

/// With the greatest speed v of a motor, a step of v·T per tick passes and a greater one is a fault, in both directions.
fn encoder_steps<S: Scalar>() {
    let fastest = 0.5;
    let axis = AxisSettings { fastest_m_per_s: Some(fastest), ..AxisSettings::default() };
    let step = fastest / RATE_HZ;
    for sign in [1.0, -1.0] {
        assert_eq!(after_jump::<S>(&axis, sign * step * (1.0 - ROUNDING)), Power::On, "{} {sign}", S::NAME);
        let beyond = after_jump::<S>(&axis, sign * step * (1.0 + ROUNDING));
        assert_eq!(beyond, on(1, FaultKind::EncoderStep), "{} {sign}", S::NAME);
    }
}

#[test]
fn a_motor_may_step_by_its_greatest_speed_either_way() {
    encoder_steps::<Fixed>();
    encoder_steps::<f32>();
    encoder_steps::<f64>();
}

#[test]
fn an_encoder_step_is_detected_also_in_ticks_without_a_position_loop() {
    for ticks in 1..=5 {
        for sign in [1.0, -1.0] {
            let axis = AxisSettings { fastest_m_per_s: Some(0.5), ..AxisSettings::default() };
            let mut machine = at_standstill::<Fixed>(&axis, 5);
            for _ in 1..ticks {
                assert!(tick_second_axis(&mut machine, Position(0), None).enabled);
            }
            assert!(!tick_second_axis(&mut machine, position(sign * 0.6 / RATE_HZ), None).enabled);
            assert_eq!(machine.power(), on(1, FaultKind::EncoderStep));
        }
    }
}

fn following_errors<S: Scalar>() {
    let limit = 2e-3;
    let axis = AxisSettings { following_error_limit_m: limit, ..AxisSettings::default() };
    for sign in [1.0, -1.0] {
        assert_eq!(after_jump::<S>(&axis, sign * limit * (1.0 - ROUNDING)), Power::On, "{} {sign}", S::NAME);
        let beyond = after_jump::<S>(&axis, sign * limit * (1.0 + ROUNDING));
        assert_eq!(beyond, on(1, FaultKind::FollowingError), "{} {sign}", S::NAME);
    }
}

#[test]
fn a_following_error_up_to_its_limit_passes_in_both_directions() {
    following_errors::<Fixed>();
    following_errors::<f32>();
    following_errors::<f64>();
}

/// Commands and power state of each tick along a line from zero, until the path is done or the drives are off. The axes
/// follow their commands exactly. The travel is set after the line has been pushed: a line that leaves it is rejected.
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
            assert!(rows.iter().all(|(_, power)| *power == Power::On), "fault on the way to {end} m");
            assert_eq!(position(rows.last().unwrap().0[usize::from(axis)]), position(end));

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

/// A stop takes v/a and v²/2a, where a is the least deceleration of the axes, independent of which axis has it and which
/// axis has the fault.
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
        // The direction is (0.6, 0.8).
        let rows = travelled(&settings, [0.3, 0.4], feed);
        let stopping = rows.iter().filter(|(_, power)| matches!(power, Power::Stopping(_))).count();
        // One tick is for the detection of the soft limit, one for that of standstill; the path decelerates in both.
        let expected = feed / least * RATE_HZ;
        assert!((stopping as f64 - expected).abs() <= 2.0, "{stopping} ticks, expected {expected}");
        let path_m = (rows[rows.len() - 2].0[0] - 0.06) / 0.6;
        let expected = feed * feed / (2.0 * least);
        // One tick at full speed at either end: 24 µm each.
        assert!((path_m - expected).abs() < 2.0 * feed / RATE_HZ, "{path_m} m, expected {expected}");
    }
}

/// The faults of a position tick without following error, for a command and a motor reading (position units) and a velocity
/// command (velocity units).
fn faults_of(
    monitor: &Monitor<Fixed>,
    state: &mut State<Fixed>,
    [command, motor]: [i64; 2],
    velocity: f64,
) -> Vec<FaultKind> {
    let input = MonitorInput {
        following_error: Fixed::ZERO,
        command: Position(command),
        velocity_command: Fixed::signal(velocity),
        motor: Position(motor),
        table: None,
        uses_scale: false,
    };
    monitor.position(state, &input).iter().collect()
}

/// 1 pm in position units: the tolerance of the soft limits for the axis filters.
const PICOMETRE: i64 = PER_NM / 1000;

/// An axis that is enabled outside its travel may stay there and move inwards; the limit follows it. A command further out
/// than that by more than the tolerance is a fault in every tick.
#[test]
fn outside_the_travel_the_limit_follows_the_command_inwards() {
    let axis = AxisSettings { travel_m: Some([-0.02, 0.03]), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    for (end, outwards) in [(0.03, 1), (-0.02, -1)] {
        let at = |units: i64| position(end).0 + outwards * units;
        let mut state = State::at(Position(at(1_000_000)), Position(0));
        let mut faults = |units| faults_of(&monitor, &mut state, [at(units), 0], 0.0);
        let none: [FaultKind; 0] = [];
        for units in [1_000_000, 1_000_000 + PICOMETRE, 999_999, 500_000, 500_000 + PICOMETRE] {
            assert_eq!(faults(units), none, "{units}");
        }
        for units in [500_001 + PICOMETRE, 600_000, 1_000_000, 500_001 + PICOMETRE] {
            assert_eq!(faults(units), [FaultKind::SoftLimit], "{units}");
        }
        // The last command without a fault, then further in to the end of the travel, inside, and out by the tolerance.
        for units in [500_000, 1, 0, -1000, 0, PICOMETRE] {
            assert_eq!(faults(units), none, "{units}");
        }
        assert_eq!(faults(PICOMETRE + 1), [FaultKind::SoftLimit]);
    }
}

#[test]
fn the_tolerance_of_the_soft_limit_does_not_accumulate_over_small_steps() {
    let axis = AxisSettings { travel_m: Some([-0.02, 0.03]), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    for (end, outwards) in [(0.03, 1), (-0.02, -1)] {
        let end = position(end).0;
        let mut state = State::at(Position(end), Position(0));
        let step = |k: i64| end + outwards * k * PICOMETRE / 2;
        let first = (1..10).find(|&k| !faults_of(&monitor, &mut state, [step(k), 0], 0.0).is_empty());
        assert_eq!(first, Some(3), "{outwards}: expected two steps of 0.5 pm to pass");
    }
}

/// The encoder is frozen when both the integral of the velocity command and the travel of the command exceed the limit, in
/// either direction, while the motor reading has moved by no more than 1/64 of the limit.
#[test]
fn a_frozen_encoder_needs_command_and_velocity_integral_beyond_the_limit() {
    // 2⁻¹⁰ m and 1/64 of it are whole numbers of position units.
    let axis = AxisSettings { sensors: frozen_alone(1.0 / 1024.0), ..AxisSettings::default() };
    let monitor = AxisConfig::<Fixed>::new(&axis, rates(1)).unwrap().monitor;
    let (limit, part) = (position(1.0 / 1024.0).0, position(1.0 / 65_536.0).0);
    // A velocity unit is 2⁴ error units per second: 2⁻⁸ error units, or 2²² position units, in a tick of 2⁻¹² s.
    let velocity = 4096.0;
    // The fault is raised in the tick after the one in which the integral exceeds the limit.
    let ticks = usize::try_from(limit / (4096 << 22) + 1).unwrap();
    for sign in [1, -1] {
        // The number of ticks without a fault, at most 199.
        let frozen = |command: i64, motor: i64, state: &mut State<Fixed>| {
            let velocity = f64::from(i32::try_from(sign).unwrap()) * velocity;
            let faults =
                (1..200).map(|_| faults_of(&monitor, state, [sign * command, sign * motor], velocity));
            faults.take_while(Vec::is_empty).count()
        };
        let start = || State::at(Position(0), Position(0));
        assert_eq!(frozen(limit + 1, part, &mut start()), ticks, "{sign}");
        assert_eq!(frozen(limit + 1, -part, &mut start()), ticks, "{sign}");
        // The command has travelled by the limit and no further: the velocity command may be due to a load.
        assert_eq!(frozen(limit, part, &mut start()), 199, "{sign}");
        // A motion of the motor reading resets the integral and the travel of the command.
        let mut state = start();
        assert_eq!(frozen(10 * limit, part, &mut state), ticks, "{sign}");
        assert!(faults_of(&monitor, &mut state, [sign * 10 * limit, sign * (part + 1)], 0.0).is_empty());
        assert_eq!(frozen(11 * limit, 2 * part + 1, &mut state), 199, "{sign}");
        // The integral is already beyond its limit, so one more unit of the command is a fault at once.
        assert_eq!(frozen(11 * limit + 1, 2 * part + 1, &mut state), 0, "{sign}");
    }
    let unwatched = AxisConfig::<Fixed>::new(&AxisSettings::default(), rates(1)).unwrap().monitor;
    assert_eq!(faults_of(&unwatched, &mut State::at(Position(0), Position(0)), [1 << 50, 0], 1e5), []);
}

/// A monitor with a saturation budget of `ticks`.
fn saturation_monitor<S: Scalar>(ticks: u32) -> Monitor<S> {
    let axis = AxisSettings { saturation_time_s: f64::from(ticks) / RATE_HZ, ..AxisSettings::default() };
    AxisConfig::new(&axis, rates(1)).unwrap().monitor
}

/// The tick, counted from 1, in which the saturation budget is exceeded.
fn tick_of_fault(ticks: u32, at_limit: impl IntoIterator<Item = bool>) -> Option<usize> {
    let (monitor, mut state) = (saturation_monitor::<Fixed>(ticks), State::at(Position(0), Position(0)));
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
        assert_eq!(tick_of_fault(time, vec![true; ticks]), None);
        assert_eq!(tick_of_fault(time, vec![true; ticks + 1]), Some(ticks + 1));
    }
}

/// After a budget of n ticks is used up, m unsaturated ticks earn back m/4, rounded up to whole ticks because the
/// comparison with the budget ignores fractions of a tick.
#[test]
fn ticks_off_the_limit_take_a_quarter_of_theirs_back() {
    let ticks = 40;
    let (n, k) = (40, 7);
    for (off, more) in [(4 * k - 1, k), (4 * k, k), (4 * k + 1, k + 1), (4 * k + 4, k + 1)] {
        let sequence = [vec![true; n], vec![false; off], vec![true; 2 * n]].concat();
        assert_eq!(tick_of_fault(ticks, sequence), Some(n + off + more + 1), "{off} unsaturated ticks");
    }
    // However long the force is not saturated, the budget is never more than n ticks.
    let sequence = [vec![true; n], vec![false; 100_000], vec![true; 2 * n]].concat();
    assert_eq!(tick_of_fault(ticks, sequence), Some(n + 100_000 + n + 1));
}

/// Saturated in one tick of five: 1 − 4·¼ = 0 per period. Saturated in one of four: 1 − 3·¼ = ¼ per period, so that period k,
/// counted from 0, starts with k/4 and exceeds the budget n in its first tick when k/4 + 1 = n + 1.
#[test]
fn saturation_of_a_fifth_of_the_ticks_is_never_a_fault_and_of_a_quarter_it_is() {
    let every = |period: usize| (0..1_000_000).map(move |tick| tick % period == 0);
    for ticks in [1, 10, 300] {
        assert_eq!(tick_of_fault(ticks, every(5)), None);
        assert_eq!(tick_of_fault(ticks, every(4)), Some(4 * 4 * ticks as usize + 1));
    }
}

proptest! {
    /// Against the same sum in f64, which is exact for quarters of a tick.
    #[test]
    fn any_sequence_matches_the_sum_of_its_ticks(
        ticks in 1u32..60,
        runs in prop::collection::vec((any::<bool>(), 0usize..80), 1..30),
    ) {
        let sequence: Vec<bool> = runs.into_iter().flat_map(|(limited, ticks)| vec![limited; ticks]).collect();
        let mut saturated = 0.0f64;
        let expected = sequence.iter().position(|limited| {
            saturated = if *limited { saturated + 1.0 } else { (saturated - 0.25).max(0.0) };
            *limited && saturated.floor() > f64::from(ticks)
        });
        prop_assert_eq!(tick_of_fault(ticks, sequence), expected.map(|tick| tick + 1));
    }
}

/// A motor that is locked 1 mm from its command: Kv·Kp·1 mm = 1650 N exceeds the limit of 100 N, and the path stops in the
/// tick after the declared number of ticks.
fn stops_after_budget<S: Scalar>() {
    for sign in [1.0, -1.0] {
        let axis =
            AxisSettings { force_limit_n: 100.0, saturation_time_s: 1.0 / 64.0, ..AxisSettings::default() };
        let mut machine = at_standstill::<S>(&axis, 1);
        let ticks = (1..1000).find(|_| {
            tick_second_axis(&mut machine, position(sign * 1e-3), None);
            machine.power() != Power::On
        });
        assert_eq!(ticks, Some(64 + 1), "{}", S::NAME);
        let stopping = Power::Stopping(Fault::Axis { axis: 1, kind: FaultKind::ForceSaturated });
        assert_eq!(machine.power(), stopping, "{}", S::NAME);
    }
}

#[test]
fn a_machine_stops_when_the_saturation_budget_is_exceeded() {
    stops_after_budget::<Fixed>();
    stops_after_budget::<f32>();
    stops_after_budget::<f64>();
}
