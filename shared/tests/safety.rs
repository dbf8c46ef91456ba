//! Each fault on a machine that moves: what puts the drives off does so in the same tick, what stops does it
//! along the path, what warns goes on.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use shared::config::{AxisSettings, ConfigError, Rates, Sensors};
use shared::interpolate::{Block, PathError, Smoothing};
use shared::machine::{Machine, MachineError, Output, Reading};
use shared::safety::{Fault, Hazard, Power};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATE_HZ: f64 = 4000.0;
const RATES: Rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };

fn place(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// Two axes, of which each follows its command with the velocity loop's own error: motor = mass of 50 kg.
struct Bench<S: Scalar> {
    machine: Machine<S, 2>,
    motor_m: [f64; 2],
    velocity: [f64; 2],
    /// What the sensors are made to say besides.
    motor_jump_m: f64,
    scale: bool,
    scale_off_m: f64,
}

impl<S: Scalar> Bench<S> {
    fn new(axis: &AxisSettings) -> Self {
        let mut machine = Machine::new(RATES, &[*axis; 2], [Position(0); 2]).unwrap();
        machine.push(&Block::line([0.2, 0.1], 0.1, 2.0)).unwrap();
        machine.enable();
        Self {
            machine,
            motor_m: [0.0; 2],
            velocity: [0.0; 2],
            motor_jump_m: 0.0,
            scale: true,
            scale_off_m: 0.0,
        }
    }

    fn tick(&mut self) -> Output<S, 2> {
        let place = |m: f64| Position::from_m(m).unwrap();
        let readings = [0, 1].map(|axis| Reading {
            motor: place(self.motor_m[axis] + if axis == 1 { self.motor_jump_m } else { 0.0 }),
            table: self.scale.then(|| place(self.motor_m[axis] + self.scale_off_m)),
        });
        let output = self.machine.tick(&readings);
        for axis in 0..2 {
            self.velocity[axis] += output.forces[axis].value() / 50.0 / RATE_HZ;
            self.motor_m[axis] += self.velocity[axis] / RATE_HZ;
        }
        output
    }

    fn run(&mut self, ticks: u32) -> Output<S, 2> {
        (0..ticks).map(|_| self.tick()).last().unwrap()
    }
}

fn axis() -> AxisSettings {
    AxisSettings {
        position_gain_per_s: 50.0,
        velocity_gain_n_s_per_m: 20_000.0,
        following_error_limit_m: 0.01,
        scale_disagreement_limit_m: Some(0.5e-3),
        fastest_m_per_s: Some(0.5),
        saturation_time_s: 0.01,
        stop_deceleration_m_per_s2: 4.0,
        sensors: Sensors::Dual { time_constant_s: 0.05 },
        ..AxisSettings::default()
    }
}

const fn on(axis: u8, hazard: Hazard) -> Fault {
    Fault::Axis { axis, hazard }
}

/// The drives go off in the tick that sees it.
fn goes_off_at_once<S: Scalar>(change: impl Fn(&mut Bench<S>), fault: Fault) {
    let mut bench = Bench::<S>::new(&axis());
    assert!(bench.run(2000).enabled);
    change(&mut bench);
    let output = bench.tick();
    assert_eq!(bench.machine.power(), Power::Faulted(fault), "{}", S::NAME);
    assert!(!output.enabled && output.forces.iter().all(|force| force.value() == 0.0));
    // Nothing moves without an acknowledgement and a fresh enable.
    bench.machine.enable();
    assert!(!bench.tick().enabled);
    bench.machine.disable();
    bench.machine.enable();
}

fn sudden<S: Scalar>() {
    // 0.3 mm in a tick of 0.25 ms is 1.2 m/s, and less than scale and motor may disagree.
    goes_off_at_once::<S>(|bench| bench.motor_jump_m = 0.3e-3, on(1, Hazard::EncoderStep));
    goes_off_at_once::<S>(|bench| bench.scale_off_m = 0.6e-3, on(0, Hazard::Disagreement));
    goes_off_at_once::<S>(|bench| bench.machine.fault(Fault::Overrun), Fault::Overrun);
    goes_off_at_once::<S>(|bench| bench.machine.fault(Fault::HardwareStop), Fault::HardwareStop);
}

#[test]
fn sudden_faults_put_the_drives_off_in_every_format() {
    sudden::<Fixed>();
    sudden::<f32>();
    sudden::<f64>();
}

#[test]
fn a_following_error_puts_the_drives_off() {
    let mut bench = Bench::<Fixed>::new(&AxisSettings { following_error_limit_m: 1.5e-3, ..axis() });
    // 0.1 m/s·2/√5 over Kp = 50/s is 1.8 mm on the first axis: reached while it speeds up.
    bench.run(2000);
    assert_eq!(bench.machine.power(), Power::Faulted(on(0, Hazard::FollowingError)));
}

/// The soft limit of the first axis is crossed on the way: the path goes on along its line for v²/2a at the
/// most, both axes on it, and the drives go off once it stands.
#[test]
fn a_soft_limit_stops_along_the_path() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(1);
    // Narrowed under way: a block that leads out of the travel would not have been taken.
    bench.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.08]), ..axis() }).unwrap();
    let mut commands = Vec::new();
    let mut stopping = 0;
    while bench.machine.power() == Power::Off || bench.machine.power().is_on() {
        commands.push(bench.tick().commands);
        stopping += u32::from(matches!(bench.machine.power(), Power::Stopping(_)));
        assert!(commands.len() < 20_000);
    }
    assert_eq!(bench.machine.power(), Power::Faulted(on(0, Hazard::SoftLimit)));
    // 0.1 m/s at 4 m/s² is 25 ms: 100 ticks, one more to see it; 1.25 mm of path, 1.12 mm of x.
    assert!((98..=102).contains(&stopping), "{stopping}");
    let [x, _] = commands[commands.len() - 2].map(Position::to_m);
    assert!(x > 0.08 + 1.0e-3 && x < 0.08 + 1.2e-3, "{x}");
    for [x, y] in commands[..commands.len() - 1].iter().map(|point| point.map(Position::to_m)) {
        assert!((x / 2.0 - y).abs() < 1e-9, "off the line at {x}, {y}");
    }
}

#[test]
fn a_force_at_its_limit_stops_after_its_time() {
    let mut bench = Bench::<Fixed>::new(&AxisSettings { force_limit_n: 20.0, ..axis() });
    // 50 kg at 2 m/s² need 89 N.
    let mut ticks = 0;
    while !matches!(bench.machine.power(), Power::Stopping(_)) {
        bench.tick();
        ticks += 1;
        assert!(ticks < 400, "{:?}", bench.machine.power());
    }
    // 10 ms are 40 ticks, which begin once the error asks for 20 N: 1 mm/s, after some ticks.
    assert!((41..=80).contains(&ticks), "{ticks}");
    assert_eq!(bench.machine.power(), Power::Stopping(on(0, Hazard::ForceSaturated)));
}

/// Differences of the motor reading close the velocity loop one tick late: with Kv·Δt/m > 2 each tick turns the speed
/// over and makes it larger, until the force is thrown from limit to limit with a tick in between now and then.
#[test]
fn an_unstable_loop_stops_although_its_force_turns_over() {
    let velocity_gain_n_s_per_m = 2.5 * 50.0 * RATE_HZ;
    let mut bench =
        Bench::<f64>::new(&AxisSettings { velocity_gain_n_s_per_m, force_limit_n: 200.0, ..axis() });
    let (mut ticks, mut below, mut turned, mut last) = (0, 0, 0, 0.0);
    while bench.machine.power() == Power::Off || bench.machine.power().is_on() {
        let force = bench.tick().forces[0].value();
        below += u32::from(force.abs() < 199.0);
        turned += u32::from(force * last < 0.0);
        last = force;
        ticks += 1;
        assert!(ticks < 2000, "still running");
    }
    assert!(
        turned > 10 && below > 0,
        "it turned over {turned} times, and was below its limit in {below} ticks"
    );
}

#[test]
fn a_lost_scale_warns_and_goes_on() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(1000);
    bench.scale = false;
    let output = bench.tick();
    assert_eq!(output.warning, Some(on(0, Hazard::ScaleLost)));
    assert_eq!(bench.run(1000).warning, output.warning);
    assert_eq!(bench.machine.power(), Power::On);
    bench.scale = true;
    assert_eq!(bench.run(100).warning, output.warning);
    bench.machine.disable();
    assert_eq!(bench.tick().warning, None);
}

/// A scale that is lost does not hide the soft limit: 0.05 m of travel, and the command stops behind them within v²/2a.
#[test]
fn a_lost_scale_leaves_the_soft_limits_on() {
    for sensors in [Sensors::Table, Sensors::Dual { time_constant_s: 0.05 }] {
        let mut bench = Bench::<Fixed>::new(&AxisSettings { sensors, ..axis() });
        bench.run(100);
        // Narrowed under way: a block beyond it would not have been taken.
        let narrow = AxisSettings { sensors, travel_m: Some([-0.01, 0.05]), ..axis() };
        bench.machine.change(0, &narrow).unwrap();
        bench.scale = false;
        let warned = bench.tick().warning;
        assert_eq!(warned, Some(on(0, Hazard::ScaleLost)));
        let mut x = 0.0;
        while bench.machine.power().is_on() {
            let output = bench.tick();
            if bench.machine.power().is_on() {
                x = output.commands[0].to_m();
            }
            assert!(x < 0.06, "{x}");
        }
        assert_eq!(bench.machine.power(), Power::Faulted(on(0, Hazard::SoftLimit)));
        // 0.1 m/s of path at 4 m/s² are 1.25 mm of path, 1.12 mm of x; a tick of 22 µm to see it.
        assert!(x > 0.05 + 1.0e-3 && x < 0.05 + 1.2e-3, "{x}");
    }
}

/// A scale that is lost in the tick in which the command leaves the travel: the stop and the warning are both there.
#[test]
fn a_lost_scale_and_a_soft_limit_in_one_tick_are_both_told() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(2000);
    bench.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.0]), ..axis() }).unwrap();
    bench.scale = false;
    let output = bench.tick();
    assert_eq!(bench.machine.power(), Power::Stopping(on(0, Hazard::SoftLimit)));
    assert_eq!(output.warning, Some(on(0, Hazard::ScaleLost)));
}

/// After a soft limit the axis comes on where it stopped, is refused any further out, and goes back under power. What
/// it has come back by is closed behind it.
#[test]
fn an_axis_beyond_its_travel_goes_back_and_no_further_out() {
    let narrow = AxisSettings { travel_m: Some([-0.01, 0.05]), ..axis() };
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(100);
    bench.machine.change(0, &narrow).unwrap();
    while bench.machine.power().is_on() {
        bench.tick();
    }
    assert_eq!(bench.machine.power(), Power::Faulted(on(0, Hazard::SoftLimit)));
    bench.run(4000);
    bench.machine.disable();
    bench.run(10);
    bench.machine.enable();
    bench.run(400);
    // It holds outside, under power.
    assert_eq!(bench.machine.power(), Power::On);
    let outside = bench.motor_m[0];
    assert!(outside > 0.0505, "{outside}");
    let line = |x| Block::line([x, 0.0], 0.05, 2.0);
    assert_eq!(bench.machine.push(&line(outside + 1e-3)), Err(PathError::BeyondTravel { axis: 0 }));
    bench.machine.push(&line(0.0502)).unwrap();
    bench.run(8000);
    assert_eq!(bench.machine.power(), Power::On);
    assert!((bench.motor_m[0] - 0.0502).abs() < 1e-5, "{}", bench.motor_m[0]);
    // Where it has been is outside now.
    assert_eq!(bench.machine.push(&line(0.0504)), Err(PathError::BeyondTravel { axis: 0 }));
    bench.machine.push(&line(0.04)).unwrap();
    bench.run(8000);
    assert_eq!(bench.machine.power(), Power::On);
    assert_eq!(bench.machine.push(&line(0.0501)), Err(PathError::BeyondTravel { axis: 0 }));
}

#[test]
fn a_block_beyond_the_travel_is_refused_before_it_starts() {
    let bounded = AxisSettings { travel_m: Some([-0.01, 0.3]), ..axis() };
    let mut bench = Bench::<Fixed>::new(&bounded);
    let beyond = |axis| Err(PathError::BeyondTravel { axis });
    let mut push = |block: Block<2>| bench.machine.push(&block);
    // The path stands at (0.2, 0.1) so far.
    assert_eq!(push(Block::line([0.301, 0.1], 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::line([0.2, -0.011], 0.1, 1.0)), beyond(1));
    // Half circles upwards from (0.25, 0.1) with 0.06 m: by the right they pass (0.31, 0.16), by the left (0.19, 0.16).
    assert_eq!(push(Block::line([0.25, 0.1], 0.1, 1.0)), Ok(()));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.5, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.2, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], -0.5, 0.1, 1.0)), Ok(()));
    // From (0.25, 0.22) on round (0.2, 0.22): up to (0.2, 0.27), which fits; with 0.09 m, to y = 0.31, it does not.
    assert_eq!(push(Block::arc([0, 1], [0.16, 0.22], 0.25, 0.1, 1.0)), beyond(1));
    assert_eq!(push(Block::arc([0, 1], [0.2, 0.22], 1.0, 0.1, 1.0)), Ok(()));
}

/// What is taken is travelled: a line that ends on either end of the travel, or inside of an axis that came on beyond it, is
/// no soft limit, whatever filter is behind the path.
#[test]
fn a_block_that_ends_on_the_travel_is_travelled_behind_every_filter() {
    let filters = [
        Smoothing::None,
        Smoothing::Trapezoid { time_s: 0.02 },
        Smoothing::Trapezoid { time_s: 3.0 / RATE_HZ },
        Smoothing::SCurve { time_s: 0.02, jerk_time_s: 0.007 },
        Smoothing::Exponential { time_constant_s: 0.01 },
    ];
    for smoothing in filters {
        let settings = AxisSettings {
            smoothing,
            travel_m: Some([-0.05, 0.05]),
            sensors: Sensors::Motor,
            saturation_time_s: 100.0,
            ..axis()
        };
        let start = place(0.0601);
        let mut machine = Machine::<f64, 1>::new(RATES, &[settings], [start]).unwrap();
        let mut at = start;
        machine.tick(&[Reading { motor: at, table: None }]);
        machine.enable();
        // Beyond, then each time on an end, from either side, at lengths that leave all kinds of remainders.
        let inside =
            (1..60).flat_map(|k: i32| [-0.05, 1e-3 * f64::from(k) / 7.0, 0.05, 1e-4 / 3.0 * f64::from(k)]);
        for x in [0.0571, 0.0533].into_iter().chain(inside) {
            machine.push(&Block::line([x], 0.1, 20.0)).unwrap();
            for _ in 0..8000 {
                let output = machine.tick(&[Reading { motor: at, table: None }]);
                at = output.commands[0];
                if output.done {
                    break;
                }
            }
            assert_eq!(machine.power(), Power::On, "{smoothing:?} to {x}");
            assert_eq!(at, place(x), "{smoothing:?}");
        }
    }
}

/// Far behind its command, without feed-forward, a motor dwells at its turning point while the command is on its way back:
/// that is no dead encoder, at any limit from 0.1 mm on.
#[test]
fn a_motor_that_turns_round_behind_its_command_is_not_frozen() {
    for (limit, feed) in [(1e-4, 0.15), (3e-4, 0.15), (3e-4, 0.3), (1e-3, 0.3)] {
        for acceleration in [1.0, 5.0] {
            let settings = AxisSettings {
                position_gain_per_s: 20.0,
                following_error_limit_m: 0.1,
                frozen_encoder_limit_m: Some(limit),
                fastest_m_per_s: None,
                sensors: Sensors::Motor,
                ..axis()
            };
            let mut bench = Bench::<f64>::new(&settings);
            bench.run(16_000);
            for x in [0.3003, 0.2, 0.3, 0.2] {
                bench.machine.push(&Block::line([x, 0.1], feed, acceleration)).unwrap();
            }
            bench.run(24_000);
            assert_eq!(bench.machine.power(), Power::On, "{limit} m, {feed} m/s, {acceleration} m/s²");
            assert!((bench.motor_m[0] - 0.2).abs() < 1e-5, "{}", bench.motor_m[0]);
        }
    }
}

/// A reversal's pulse is one of a reversal: given to an axis that stands far from where the machine was made, or moves
/// in − direction all the while, it adds nothing.
#[test]
fn a_compensation_that_is_given_late_sees_no_reversal() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::Reversal;
    let reversal = Reversal { force_n: 300.0, decay_s: 0.02, fade_m_per_s: 0.02 };
    let settings = CompensationSettings { reversal: Some(reversal), ..CompensationSettings::default() };
    for moves in [false, true] {
        let mut bench = Bench::<f64>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
        bench.run(16_000);
        if moves {
            bench.machine.push(&Block::line([0.1, 0.1], 5e-3, 2.0)).unwrap();
        }
        bench.run(4000);
        bench.machine.compensate(0, &settings).unwrap();
        // At rest and at constant speed, a mass without friction needs no force.
        for _ in 0..4000 {
            let force = bench.tick().forces[0];
            assert!(force.abs() < 1.0, "{moves}: {force} N");
        }
    }
}

/// Under power the loop keeps its sensors: the axis would go by all that the two differ.
#[test]
fn sensors_are_changed_with_the_drives_off_alone() {
    let mut bench = Bench::<Fixed>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
    bench.run(16_000);
    bench.scale_off_m = 0.4e-3;
    bench.run(1);
    let other = AxisSettings { sensors: Sensors::Table, ..axis() };
    let refused = bench.machine.change(0, &other).unwrap_err();
    assert_eq!(refused, MachineError::Config { axis: 0, error: ConfigError::NotWhileRunning("sensors") });
    let place = bench.motor_m[0];
    bench.run(4000);
    assert!((bench.motor_m[0] - place).abs() < 1e-6);
    bench.machine.disable();
    bench.machine.change(0, &other).unwrap();
    bench.run(1);
    bench.machine.enable();
    bench.run(4000);
    assert_eq!(bench.machine.power(), Power::On);
    assert!((bench.motor_m[0] - place).abs() < 1e-6, "{} m", bench.motor_m[0] - place);
}

/// A loop that needs a scale does not come on without it: when the scale came back, the axis would go to where that sees
/// it.
#[test]
fn without_its_scale_a_loop_does_not_come_on() {
    for sensors in [Sensors::Table, Sensors::Dual { time_constant_s: 0.05 }] {
        let mut bench =
            Bench::<Fixed>::new(&AxisSettings { sensors, scale_disagreement_limit_m: None, ..axis() });
        bench.scale = false;
        let output = bench.run(10);
        assert_eq!(bench.machine.power(), Power::Faulted(on(0, Hazard::ScaleLost)), "{sensors:?}");
        assert!(!output.enabled && output.forces == [Fixed::ZERO; 2]);
        (bench.scale, bench.scale_off_m) = (true, 5e-3);
        bench.machine.enable();
        bench.run(10);
        assert!(!bench.machine.power().is_on());
        bench.machine.disable();
        bench.run(1);
        bench.machine.enable();
        bench.run(4000);
        // Where it stands, 5 mm of scale included.
        assert_eq!(bench.machine.power(), Power::On);
        assert!(bench.motor_m[0].abs() < 1e-6, "{} m", bench.motor_m[0]);
    }
}

#[test]
fn a_path_that_stops_takes_no_block() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(2000);
    bench.machine.fault(on(0, Hazard::SoftLimit));
    assert_eq!(bench.machine.power(), Power::Stopping(on(0, Hazard::SoftLimit)));
    assert_eq!(bench.machine.push(&Block::line([0.0, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
}

/// Not moved by hand, an axis starts its path; moved, it holds where it is, says so, and does not jump back.
#[test]
fn a_path_that_was_pushed_before_the_axis_was_moved_is_forgotten() {
    for (moved_m, holds) in [(0.05e-3, false), (0.2e-3, true), (-5e-3, true)] {
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
        let at = |m: f64| {
            let place = Position::from_m(m).unwrap();
            [Reading { motor: place, table: Some(place) }]
        };
        machine.push(&Block::line([0.1], 0.1, 2.0)).unwrap();
        machine.tick(&at(moved_m));
        machine.enable();
        let output = machine.tick(&at(moved_m));
        assert_eq!(machine.power(), Power::On);
        assert_eq!(output.done, holds, "{moved_m}");
        if holds {
            assert_eq!(output.warning, Some(on(0, Hazard::Displaced)));
            assert_eq!(output.commands, [at(moved_m)[0].motor]);
            // No error, no force; 4000 ticks on it still stands.
            assert!((0..4000).all(|_| machine.tick(&at(moved_m)).forces == [Fixed::ZERO]));
        } else {
            assert_eq!(output.warning, None);
        }
    }
}

/// What is pushed while the drives are off starts where the axis was moved to before.
#[test]
fn before_the_first_enable_the_command_follows_the_axis() {
    let mut machine = Machine::<f64, 1>::new(RATES, &[axis()], [Position(0)]).unwrap();
    let place = Position::from_m(0.02).unwrap();
    let reading = [Reading { motor: place, table: Some(place) }];
    machine.tick(&reading);
    machine.push(&Block::line([0.03], 0.1, 2.0)).unwrap();
    machine.enable();
    let output = machine.tick(&reading);
    assert_eq!((output.warning, output.done), (None, false));
    // The first tick of a ramp of 2 m/s² is 2/4000² m = 0.125 µm long at most: 250 N·s at Kp = 50, Kv = 20,000 are 0.2 N.
    assert!(output.commands[0].beyond(place).unsigned_abs() <= 131_072 * 1000);
    assert!(output.forces[0].abs() < 1.0, "{}", output.forces[0]);
}

/// A motor reading that stands while the axis is to move: the drives go off before the axis has run away. The command
/// is at 0.1 mm after √(2·0.1 mm/2 m/s²) = 10 ms; the mass, which nobody sees, has gone no further than a force that
/// grows to the limit in no time takes it: F/2m·t² = 400/100·(10 ms)² = 0.4 mm, where the following error of 10 mm
/// alone would have let it run for 0.1 s and 40 mm.
#[test]
fn a_frozen_encoder_puts_the_drives_off() {
    for toggles in [0.0, 0.5e-6] {
        let settings = AxisSettings {
            sensors: Sensors::Motor,
            force_limit_n: 400.0,
            frozen_encoder_limit_m: Some(1e-4),
            scale_disagreement_limit_m: None,
            feedforward_percent: 100.0,
            ..axis()
        };
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        machine.push(&Block::line([0.1], 0.1, 2.0)).unwrap();
        machine.enable();
        let (mut velocity, mut place, mut ticks) = (0.0, 0.0, 0u32);
        loop {
            // With one wire broken the counter goes to and fro between two counts.
            let shown = Position::from_m(if ticks % 2 == 0 { 0.0 } else { toggles }).unwrap();
            let force = machine.tick(&[Reading { motor: shown, table: None }]).forces[0].value();
            if !machine.power().is_on() {
                break;
            }
            velocity += force / 50.0 / RATE_HZ;
            place += velocity / RATE_HZ;
            ticks += 1;
            assert!(ticks < 400, "{place} m");
        }
        assert_eq!(machine.power(), Power::Faulted(on(0, Hazard::EncoderFrozen)));
        // 10 ms are 40 ticks.
        assert!((39..=42).contains(&ticks), "{ticks}");
        assert!(place < 0.4e-3, "{place} m");
    }
}

/// A motor that follows late, against friction that holds it for a while at each start, is not frozen.
#[test]
fn an_encoder_that_moves_is_not_frozen() {
    let settings = AxisSettings { frozen_encoder_limit_m: Some(1e-4), ..axis() };
    let mut bench = Bench::<Fixed>::new(&settings);
    for x in [0.1, 0.2, 0.0] {
        bench.run(12_000);
        bench.machine.push(&Block::line([x, 0.05], 0.1, 2.0)).unwrap();
    }
    bench.run(12_000);
    assert_eq!(bench.machine.power(), Power::On);
}

/// What ended the run before is a fault of this one: no enable before it is acknowledged.
#[test]
fn a_watchdog_reset_has_to_be_acknowledged() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.machine.restarted_after(Fault::Watchdog);
    bench.run(10);
    assert_eq!(bench.machine.power(), Power::Faulted(Fault::Watchdog));
    bench.machine.enable();
    assert!(!bench.tick().enabled);
    bench.machine.disable();
    bench.machine.enable();
    assert!(bench.tick().enabled);
}

/// Off and on again, as often as one likes, a compensated axis stays where it is: what is added to its command stands
/// all the while.
#[test]
fn coming_on_again_does_not_move_a_compensated_axis() {
    use shared::compensate::CompensationSettings;
    use shared::compensate::settings::{Of, Pitch, Points};
    let pitch = Points { start_m: -0.1, spacing_m: 0.1, values: [1e-4; 3].into_iter().collect() };
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: Of::Screw, forward: pitch, backward: None }),
        ..CompensationSettings::default()
    };
    let mut bench = Bench::<f64>::new(&AxisSettings { sensors: Sensors::Motor, ..axis() });
    bench.machine.compensate(0, &settings).unwrap();
    bench.run(24_000);
    let place = bench.motor_m[0];
    assert!(((place - 0.2).abs() - 1e-4).abs() < 2e-6, "{place} m");
    for _ in 0..5 {
        bench.machine.disable();
        assert_eq!(bench.machine.push(&Block::line([0.01, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
        bench.run(10);
        bench.machine.enable();
        for _ in 0..2000 {
            let output = bench.tick();
            assert!(output.forces[0].abs() < 5.0, "{} N", output.forces[0]);
        }
        assert!((bench.motor_m[0] - place).abs() < 1e-6, "{} m", bench.motor_m[0]);
    }
}
