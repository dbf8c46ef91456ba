//! Each effect of the catalogue, each key of the instruments and each friction curve, in a simulated run.
//!
//! Every test runs a machine twice in closed loop, with and without one entry of its file, on a motion on which the
//! entry has an effect. The doc of a test gives the equation of its expected size, from the definition of the entry;
//! the bound covers what the equation neglects. Channels that an entry must not affect are equal to the last bit.

mod bodies;
mod curve;
mod force;
mod instruments;
mod runs;
mod scale;
mod screw;
mod servo;
mod tool;

use tests::tested;

tested! {
    screw: backlash, pitch_progressive, pitch_cyclic, resolver_dividing, encoder_ellipticity, pitch_map;
    scale: scale_gain, scale_cyclic, thermal_growth;
    screw: windup, stiffness_map, gear_hysteresis;
    force: stribeck, friction_asymmetry, torque_ripple, constant_load, drive_asymmetry, position_load, gravity,
        motor_stribeck, friction_warm_up,
        friction_map, presliding, shear_thinning, friction_memory,
        preload_variation, friction_ripple, quadratic_drag;
    servo: servo_mismatch, velocity_lag, feedforward_mismatch, velocity_gain_mismatch, integral_time_mismatch,
        drive_lag, drive_dead_time, computation_delay;
    tool: intalk, crosstalk, squareness, straightness, straightness_map, yaw, probe_rotation, probe_gain, thermal_drift, thermal_rate,
        latency, resonance;
}

/// Effects of axes whose masses or loops are not declared, which cannot be simulated: the tests in `drives` have them.
const OF_UNKNOWN_AXES: [&str; 3] = ["lost_motion", "microstep_error", "load_angle"];

/// A simulation has no temperature: `no_false_names::temperature` has it.
const OF_TEMPERATURE: &str = "friction_temperature";

#[test]
fn every_effect_of_the_catalogue_is_tested() {
    let simulated = |name: &&str| {
        !OF_UNKNOWN_AXES.contains(name)
            && *name != OF_TEMPERATURE
            && !servo::NOT_SIMULATED.iter().any(|effect| effect.contains(&format!("\"{name}\"")))
    };
    assert_eq!(TESTED, model::effects::names().into_iter().filter(simulated).collect::<Vec<_>>());
}
