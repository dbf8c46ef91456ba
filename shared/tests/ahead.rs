//! What is computed ahead of a position tick: the same bits in an undisturbed motion, and what an event in between does.

use shared::compensate::settings::{
    Cycle, ForceModel, Pitch, PitchSource, Points, Reversal, Straightness, TableFriction, Talk, TimePoints,
};
use shared::compensate::{CompensationKind, CompensationSettings};
use shared::config::{AxisSettings, Brake, Law, Rates};
use shared::feedback::OriginShift;
use shared::interpolate::{Block, Ramps, Smoothing};
use shared::machine::{Machine, Output, Reading};
use shared::safety::{Fault, FaultKind};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

/// Ticks per position tick of a board.
const DIVIDER: u32 = 5;

/// A position tick in the middle of the first block, which takes 0.2 s at its feed.
const MOVING: usize = 1000;

const fn rates(divider: u32) -> Rates {
    Rates { velocity_loop_hz: 20_000.0, position_loop_divider: divider }
}

fn settings() -> AxisSettings {
    AxisSettings {
        law: Law::Hpc,
        feedforward_percent: 80.0,
        smoothing: Smoothing::SCurve { time_s: 0.004, jerk_time_s: 0.002 },
        stop_deceleration_m_per_s2: 2.0,
        following_error_limit_m: 0.05,
        ..AxisSettings::default()
    }
}

/// Compensations that depend on commands, positions, time and readings.
fn compensation(axis: usize) -> CompensationSettings {
    let other = u8::from(axis == 0);
    let points = |scale: f64| Points {
        start_m: -0.1,
        spacing_m: 0.01,
        values: (0..21).map(|k| scale * f64::from(k % 5)).collect(),
    };
    let friction = TableFriction { coulomb_n: 100.0, viscous_n_s_per_m: 500.0, ..TableFriction::default() };
    let periods = || [Cycle::harmonic(2.0, 2.5e-3, 0.3)].into_iter().collect();
    CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: points(1e-6), backward: Some(points(1.5e-6)) }),
        backlash_width_m: Some(3e-6),
        screw: [Cycle::harmonic(2e-6, 5e-3, 0.3)].into_iter().collect(),
        reversal: Some(Reversal { force_n: 30.0, decay_s: 0.01, fade_m_per_s: 0.05 }),
        intalk: Some(Talk::Over(points(1e-7))),
        squareness: Some((other, 2e-5)),
        straightness: Some((other, Straightness::Over(points(1e-6)))),
        ripple: periods(),
        force: Some(ForceModel { table_mass_kg: 50.0, friction, lag_s: 0.002, ..ForceModel::default() }),
        stretch_m_per_n: Some(5e-9),
        // 1 µm in 10 ms: a tick more or less is 5 nm.
        drift: Some(TimePoints { start_s: 0.0, spacing_s: 0.01, values: points(1e-6).values }),
        ..CompensationSettings::default()
    }
}

/// A machine that is about to come on and to move: a line, an arc with reversals of both axes, a pause, and a line.
fn machine<S: Scalar>(divider: u32, settings: &AxisSettings) -> Machine<S, 2> {
    let mut machine = Machine::new(rates(divider), &[*settings; 2], [Position(0); 2]).unwrap();
    for axis in 0..2 {
        machine.compensate(axis, &compensation(axis)).unwrap();
    }
    let ramps = Ramps::SCurve { jerk_m_per_s3: 400.0 };
    for block in [
        Block::line([0.01, 0.002], 0.05, 2.0),
        Block::arc([0, 1], [0.008, 0.002], 1.25, 0.05, 2.0),
        Block::dwell(0.01),
        Block::line([0.0, 0.0], 0.05, 2.0),
    ] {
        machine.push(&block.with_ramps(ramps)).unwrap();
    }
    machine.enable();
    machine
}

/// Axes that follow their commands by 0.1 mm a tick at most.
fn follow(readings: &mut [Reading; 2], commands: &[Position; 2]) {
    for (reading, command) in readings.iter_mut().zip(commands) {
        let distance = (*command - reading.motor).clamp(-(100_000 << 20), 100_000 << 20);
        reading.motor += distance / 8;
    }
}

const AT_ZERO: [Reading; 2] = [Reading { motor: Position(0), table: None }; 2];

/// What an observer of a machine sees after a tick.
type Seen<S> = (Output<S, 2>, [Position; 2], [Position; 2], bool, bool);

fn seen<S: Scalar>(machine: &Machine<S, 2>, output: Output<S, 2>) -> Seen<S> {
    (
        output,
        machine.command(),
        machine.corrected_command(),
        machine.is_at_rest(),
        machine.was_position_tick(),
    )
}

/// Compares two machines with the same program, of which the second computes ahead, in every tick.
fn undisturbed<S: Scalar>(divider: u32, settings: &AxisSettings) {
    let [mut at_once, mut ahead] = [(); 2].map(|()| machine::<S>(divider, settings));
    let mut readings = AT_ZERO;
    let (mut commands, mut corrected) = (Vec::new(), 0);
    for tick in 0..40_000 {
        let output = at_once.tick(&readings);
        let expected = seen(&at_once, output);
        let output = ahead.tick(&readings);
        let before = seen(&ahead, output);
        ahead.prepare();
        assert_eq!(
            (before, seen(&ahead, output)),
            (expected, expected),
            "{} by {divider}, tick {tick}",
            S::NAME
        );
        follow(&mut readings, &output.commands);
        commands.push(output.commands);
        corrected += usize::from(expected.1 != expected.2);
        if output.done && tick > 100 * divider as usize {
            break;
        }
    }
    // 10 mm and an arc of 15.7 mm and 8 mm at 50 mm/s take 0.67 s, with the ramps and the pause 0.9 s at most.
    let moved = commands.windows(2).filter(|pair| pair[0] != pair[1]).count() * divider as usize;
    assert!((13_400..18_000).contains(&moved) && commands.len() < 20_000, "{moved} of {}", commands.len());
    assert!(2 * corrected > commands.len(), "{corrected}");
}

#[test]
fn an_undisturbed_motion_is_the_same_to_the_last_bit() {
    for divider in [1, 2, 3, 5, 8] {
        undisturbed::<Fixed>(divider, &settings());
    }
    undisturbed::<f32>(DIVIDER, &settings());
    undisturbed::<f64>(DIVIDER, &settings());
}

/// The path waits until the brakes are open, and moves in the same tick then.
#[test]
fn a_path_that_waits_for_the_brakes_starts_in_the_same_tick() {
    for release in 0..6 {
        let brake = Brake { release_s: f64::from(release) / 20_000.0, engage_s: 0.001 };
        undisturbed::<Fixed>(
            DIVIDER,
            &AxisSettings { brake: Some(brake), preload_n: Some(0.0), ..settings() },
        );
    }
}

/// The commands are those of a machine whose only rate is that of the position loops.
#[test]
fn the_commands_are_those_of_a_machine_with_position_ticks_only() {
    let mut by_five = machine::<Fixed>(DIVIDER, &settings());
    let slow = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 1 };
    let mut slow = Machine::<Fixed, 2>::new(slow, &[settings(); 2], [Position(0); 2]).unwrap();
    let block = Block::line([0.01, 0.002], 0.05, 2.0).with_ramps(Ramps::SCurve { jerk_m_per_s3: 400.0 });
    slow.push(&block).unwrap();
    slow.enable();
    let mut readings = AT_ZERO;
    let mut last = [Position(0); 2];
    for tick in 0..4000 {
        if tick % DIVIDER == 0 {
            last = slow.tick(&readings).commands;
        }
        let output = by_five.tick(&readings);
        by_five.prepare();
        assert_eq!(output.commands, last, "tick {tick}");
        follow(&mut readings, &output.commands);
    }
    assert!(last[0] > Position::from_m(0.005).unwrap());
}

/// Something that happens to a machine.
type Event = (&'static str, fn(&mut Machine<Fixed, 2>));

const EVENTS: [Event; 8] = [
    ("hold", |machine| machine.hold()),
    ("halt", |machine| machine.halt()),
    ("discard", |machine| machine.discard_path()),
    ("override", |machine| machine.set_override(50)),
    ("host silent", |machine| machine.fault(Fault::HostSilent)),
    ("limit switch", |machine| machine.fault(Fault::Axis { axis: 0, kind: FaultKind::LimitSwitch })),
    ("gains", |machine| {
        let changed = AxisSettings { position_gain_per_s: 20.0, ..settings() };
        machine.change(0, &changed).unwrap();
    }),
    ("force limit", |machine| machine.limit_force(0, Some(Fixed::signal(10.0)))),
];

/// When an event happens: before a tick of the program, or after a tick and before what is computed ahead after it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum When {
    Before(usize),
    Within(usize),
}

/// Commands, corrected commands and forces of the program with an event. The readings are those of the undisturbed program.
fn disturbed(event: Event, when: When, is_ahead: bool) -> Vec<([Position; 2], [Position; 2], [Fixed; 2])> {
    let [mut machine, mut undisturbed] = [(); 2].map(|()| machine::<Fixed>(DIVIDER, &settings()));
    let mut readings = AT_ZERO;
    let ticks = 0..MOVING + 2000;
    ticks
        .map(|tick| {
            if when == When::Before(tick) {
                event.1(&mut machine);
            }
            let output = machine.tick(&readings);
            let corrected = machine.corrected_command();
            if when == When::Within(tick) {
                event.1(&mut machine);
            }
            if is_ahead {
                machine.prepare();
            }
            let commands = undisturbed.tick(&readings).commands;
            follow(&mut readings, &commands);
            (output.commands, corrected, output.forces)
        })
        .collect()
}

/// The path for a position tick is advanced two ticks before it: what acts on the path within these acts as right after the position
/// tick, and every other event in the tick in which it acts without anything ahead.
#[test]
fn an_event_within_the_last_two_ticks_acts_on_the_path_as_after_the_position_tick() {
    let none = disturbed(("none", |_| {}), When::Before(0), false);
    for event in EVENTS {
        let is_of_the_path = !["gains", "force limit"].contains(&event.0);
        let expected: Vec<_> = (1..=6).map(|k| disturbed(event, When::Before(MOVING + k), false)).collect();
        for k in 1..=5 {
            // Without anything ahead, any tick before the position tick is the same for the path.
            let acts = if is_of_the_path && k >= 4 { 6 } else { k };
            let measured = disturbed(event, When::Before(MOVING + k), true);
            assert!(measured == expected[acts - 1], "{} before tick {k}", event.0);
            assert!(measured != none, "{} has no effect", event.0);
            // An input of the tick before those two is seen before the path is advanced.
            let acts = if is_of_the_path && k == 4 { 6 } else { (k + 1).min(6) };
            if k < 5 {
                let measured = disturbed(event, When::Within(MOVING + k), true);
                assert!(measured == expected[acts - 1], "{} within tick {k}", event.0);
            }
        }
        if is_of_the_path {
            // One position tick is what the path loses.
            let first = |run: &[([Position; 2], _, _)]| run.iter().zip(&none).position(|(a, b)| a.0 != b.0);
            let [in_time, late] = [0, 5].map(|k| first(&expected[k]).unwrap());
            assert_eq!((in_time, late), (MOVING + 5, MOVING + 10), "{}", event.0);
        }
    }
}

/// The drives are off, and hold no command that is not the position of the axes, in the tick after any event that switches them off.
#[test]
fn the_drives_go_off_at_once_and_what_is_ahead_is_discarded() {
    let off: [Event; 3] = [
        ("disable", |machine| machine.disable()),
        ("emergency stop", |machine| machine.fault(Fault::EmergencyStop)),
        ("drive fault", |machine| machine.fault(Fault::Axis { axis: 1, kind: FaultKind::DriveFault })),
    ];
    for (name, event) in off {
        for k in 1..=5 {
            let mut machine = machine::<Fixed>(DIVIDER, &settings());
            let mut readings = AT_ZERO;
            for _ in 0..MOVING + k {
                let output = machine.tick(&readings);
                machine.prepare();
                assert!(output.enabled);
                follow(&mut readings, &output.commands);
            }
            event(&mut machine);
            let motors = readings.map(|reading| reading.motor);
            for _ in 0..20 {
                let output = machine.tick(&readings);
                machine.prepare();
                assert!(!output.enabled && output.done && output.forces == [Fixed::ZERO; 2], "{name}, {k}");
                assert_eq!(machine.corrected_command(), motors, "{name}, {k}");
            }
            machine.disable();
            machine.enable();
            let output = machine.tick(&readings);
            machine.prepare();
            assert!(output.enabled, "{name}, {k}");
            // The corrections go on at their limited rate: one step of it, and a rounding.
            let step_m = CompensationSettings::default().position_rate_m_per_s / 4000.0 + 2e-9;
            for (corrected, motor) in machine.corrected_command().into_iter().zip(motors) {
                assert!((corrected.to_m() - motor.to_m()).abs() < step_m, "{name}, {k}: {corrected:?}");
            }
            assert!(output.forces.iter().all(|force| force.value().abs() < 10.0), "{:?}", output.forces);
        }
    }
}

/// At rest, an origin that is set between any two ticks shifts readings and commands together, and no force changes.
#[test]
fn an_origin_that_is_set_between_any_two_ticks_changes_no_force() {
    let shift = OriginShift { motor: 123_456_789, table: 0 };
    for k in 0..5 {
        let [mut machine, mut expected] = [(); 2].map(|()| {
            let mut machine =
                Machine::<Fixed, 2>::new(rates(DIVIDER), &[settings(); 2], [Position(0); 2]).unwrap();
            machine.enable();
            machine
        });
        let mut readings = AT_ZERO;
        for tick in 0..100 + k + 100 {
            let moved = if tick >= 100 + k { shift.motor } else { 0 };
            let forces = expected.tick(&readings).forces;
            let shifted = [Reading { motor: readings[0].motor + moved, ..readings[0] }, readings[1]];
            if tick == 100 + k {
                machine.set_origin(0, shift).unwrap();
            }
            let output = machine.tick(&shifted);
            machine.prepare();
            assert_eq!(output.forces, forces, "{k}, tick {tick}");
            assert_eq!(machine.command(), [Position(moved), Position(0)], "{k}, tick {tick}");
            readings[1].motor += 1 << 20;
        }
    }
}

/// An origin is refused until the loops follow the end of the path, also in the ticks in which the path has already ended.
#[test]
fn a_path_is_done_when_the_loops_follow_its_end() {
    let settings = AxisSettings { smoothing: Smoothing::None, ..settings() };
    let [mut at_once, mut ahead] = [(); 2].map(|()| {
        let mut machine = Machine::<Fixed, 2>::new(rates(DIVIDER), &[settings; 2], [Position(0); 2]).unwrap();
        machine.push(&Block::line([1e-4, 0.0], 0.05, 2.0)).unwrap();
        machine.enable();
        machine
    });
    let mut readings = AT_ZERO;
    let refused = |machine: &Machine<Fixed, 2>| {
        machine.clone().set_origin(0, OriginShift { motor: 1, table: 0 }).is_err()
    };
    for tick in 0..1000 {
        let output = at_once.tick(&readings);
        ahead.tick(&readings);
        ahead.prepare();
        assert_eq!(
            (refused(&ahead), ahead.is_at_rest()),
            (refused(&at_once), at_once.is_at_rest()),
            "{tick}"
        );
        assert_eq!(refused(&ahead), !output.done, "{tick}");
        follow(&mut readings, &output.commands);
    }
    assert!(at_once.is_at_rest());
}

/// A compensation that is switched off in the last tick changes the corrections from the next command on, at their limited rate.
#[test]
fn a_compensation_switched_in_the_last_tick_changes_the_next_correction() {
    let off: Event = ("pitch", |machine| machine.switch(0, CompensationKind::Backlash, false).unwrap());
    let run = |when, is_ahead| -> Vec<_> {
        disturbed(off, when, is_ahead)
            .into_iter()
            .map(|(command, corrected, _)| (command, corrected))
            .collect()
    };
    let before = |k| run(When::Before(MOVING + k), false);
    for k in 1..=4 {
        assert!(run(When::Before(MOVING + k), true) == before(k), "{k}");
    }
    assert!(run(When::Before(MOVING + 5), true) == before(6));
    assert!(before(5) != before(6));
}
