//! Gains of a drive that are not those of its settings.

use super::runs::{Compensated, SPEED_MM_S};

const LAG_UM: f64 = 1e3 * SPEED_MM_S / 50.0;

pub fn servo_mismatch() {
    Compensated::of("name = \"servo_mismatch\"\npercent = 5.0").assert(0.05 / 1.05 * LAG_UM / 8f64.sqrt(), 0.1, 0.8);
}

pub fn feedforward_mismatch() {
    Compensated::of("name = \"feedforward_mismatch\"\npercent = 5.0").assert(0.05 * LAG_UM / 8f64.sqrt(), 0.1, 0.8);
}

pub fn velocity_gain_mismatch() {
    Compensated::of("name = \"velocity_gain_mismatch\"\npercent = -30.0").assert(1.0, 10.0, 0.5);
}

pub fn integral_time_mismatch() {
    Compensated::of("name = \"integral_time_mismatch\"\npercent = 50.0").assert(1.0, 10.0, 0.5);
}
