//! Each effect of the catalogue: its item of a compensation on a simulated machine, or why there is none.

mod document;
mod force;
mod geometry;
mod laws;
mod listed;
mod mapped;
mod runs;
mod second_simulator_laws;
mod sensors;
mod servo;
mod theory;
mod watched;

use tests::tested;

tested! {
    geometry: backlash, lost_motion, load_angle, pitch_progressive, pitch_map, pitch_cyclic, resolver_dividing, encoder_ellipticity, windup, intalk,
        crosstalk, resonance, squareness, straightness, straightness_map, yaw, thermal_drift;
    force: stribeck, friction_asymmetry, friction_map, friction_warm_up, motor_stribeck, presliding, preload_variation,
        friction_ripple, torque_ripple, constant_load, position_load, gravity;
    servo: servo_mismatch, feedforward_mismatch, velocity_gain_mismatch, integral_time_mismatch;
}
