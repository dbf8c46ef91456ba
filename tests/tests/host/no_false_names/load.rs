//! Forces that are no constant load.

use model::effects::Stage;
use self_test::plant::Sinusoid;
use trace::verdict::{self, Verdict};

use super::machine::TestMachine;
use super::reported::{assert_named, assert_value, context, found};

/// Once a constant load and a slope of the screw.
#[test]
fn a_force_that_grows_along_the_travel_is_a_position_load() {
    let slopes_n_per_m = [2000.0, -1000.0];
    let mut machine = TestMachine::new(2);
    for (axis, slope) in slopes_n_per_m.into_iter().enumerate() {
        machine = machine.with_mechanics(axis, |mechanics| mechanics.load_n_per_m = slope);
    }
    let trace = machine.trace();
    assert_named(&trace, &[("x", "position_load"), ("y", "position_load")]);
    for (axis, slope) in slopes_n_per_m.into_iter().enumerate() {
        assert_value(found(&trace, axis, "position_load"), "slope_n_per_m", slope, 10.0);
    }
}

/// A joint with an arm of 150 N·m whose load is highest at 30°, over the ± 80° that the simulated table moves: once a constant load and a position
/// load. 150·cos(q − 30°) is 75·sin q + 129.9·cos q. The other joint has no load and gets none.
#[test]
fn the_load_of_a_joint_over_its_angle_is_gravity() {
    let machine = TestMachine::new(2).with_mechanics(0, |mechanics| {
        // sin(q + 60°): 360° are 0.36 of the simulated metres.
        mechanics.load_wave = Sinusoid { amplitude: 150.0, period: 0.36, phase: 60f64.to_radians() };
    });
    let traced = machine.trace_as_joints();
    assert_named(&traced, &[("x", "gravity")]);
    let gravity = found(&traced, 0, "gravity");
    assert_value(gravity, "sine_n", 75.0, 2.0);
    assert_value(gravity, "cosine_n", 129.9, 2.0);
}

/// The zero of a force sensor: once "constant load 1000 N", which makes the closed loop worse, as no such force acts.
#[test]
fn an_offset_of_the_logged_force_is_not_a_load() {
    let offset_n = 1000.0;
    let trace = TestMachine::new(3).trace_of(|log| {
        for force_n in log.axes[0].force.as_mut().unwrap() {
            *force_n += offset_n;
        }
    });
    assert_named(&trace, &[]);
    assert_eq!(verdict::of_axis(&trace.axes()[0]), Verdict::ModelDoesNotFit, "{}", context(&trace));
    assert!(verdict::of_axis(&trace.axes()[1]) < Verdict::ModelDoesNotFit, "{}", context(&trace));
    // No declared value takes the place of the load: the whole offset remains, to within the friction.
    let force = trace.axes()[0].residuals.iter().find(|error| error.stage == Stage::Force).unwrap();
    assert!((force.after.validate / offset_n - 1.0).abs() < 0.1, "{force:?}");
}
