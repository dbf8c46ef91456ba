//! Circular tests from closed forms of the axis errors.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::simulated_circle::SPEED_RAD_PER_S;
use super::table_model::RADIUS_M;
use crate::reproduce::study::ReproduceError;
use contour::circular_test::Ballbar;

/// Error, µm, of an axis at R·cos(angle) with Dahl hysteresis: ±(w/2)·(1 − 2·e^(−s/λ)) against its motion, with s the
/// distance from the last reversal, w the width and λ `distance_um`. `sense` is 1 counter-clockwise, −1 clockwise.
#[must_use]
pub fn dahl_lag_um(angle: f64, sense: f64, width_um: f64, distance_um: f64) -> f64 {
    // After the reversal at 0 the axis moves in −, after that at π in +.
    let side = if (sense * angle).rem_euclid(TAU) < TAU / 2.0 { 1.0 } else { -1.0 };
    let travelled_um = 1e6 * RADIUS_M * (side - libm::cos(angle)).abs();
    side * 0.5 * width_um * (1.0 - 2.0 * libm::exp(-travelled_um / distance_um))
}

/// Error of both axes, µm, if the slower one is delayed: −v·T of that axis.
#[must_use]
pub fn delay_um(angle: f64, sense: f64, delay_s: f64) -> [f64; 2] {
    let path_um = 1e6 * RADIUS_M * SPEED_RAD_PER_S * delay_s * sense;
    // Within 45° of the first axis, that axis is the slower one.
    let is_first_slower = (angle + FRAC_PI_4).rem_euclid(TAU / 2.0) < TAU / 4.0;
    if is_first_slower { [path_um * libm::sin(angle), 0.0] } else { [0.0, -path_um * libm::cos(angle)] }
}

/// The circular test with errors of the axes, µm, as a function of the angle (rad) and the direction (1 or −1).
///
/// # Errors
/// If an error is not finite.
pub fn from_axis_errors(error_um: impl Fn(f64, f64) -> [f64; 2]) -> Result<Ballbar, ReproduceError> {
    const SAMPLES: usize = 14_400;
    let lap = |sense: f64| {
        let point = |i: usize| {
            // Never exactly on a reversal, where the sign is undefined.
            let angle = TAU * (i as f64 + 0.5) / SAMPLES as f64;
            let [x_um, y_um] = error_um(angle, sense);
            [RADIUS_M * libm::cos(angle) + 1e-6 * x_um, RADIUS_M * libm::sin(angle) + 1e-6 * y_um]
        };
        super::lap::lap(&(0..SAMPLES).map(point).collect::<Vec<_>>(), RADIUS_M)
    };
    Ok(Ballbar { positive: lap(1.0)?, negative: lap(-1.0)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed form against Dahl's equation dz = (sign(v)·w/2 − z)/λ·ds, integrated in small steps over two laps; the
    /// second is compared.
    #[test]
    fn the_hysteresis_solves_dahls_equation() {
        const STEPS: usize = 200_000;
        let (width_um, distance_um) = (5.0, 30.0);
        let mut lag = 0.0;
        for i in 0..2 * STEPS {
            let angle = |i: usize| TAU * i as f64 / STEPS as f64;
            let step_um = 1e6 * RADIUS_M * (angle(i + 1).cos() - angle(i).cos());
            // The lag points against the motion.
            lag += (-step_um.signum() * 0.5 * width_um - lag) * step_um.abs() / distance_um;
            if i > STEPS && i % 1000 == 500 {
                let closed = dahl_lag_um(angle(i + 1), 1.0, width_um, distance_um);
                assert!((lag - closed).abs() < 0.02, "{i}: {lag} {closed}");
            }
        }
    }
}
