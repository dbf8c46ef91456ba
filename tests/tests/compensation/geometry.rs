//! Errors of screw, encoder and tool.

use std::f64::consts::TAU;

use super::runs::{CIRCLE, Compensated, PLAIN, acceleration_m_per_s2, motion, position_m, radial_rms_um, velocity_m_per_s};

pub fn backlash() {
    let expected_um = radial_rms_um(|theta, direction| 5.0 * velocity_m_per_s(theta, direction).signum());
    Compensated::of("name = \"backlash\"\nwidth_um = 10.0").assert(expected_um, 0.1, 0.8);
}

pub fn pitch_progressive() {
    let expected_um = radial_rms_um(|theta, _| 100.0 * position_m(theta));
    Compensated::of("name = \"pitch_progressive\"\nslope_um_per_m = 100.0").assert(expected_um, 0.1, 0.8);
}

pub fn pitch_map() {
    let effect = "name = \"pitch_map\"\npositions_mm = [-20.0, -10.0, 0.0, 10.0, 20.0]\nerror_um = [0.0, 4.0, 0.0, -4.0, 0.0]";
    let expected_um = radial_rms_um(|theta, _| -4.0 * (TAU * position_m(theta) / 0.04).sin());
    Compensated::of(effect).assert(expected_um, 0.2, 0.8);
}

pub fn pitch_cyclic() {
    let expected_um = radial_rms_um(|theta, _| 3.0 * (TAU * position_m(theta) / 0.01 + 0.5).sin());
    Compensated::of("name = \"pitch_cyclic\"\namplitude_um = 3.0\nperiod_mm = 10.0\nphase_rad = 0.5").assert(expected_um, 0.2, 0.8);
}

pub fn resolver_dividing() {
    let period_m = 0.01 / 3.0;
    let expected_um = radial_rms_um(|theta, _| 2.0 * (TAU * position_m(theta) / period_m + 0.5).sin());
    let effect = format!("name = \"resolver_dividing\"\namplitude_um = 2.0\nperiod_mm = {:?}\nphase_rad = 0.5", 1e3 * period_m);
    Compensated::of(&effect).assert(expected_um, 0.5, 0.8);
}

pub fn encoder_ellipticity() {
    let expected_um = radial_rms_um(|theta, _| 2.0 * (TAU * position_m(theta) / 0.005 + 0.5).sin());
    let effect = "name = \"encoder_ellipticity\"\namplitude_um = 2.0\nperiod_mm = 5.0\nphase_rad = 0.5";
    Compensated::of(effect).assert(expected_um, 0.5, 0.8);
}

pub fn windup() {
    let expected_um = radial_rms_um(|theta, direction| {
        let v = velocity_m_per_s(theta, direction);
        let force_n = 180.0 * v.signum() + 1000.0 * v + 160.0 * acceleration_m_per_s2(theta);
        force_n * (1.0 / 80.0 - 1.0 / 200.0)
    });
    Compensated::of("name = \"windup\"\nstiffness_n_per_um = 80.0").assert(expected_um, 0.2, 0.8);
}

pub fn intalk() {
    let expected_um = radial_rms_um(|theta, _| 40.0 * acceleration_m_per_s2(theta));
    Compensated::of("name = \"intalk\"\num_s2_per_m = 40.0").assert(expected_um, 0.1, 0.8);
}

pub fn crosstalk() {
    let expected_um = radial_rms_um(|theta, _| 40.0 * acceleration_m_per_s2(theta - TAU / 4.0));
    Compensated::of("name = \"crosstalk\"\nsource = \"y\"\num_s2_per_m = 40.0").assert(expected_um, 0.1, 0.8);
}

pub fn squareness() {
    let expected_um = radial_rms_um(|theta, _| 150.0 * position_m(theta - TAU / 4.0));
    Compensated::of("name = \"squareness\"\num_per_m = 150.0").assert(expected_um, 0.1, 0.8);
}

pub fn straightness() {
    let expected_um = radial_rms_um(|theta, _| 1e4 * position_m(theta - TAU / 4.0).powi(2));
    Compensated::of("name = \"straightness\"\nsource = \"y\"\num_per_m2 = 10000.0").assert(expected_um, 0.1, 0.8);
}

pub fn thermal_drift() {
    let offset_um = |time_s: f64| 20.0 * (1.0 - (-time_s / 120.0).exp());
    let expected_um = radial_rms_um(|_, _| offset_um(63.0));
    let effect = "name = \"thermal_drift\"\namplitude_um = 20.0\ntime_constant_s = 120.0";
    Compensated::on(PLAIN, effect, &motion(CIRCLE, 60.0)).assert(expected_um, 0.1, 0.8);
}
