//! The controller on an emulated Cortex-M4F equals the controller on the host to the last bit.
//!
//! Each controller is in a closed loop with its own copy of the plant, so that a single different bit would grow.
//! `cargo test --test chip processor_in_the_loop:: -- --nocapture` prints the instructions of a tick.

use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use lockstep::emulator::{DEFAULT_TIMEOUT, Emulator};
use lockstep::remote::{Connection, Remote};
use model::machine::Machine;
use motion::{PathBlock, PathShape};
use plant::controller::{AxisOutput, Controller, Status};
use plant::instruments::Instruments;
use plant::sensors::Sensor;
use plant::simulate::{Run, controller, controller_setup};
use shared::lockstep::protocol::{Answer, FRAME, Order, Rejection, decode, encode};
use shared::scalar::Format;

/// Two axes with all features of a machine file: both laws, integral part, feed-forward, dual feedback.
const MACHINE: &str = r#"
name = "bench"
sample_rate_hz = 4000.0
velocity_loop_rate_hz = 20000.0

[axis.x]
controller = "hpc"
position_gain_per_s = 60.0
feedforward_percent = 80.0
velocity_gain_n_s_per_m = 45000.0
velocity_integral_time_s = 0.013
force_limit_n = 8000.0
motor_mass_kg = 120.0
table_mass_kg = 90.0
stiffness_n_per_um = 170.0
damping_n_s_per_m = 11500.0
coulomb_n = 200.0
viscous_n_s_per_m = 1000.0
presliding_stiffness_n_per_um = 40.0
presliding_damping_n_s_per_m = 2000.0
feedback = "dual"
dual_feedback_time_constant_s = 0.05

[axis.y]
controller = "p"
position_gain_per_s = 44.0
feedforward_percent = 60.0
velocity_gain_n_s_per_m = 70000.0
velocity_integral_time_s = 0.02
force_limit_n = 8000.0
motor_mass_kg = 70.0
table_mass_kg = 190.0
stiffness_n_per_um = 220.0
damping_n_s_per_m = 8700.0
coulomb_n = 200.0
viscous_n_s_per_m = 1000.0
motor_coulomb_n = 30.0
presliding_stiffness_n_per_um = 40.0
presliding_damping_n_s_per_m = 2000.0
feedback = "motor"
"#;

/// Velocity ticks per position tick of that machine.
const DIVIDER: usize = 5;

/// Start of the motion.
const START_M: [f64; 2] = [0.01, 0.0];

/// A circle of 10 mm radius at 3 m/min by `turns`, a line there and back, and the circle in the other direction.
fn motion(turns: f64) -> Vec<PathBlock> {
    let moving = |shape| PathBlock::new(shape, 0.05, 2.0);
    let line = |x, y| moving(PathShape::Line { to_m: vec![x, y] });
    let arc = |turns| moving(PathShape::Arc { plane: [0, 1], centre_m: [0.0, 0.0], turns });
    let dwell = moving(PathShape::Dwell { seconds: 0.02 });
    vec![dwell.clone(), arc(turns), line(0.013, 0.001), line(0.01, 0.0), arc(-turns), dwell]
}

/// Encoders with a resolution of 50 nm and noise, the same in every run.
fn instruments() -> Instruments {
    let encoder = Sensor { resolution: 50e-9, noise: 20e-9 };
    Instruments { motor: encoder, table: encoder, seed: 7, ..Instruments::default() }
}

/// Everything that the controller returns in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tick {
    outputs: [AxisOutput; 2],
    status: Status,
}

fn run(controller: &mut dyn Controller, turns: f64) -> Vec<Tick> {
    let machine = Machine::parse(MACHINE, "bench").unwrap();
    let blocks = motion(turns);
    let run = Run {
        machine: &machine,
        instruments: instruments(),
        start_m: &START_M,
        blocks: &blocks,
        start_s: 0.0,
    };
    let mut ticks = Vec::new();
    run.log(controller, |_, &status, outputs| {
        ticks.push(Tick { outputs: outputs.try_into().unwrap(), status });
    })
    .unwrap();
    ticks
}

fn on_host(format: Format, text: &str, turns: f64) -> Vec<Tick> {
    let machine = Machine::parse(text, "bench").unwrap();
    run(controller(&machine, format, &START_M).unwrap().as_mut(), turns)
}

fn emulator() -> Emulator {
    Emulator::start(&tests::firmware::built("emulated"), DEFAULT_TIMEOUT).unwrap()
}

fn emulated(format: Format) -> Remote<Emulator> {
    let machine = Machine::parse(MACHINE, "bench").unwrap();
    let (settings, start) = controller_setup(&machine, &START_M).unwrap();
    Remote::set_up(emulator(), format, machine.rates(), &settings, &start).unwrap()
}

/// Median and maximum.
fn median_and_max(mut costs: Vec<u32>) -> (u32, u32) {
    costs.sort_unstable();
    (costs[costs.len() / 2], costs[costs.len() - 1])
}

/// Kinds of ticks in the order of the page: position loops; the path, and what depends on its command, ahead of them; velocity loops
/// only.
const KINDS: [&str; 4] = ["position loops", "path ahead", "corrections ahead", "velocity loops only"];

/// The kind of a tick.
const fn kind(tick: usize) -> usize {
    match DIVIDER - tick % DIVIDER {
        DIVIDER => 0,
        2 => 1,
        1 => 2,
        _ => 3,
    }
}

/// Runs both controllers and compares every tick. Returns median and maximum of the instructions of each kind of tick.
fn compare(format: Format, turns: f64) -> [(u32, u32); 4] {
    let host = on_host(format, MACHINE, turns);
    let mut emulated = emulated(format);
    let start = Instant::now();
    let chip = run(&mut emulated, turns);
    let frames_per_s = chip.len() as f64 / start.elapsed().as_secs_f64();

    assert_eq!(host.len(), chip.len());
    for (k, (on_host, on_chip)) in host.iter().zip(&chip).enumerate() {
        let without_cost = Status { cost: None, ..on_chip.status };
        assert_eq!(*on_host, Tick { status: without_cost, ..*on_chip }, "{format:?}, tick {k}");
    }
    // The axes have moved: forces of both signs.
    let forces = host.iter().map(|tick| tick.outputs[0].force_n);
    let (min, max) = forces.fold((0f64, 0f64), |(min, max), n| (min.min(n), max.max(n)));
    assert!(min < -300.0 && max > 300.0, "{min} N to {max} N");

    let costs = std::array::from_fn(|of| {
        let costs = chip.iter().enumerate().filter(|(k, _)| kind(*k) == of);
        median_and_max(costs.map(|(_, tick)| tick.status.cost.unwrap()).collect())
    });
    println!(
        "{format:?}: {} ticks equal to the last bit, {frames_per_s:.0} frames/s. Instructions of a tick, median and maximum: \
         {costs:?}: {KINDS:?}",
        host.len(),
    );
    costs
}

/// The row of a format in `docs/firmware.md`, which has the figures as they are counted. `BLESS=1` rewrites them.
fn assert_documented(name: &str, costs: [(u32, u32); 4]) {
    // Each test rewrites its own row.
    static ONE: Mutex<()> = Mutex::new(());
    let _one = ONE.lock();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs/firmware.md");
    let text = fs::read_to_string(&path).unwrap();
    let start = format!("| {name} |");
    let shown = text.lines().find(|line| line.starts_with(&start)).expect("a row for each format");
    let cells = costs.map(|(median, max)| format!(" {median} | {max} |")).concat();
    let counted = start.clone() + &cells;
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, text.replace(shown, &counted)).unwrap();
    } else {
        assert_eq!(shown, counted, "docs/firmware.md");
    }
}

/// The bounds are a third below and a half above the measured values. A lower count means that instructions are not counted,
/// a higher one that a change has made the tick slower. At 20 kHz the board has 8400 cycles per tick.
fn assert_within(costs: [(u32, u32); 4], bounds: [(u32, u32); 4]) {
    for (((median, max), (lower, upper)), kind) in costs.into_iter().zip(bounds).zip(KINDS) {
        assert!(
            lower <= median && max <= upper,
            "{kind}: {median} to {max} instructions, expected {lower} to {upper}"
        );
    }
}

#[test]
fn fixed_point_is_the_same_to_the_last_bit() {
    let costs = compare(Format::Fixed, 1.5);
    assert_within(costs, [(430, 2250), (370, 1380), (255, 620), (250, 435)]);
    assert_documented("fixed", costs);
}

#[test]
fn single_precision_is_the_same_to_the_last_bit() {
    let costs = compare(Format::F32, 0.2);
    assert_within(costs, [(680, 2500), (420, 1500), (360, 860), (245, 450)]);
    assert_documented("f32", costs);
}

#[test]
fn double_precision_is_the_same_to_the_last_bit() {
    let costs = compare(Format::F64, 0.2);
    assert_within(costs, [(3940, 8400), (1720, 4490), (1940, 4560), (1560, 3500)]);
    assert_documented("f64", costs);
}

/// The comparison detects a change of a gain in the last place.
#[test]
fn a_gain_that_differs_by_1e_minus_15_is_detected() {
    let changed = MACHINE.replace("= 60.0", "= 60.00000000000001");
    assert_ne!(on_host(Format::F64, &changed, 0.1), on_host(Format::F64, MACHINE, 0.1));
}

#[test]
fn an_unreadable_frame_is_rejected_and_an_end_order_ends_the_program() {
    let mut emulator = emulator();
    let mut frame = [0xff; FRAME];
    emulator.exchange(&mut frame).unwrap();
    assert_eq!(decode::<Answer>(&frame), Ok(Answer::Rejected(Rejection::Unreadable)));
    encode(&Order::Enable, &mut frame).unwrap();
    emulator.exchange(&mut frame).unwrap();
    assert_eq!(decode::<Answer>(&frame), Ok(Answer::Rejected(Rejection::NotSetUp)));
    encode(&Order::End, &mut frame).unwrap();
    assert_eq!(emulator.exchange(&mut frame).unwrap_err(), "the emulator has ended");
}

/// All features of the controller, through the protocol alone: filters of force and path, S-curves with blended joints,
/// every compensation, a change of gains, a scale that fails and recovers.
mod all_features {
    use shared::compensate::settings::{
        Cycle, ForceModel, FrictionWarmUp, Pitch, PitchSource, Points, Reversal, Straightness, Stribeck,
        TableFriction, Talk, TimePoints,
    };
    use shared::compensate::{CompensationKind, CompensationSettings};
    use shared::config::{
        AxisSettings, GainSchedule, Law, LowPass, Notch, Notches, Rates, ScaleLimits, SchedulePoint,
        ScheduledOver, Sensors, VelocitySource,
    };
    use shared::interpolate::{Block, Ramps, Smoothing};
    use shared::lockstep::protocol::{LONGEST_ORDER, PART, Part, Setup};
    use shared::lockstep::session::{NoMeter, Session};
    use shared::machine::Reading;
    use shared::scalar::{Fixed, Scalar};
    use shared::units::Position;

    use super::*;

    fn axis() -> AxisSettings {
        AxisSettings {
            law: Law::Hpc,
            position_gain_per_s: 50.0,
            feedforward_percent: 70.0,
            velocity_gain_n_s_per_m: 20_000.0,
            gain_schedule: GainSchedule::of(
                ScheduledOver::Position,
                [(-0.05, 0.8), (-0.01, 1.0), (0.0, 1.2), (0.01, 0.7), (0.03, 1.1), (0.06, 0.9)]
                    .map(|(at, ratio)| SchedulePoint { at, ratio }),
            ),
            velocity_integral_time_s: Some(0.02),
            velocity_source: VelocitySource::Observer { bandwidth_hz: 700.0 },
            velocity_lag_s: 25e-6,
            notches: Notches(
                [300.0, 700.0, 150.0, 1200.0]
                    .map(|frequency_hz| Some(Notch { frequency_hz, width_hz: 100.0, depth: 0.9 })),
            ),
            low_pass: Some(LowPass { frequency_hz: 900.0, damping_ratio: 0.7 }),
            sensors: Sensors::Dual {
                time_constant_s: 0.03,
                limits: ScaleLimits { disagreement_m: 1e-3, ..ScaleLimits::DEFAULT },
            },
            smoothing: Smoothing::SCurve { time_s: 0.01, jerk_time_s: 0.004 },
            fastest_m_per_s: Some(1.0),
            travel_m: Some([-0.1, 0.1]),
            ..AxisSettings::default()
        }
    }

    fn compensation(other: u8) -> CompensationSettings {
        let points = |scale: f64| Points {
            start_m: -0.05,
            spacing_m: 0.005,
            values: (0..21).map(|k| scale * f64::from(k % 5)).collect(),
        };
        CompensationSettings {
            pitch: Some(Pitch {
                of: PitchSource::Screw,
                forward: points(1e-6),
                backward: Some(points(1.5e-6)),
            }),
            backlash_width_m: Some(3e-6),
            screw: [Cycle::harmonic(1e-6, 5e-3, 0.2), Cycle::harmonic(5e-7, 7e-3, 1.0)].into_iter().collect(),
            dividing: [Cycle::harmonic(1e-6, 2.5e-3, 0.3), Cycle::harmonic(4e-7, 1.1e-3, 2.0)]
                .into_iter()
                .collect(),
            reversal: Some(Reversal { force_n: 30.0, decay_s: 0.01, fade_m_per_s: 0.05 }),
            intalk: Some(Talk::Over(points(1e-7))),
            crosstalk: Some((other, Talk::Constant(4e-7))),
            squareness: Some((other, 2e-5)),
            straightness: Some((other, Straightness::Quadratic(1e-5))),
            ripple: [Cycle::harmonic(5.0, 2.5e-3, 0.1), Cycle::harmonic(2.0, 1.3e-3, 0.4)]
                .into_iter()
                .collect(),
            force: Some(ForceModel {
                motor_mass_kg: 20.0,
                table_mass_kg: 20.0,
                motor_coulomb_n: 10.0,
                motor_stribeck: Some(Stribeck { excess_n: 3.0, velocity_m_per_s: 5e-3 }),
                friction: TableFriction {
                    coulomb_n: 40.0,
                    viscous_n_s_per_m: 500.0,
                    half_difference_n_s_per_m: 50.0,
                    presliding_stiffness_n_per_m: Some(30e6),
                    stribeck: Some(Stribeck { excess_n: 15.0, velocity_m_per_s: 8e-3 }),
                    map: Some(points(1.0)),
                    warm_up: Some(FrictionWarmUp { force_n: 10.0, time_constant_s: 0.4 }),
                },
                load: Some(points(3.0)),
                lag_s: 1e-3,
                share: 0.8,
            }),
            stretch_m_per_n: Some(1e-8),
            drift: Some(TimePoints { start_s: -0.1, spacing_s: 0.1, values: points(5e-7).values }),
            ..CompensationSettings::default()
        }
    }

    /// The controller's end of the protocol: a session on the host, or the chip.
    type Exchange<'a> = &'a mut dyn FnMut(&mut [u8; FRAME]);

    fn send(end: Exchange, order: &Order) -> Answer {
        let mut frame = [0; FRAME];
        if encode(order, &mut frame).is_ok() {
            end(&mut frame);
            return decode(&frame).unwrap();
        }
        let mut bytes = [0; LONGEST_ORDER];
        let parts: Vec<Vec<u8>> =
            postcard::to_slice(order, &mut bytes).unwrap().chunks(PART).map(<[u8]>::to_vec).collect();
        for (k, part) in parts.iter().enumerate() {
            let bytes = heapless::Vec::from_slice(part).unwrap();
            encode(&Order::Part(Part { bytes, last: k + 1 == parts.len() }), &mut frame).unwrap();
            end(&mut frame);
        }
        decode(&frame).unwrap()
    }

    /// Force bits and commands of each tick.
    fn run(end: Exchange, format: Format) -> Vec<([u64; 2], [Position; 2])> {
        let ready = |answer: Answer| assert_eq!(answer, Answer::Ready);
        let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 2 };
        let start = [Position(0); 2];
        ready(send(end, &Order::Setup(Setup { format, rates, axes: [axis(); 2], start })));
        for number in [0, 1] {
            ready(send(end, &Order::Compensate(number, compensation(1 - number))));
        }
        let ramps = Ramps::SCurve { jerk_m_per_s3: 500.0 };
        let blocks = [
            Block::line([0.004, 0.002], 0.1, 5.0),
            Block::line([0.008, 0.002], 0.1, 5.0),
            Block::arc([0, 1], [0.008, 0.004], 0.4, 0.1, 5.0),
            Block::line([0.0, 0.0], 0.1, 5.0).with_ramps(Ramps::Exponential),
        ];
        for block in blocks {
            let ramps = if block.ramps == Ramps::Trapezoid { ramps } else { block.ramps };
            ready(send(end, &Order::Block(block.with_ramps(ramps).within(20e-6))));
        }
        ready(send(end, &Order::Enable));
        let (mut at_m, mut velocity, mut ticks) = ([0.0f64; 2], [0.0f64; 2], Vec::new());
        for k in 0..14_000 {
            if k == 3000 {
                let slower = AxisSettings { law: Law::P, position_gain_per_s: 30.0, ..axis() };
                ready(send(end, &Order::Change(1, slower)));
                ready(send(end, &Order::Switch(0, CompensationKind::Pitch, false)));
            }
            let has_scale = !(4000..5000).contains(&k);
            let position = |m: f64| Position::from_m(m).unwrap();
            let readings = at_m.map(|m| Reading {
                motor: position(m),
                table: has_scale.then(|| position(m + 2e-6 * (m * 500.0).sin())),
            });
            let Answer::Tick(ticked) = send(end, &Order::Tick(readings)) else { panic!("no tick") };
            assert!(ticked.power.is_on(), "{:?} at {k}", ticked.power);
            for i in 0..2 {
                let bits = ticked.force_bits[i];
                #[expect(clippy::cast_possible_truncation, reason = "the narrow formats fill the low bits")]
                let force = match format {
                    Format::Fixed => Scalar::value(Fixed::from_bits((bits as u32).cast_signed())),
                    Format::F32 => Scalar::value(f32::from_bits(bits as u32)),
                    Format::F64 => f64::from_bits(bits),
                };
                velocity[i] += (force - 500.0 * velocity[i]) / 40.0 / 20_000.0;
                at_m[i] += velocity[i] / 20_000.0;
            }
            ticks.push((ticked.force_bits, ticked.commands));
        }
        ticks
    }

    #[test]
    fn all_features_are_the_same_to_the_last_bit() {
        for format in [Format::Fixed, Format::F32, Format::F64] {
            let mut session = Session::default();
            let on_host = run(
                &mut |frame| {
                    let answer = session.answer(frame, &mut NoMeter).unwrap();
                    encode(&answer, frame).unwrap();
                },
                format,
            );
            let mut chip = emulator();
            let on_chip = run(&mut |frame| chip.exchange(frame).unwrap(), format);
            let first = on_host.iter().zip(&on_chip).position(|(a, b)| a != b);
            assert_eq!(first, None, "{format:?}: first different tick");
            // The axes have moved and are at their programmed end.
            assert!(on_host.iter().any(|(_, [x, _])| x.to_m() > 0.0079));
            assert_eq!(on_host.last().unwrap().1, [Position(0); 2]);
        }
    }
}
