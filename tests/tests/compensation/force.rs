//! Friction, ripple and loads.

use super::runs::{CIRCLE, Compensated, PLAIN, changed, motion};

fn caused(effect: &str) {
    Compensated::of(effect).assert(1.0, 10.0, 0.5);
}

pub fn stribeck() {
    caused("name = \"stribeck\"\nstatic_excess_n = 90.0\nvelocity_mm_s = 5.0");
}

pub fn friction_asymmetry() {
    caused("name = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = 1500.0");
}

pub fn friction_map() {
    caused("name = \"friction_map\"\npositions_mm = [-20.0, -10.0, 0.0, 10.0, 20.0]\nfriction_n = [80.0, 0.0, -40.0, 0.0, 80.0]");
}

pub fn friction_warm_up() {
    let effect = "name = \"friction_warm_up\"\nforce_n = 150.0\ntime_constant_s = 120.0";
    Compensated::on(PLAIN, effect, &motion(CIRCLE, 60.0)).assert(1.0, 10.0, 0.5);
}

pub fn motor_stribeck() {
    caused("name = \"motor_stribeck\"\nstatic_excess_n = 60.0\nvelocity_mm_s = 5.0");
}

pub fn presliding() {
    let plain = changed(PLAIN, "presliding_stiffness_n_per_um = 40.0\npresliding_damping_n_s_per_m = 2000.0\n", "");
    let effect = "name = \"presliding\"\nstiffness_n_per_um = 20.0\ndamping_n_s_per_m = 2000.0";
    Compensated::on(&plain, effect, &motion(CIRCLE, 0.0)).assert(1.0, 10.0, 0.5);
}

pub fn preload_variation() {
    caused("name = \"preload_variation\"\ncentre_mm = 0.0\nslope_n_per_m = 3000.0\ncurvature_n_per_m2 = 0.0");
}

pub fn friction_ripple() {
    caused("name = \"friction_ripple\"\namplitude_n = 40.0\nperiod_mm = 10.0\nphase_rad = 0.5");
}

pub fn torque_ripple() {
    caused("name = \"torque_ripple\"\namplitude_n = 40.0\nperiod_mm = 10.0\nphase_rad = 0.5");
}

pub fn constant_load() {
    caused("name = \"constant_load\"\nforce_n = 800.0");
}

pub fn position_load() {
    caused("name = \"position_load\"\ncentre_mm = 0.0\nslope_n_per_m = 20000.0\ncurvature_n_per_m2 = 0.0");
}
