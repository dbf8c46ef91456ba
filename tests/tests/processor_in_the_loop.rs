//! The controller on an emulated Cortex-M4F is the controller on this computer, to the last bit.
//!
//! Both close the loop on a plant of their own: a first bit that differed would come back through
//! the plant, and grow. `cargo test --test processor_in_the_loop -- --nocapture` prints the
//! instructions of a tick.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::time::Instant;

use host_sim::controller::{AxisOutput, Controller, Format, PathBlock, PathShape, Status};
use host_sim::link::emulator::Emulator;
use host_sim::link::remote::{Connection, Remote};
use host_sim::machine::Machine;
use host_sim::plant::desk::Instruments;
use host_sim::plant::sensors::Sensor;
use host_sim::servo;
use host_sim::simulate::{Run, controller, set_up};
use shared::protocol::{Answer, FRAME, Order, Refusal, decode, encode};

/// Two axes that use everything there is: both laws, integral part, feed-forward, dual feedback.
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

/// Velocity ticks from one position tick to the next on that machine.
const DIVIDER: usize = 5;

/// Circles start here.
const START_M: [f64; 2] = [0.01, 0.0];

/// A line out and back, a circle of 10 mm radius at 3 m/min one way and `turns` the other.
fn motion(turns: f64) -> Vec<PathBlock> {
    let moving = |shape| PathBlock::new(shape, 0.05, 2.0);
    let line = |x, y| moving(PathShape::Line { to_m: vec![x, y] });
    let arc = |turns| moving(PathShape::Arc { plane: [0, 1], centre_m: [0.0, 0.0], turns });
    let dwell = moving(PathShape::Dwell { seconds: 0.02 });
    vec![dwell.clone(), arc(turns), line(0.013, 0.001), line(0.01, 0.0), arc(-turns), dwell]
}

/// Encoders of 50 nm, and noise, the same in every run.
fn instruments() -> Instruments {
    let encoder = Sensor { resolution: 50e-9, noise: 20e-9 };
    Instruments { motor: encoder, table: encoder, seed: 7, ..Instruments::default() }
}

/// All that the controller gave in one tick.
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

fn here(format: Format, text: &str, turns: f64) -> Vec<Tick> {
    let machine = Machine::parse(text, "bench").unwrap();
    run(controller(&machine, format, &START_M).unwrap().as_mut(), turns)
}

fn emulator() -> Emulator {
    Emulator::start(&tests::firmware::built("emulated")).unwrap()
}

fn emulated(format: Format) -> Remote<Emulator> {
    let machine = Machine::parse(MACHINE, "bench").unwrap();
    let (settings, start) = set_up(&machine, &START_M).unwrap();
    Remote::set_up(emulator(), format, servo::rates(&machine), &settings, &start).unwrap()
}

/// Instructions: the median and the most.
fn median_and_most(mut costs: Vec<u32>) -> (u32, u32) {
    costs.sort_unstable();
    (costs[costs.len() / 2], costs[costs.len() - 1])
}

/// Runs both, compares every tick, and returns the costs of position ticks and of the others.
fn compare(format: Format, turns: f64) -> [(u32, u32); 2] {
    let ours = here(format, MACHINE, turns);
    let mut emulated = emulated(format);
    let began = Instant::now();
    let theirs = run(&mut emulated, turns);
    let frames_per_s = theirs.len() as f64 / began.elapsed().as_secs_f64();

    assert_eq!(ours.len(), theirs.len());
    for (k, (our, their)) in ours.iter().zip(&theirs).enumerate() {
        let without_cost = Status { cost: None, ..their.status };
        assert_eq!(*our, Tick { status: without_cost, ..*their }, "{format:?}, tick {k}");
    }
    // The axes have travelled: the comparison was not one of standstills.
    let forces = ours.iter().map(|tick| tick.outputs[0].force_n);
    let (least, most) = forces.fold((0f64, 0f64), |(least, most), n| (least.min(n), most.max(n)));
    assert!(least < -300.0 && most > 300.0, "{least} N to {most} N");

    let of = |position: bool| {
        let costs = theirs.iter().enumerate().filter(|(k, _)| k.is_multiple_of(DIVIDER) == position);
        median_and_most(costs.map(|(_, tick)| tick.status.cost.unwrap()).collect())
    };
    let costs = [of(true), of(false)];
    println!(
        "{format:?}: {} ticks equal to the last bit, {frames_per_s:.0} frames/s. Instructions of a tick, median and most: \
         {} and {} with position loops, {} and {} without",
        ours.len(),
        costs[0].0,
        costs[0].1,
        costs[1].0,
        costs[1].1
    );
    costs
}

/// A third less than was measured would mean that something is not counted, a half more that a change
/// made the tick that much slower. For comparison: at 20 kHz the board has 8400 cycles for a tick.
fn assert_within([position, velocity]: [(u32, u32); 2], bounds: [(u32, u32); 2]) {
    for ((median, most), (least, limit)) in [position, velocity].into_iter().zip(bounds) {
        assert!(
            least <= median && most <= limit,
            "{median} to {most} instructions, expected {least} to {limit}"
        );
    }
}

#[test]
fn fixed_point_is_the_same_to_the_last_bit() {
    assert_within(compare(Format::Fixed, 1.5), [(720, 2100), (180, 400)]);
}

#[test]
fn single_precision_is_the_same_to_the_last_bit() {
    assert_within(compare(Format::F32, 0.2), [(700, 2100), (140, 320)]);
}

#[test]
fn double_precision_is_the_same_to_the_last_bit() {
    assert_within(compare(Format::F64, 0.2), [(3700, 8400), (1450, 3500)]);
}

/// The comparison sees a change in the last place of one gain.
#[test]
fn a_gain_that_differs_by_1e_minus_15_is_seen() {
    let changed = MACHINE.replace("= 60.0", "= 60.00000000000001");
    assert_ne!(here(Format::F64, &changed, 0.1), here(Format::F64, MACHINE, 0.1));
}

#[test]
fn garbage_is_refused_and_the_end_is_an_end() {
    let mut emulator = emulator();
    let mut frame = [0xff; FRAME];
    emulator.exchange(&mut frame).unwrap();
    assert_eq!(decode::<Answer>(&frame), Ok(Answer::Refused(Refusal::Unreadable)));
    encode(&Order::Enable, &mut frame).unwrap();
    emulator.exchange(&mut frame).unwrap();
    assert_eq!(decode::<Answer>(&frame), Ok(Answer::Refused(Refusal::NotSetUp)));
    encode(&Order::End, &mut frame).unwrap();
    assert_eq!(emulator.exchange(&mut frame).unwrap_err(), "the emulator has ended");
}
