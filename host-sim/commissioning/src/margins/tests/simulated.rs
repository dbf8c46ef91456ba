//! The gain at which the simulated closed loop becomes unstable is the one at which the linear model does.
//!
//! The controller is the one of `shared` in double precision, the plant that of the crate `plant`, whose steps are not those
//! of the linear model. Their loops differ by the rounding of positions to 2⁻⁵⁰ m units and by the second-order
//! error of the simulated steps: the limits agree within 0.5 %.

use motion::{PathBlock, PathShape};
use plant::controller::in_process;
use shared::axis::Reading;
use shared::config::Notch;
use shared::interpolate::{Joint, Ramps};
use shared::scalar::Format;
use shared::units::Position;

use crate::margins::axis_margins::{AxisLoops, MarginLimits};
use crate::margins::tests::{instruments, machine};
use model::machine::Machine;
use plant::machine_sim::MachineSim;
use plant::simulate;

/// Agreement of the two limits, relative.
const AGREEMENT: f64 = 5e-3;

/// Only stability counts.
const STABLE: MarginLimits = MarginLimits { gain_db: 0.0, phase_deg: 0.0 };

/// Growth of the oscillation: rms of the following error in the last quarter of 4 s after a move of 10 µm over that in the
/// quarter before.
fn growth(machine: &Machine) -> f64 {
    let (settings, start) = simulate::controller_setup(machine, &[0.0]).unwrap();
    let mut controller = in_process(Format::F64, machine.rates(), &settings, &start).unwrap();
    let mut sim = MachineSim::new(machine, instruments(), &[0.0]).unwrap();
    controller.enable().unwrap();
    let line = PathBlock {
        shape: PathShape::Line { to_m: vec![1e-5] },
        feed_m_per_s: 0.01,
        acceleration_m_per_s2: 2.0,
        ramps: Ramps::Trapezoid,
        joint: Joint::Stop,
    };
    controller.push(&line).unwrap();
    let mut readings = [Reading { motor: Position(0), table: None }];
    let mut outputs = [Default::default()];
    let ticks = 16_000;
    let mut squares = [0.0; 4];
    for tick in 0..ticks {
        sim.read(&mut readings);
        controller.tick(&readings, &mut outputs).unwrap();
        let error_m = (outputs[0].command - readings[0].motor) as f64;
        squares[4 * tick / ticks] += error_m * error_m;
        sim.step(outputs.iter().map(|output: &plant::controller::AxisOutput| output.force_n));
    }
    (squares[3] / squares[2]).sqrt()
}

fn grows(machine: &Machine, gain_per_s: f64) -> bool {
    let mut machine = machine.clone();
    machine.axis[0].settings.controller.position_gain_per_s = Some(gain_per_s);
    growth(&machine) > 1.0
}

/// Asserts that the oscillation decays just below the predicted limit, and grows just above it.
fn limit_is_that_of_the_simulation(machine: &Machine, name: &str) -> f64 {
    let loops = AxisLoops::of_machine(machine, &instruments()).unwrap().remove(0);
    let limit = loops.highest_position_gain_per_s(STABLE).unwrap();
    assert!(!grows(machine, limit * (1.0 - AGREEMENT)), "{name}: {limit}");
    assert!(grows(machine, limit * (1.0 + AGREEMENT)), "{name}: {limit}");
    limit
}

#[test]
fn the_highest_stable_gain_is_that_of_the_simulated_loop() {
    for controller in ["p", "hpc"] {
        for feedback in ["motor", "table", "dual"] {
            let machine = machine(controller, feedback);
            let limit = limit_is_that_of_the_simulation(&machine, &format!("{controller} {feedback}"));
            // Not at an end of the search.
            assert!((20.0..2000.0).contains(&limit), "{controller} {feedback}: {limit}");
        }
    }
}

/// The observer of the velocity, with and without an average before it.
#[test]
fn an_observer_is_part_of_the_loop() {
    let mut machine = machine("p", "motor");
    let without = limit_is_that_of_the_simulation(&machine, "without an observer");
    machine.axis[0].settings.controller.velocity_observer_hz = Some(300.0);
    let with = limit_is_that_of_the_simulation(&machine, "with an observer");
    assert!(with < without * (1.0 - 4.0 * AGREEMENT), "the observer lowers the limit: {with} {without}");
    let lag = model::effects::VelocityLag { ms: 0.1 };
    machine.axis[0].effect.push(model::effects::Effect::VelocityLag(lag));
    limit_is_that_of_the_simulation(&machine, "with an observer of a late velocity");
}

/// Filters of the force, and a velocity reading that is averaged.
#[test]
fn filters_and_velocity_lag_are_part_of_the_loop() {
    let mut machine = machine("p", "table");
    let without = limit_is_that_of_the_simulation(&machine, "without filters");
    let filters = &mut machine.axis[0].settings.filters;
    *filters = filters.with_notches(&[
        Notch { frequency_hz: 150.0, width_hz: 80.0, depth: 0.9 },
        Notch { frequency_hz: 260.0, width_hz: 50.0, depth: 0.8 },
    ]);
    (filters.low_pass_frequency_hz, filters.low_pass_damping_ratio) = (Some(400.0), Some(0.7));
    let lag = model::effects::VelocityLag { ms: 0.2 };
    machine.axis[0].effect.push(model::effects::Effect::VelocityLag(lag));
    let with = limit_is_that_of_the_simulation(&machine, "with filters");
    assert!((with / without - 1.0).abs() > 4.0 * AGREEMENT, "the filters change the limit: {with} {without}");
}
