//! Identifies ωi and ζi of equation (3) from a log: input is the measured motor, output the measured tool.
//!
//! Least squares over the samples by the Gauss–Newton method, on the logarithms of both, which keeps them positive.

use nalgebra::{Matrix2, Vector2};

use super::drive_model::Mechanics;
use crate::reproduce::study::ReproduceError;

/// Initial guess: a structure of about 100 Hz.
const INITIAL: Mechanics = Mechanics { omega_per_s: 600.0, damping_ratio: 0.3 };

/// Step of a logarithm for the finite differences.
const DIFFERENCE_STEP: f64 = 1e-4;

/// The search ends when both logarithms change by less than this.
const CONVERGED: f64 = 1e-8;

/// Maximum number of iterations.
const MAX_ITERATIONS: u32 = 60;

/// Mechanics from motor to table positions (m, one sample apart), fitted over the samples of `window`.
///
/// # Errors
/// If the fit does not converge.
pub fn identify(
    motor_m: &[f64],
    table_m: &[f64],
    sample_s: f64,
    window: std::ops::Range<usize>,
) -> Result<Mechanics, ReproduceError> {
    let modelled =
        |at: &Vector2<f64>| from_logarithms(at).table_m(motor_m, sample_s)[window.clone()].to_vec();
    let squares =
        |y: &[f64]| -> f64 { y.iter().zip(&table_m[window.clone()]).map(|(y, t)| (t - y).powi(2)).sum() };
    let mut at = Vector2::new(libm::log(INITIAL.omega_per_s), libm::log(INITIAL.damping_ratio));
    let mut now = modelled(&at);
    for _ in 0..MAX_ITERATIONS {
        let slopes = [Vector2::new(DIFFERENCE_STEP, 0.0), Vector2::new(0.0, DIFFERENCE_STEP)].map(|step| {
            let next = modelled(&(at + step));
            next.iter().zip(&now).map(|(next, now)| (next - now) / DIFFERENCE_STEP).collect::<Vec<f64>>()
        });
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for (k, (table, y)) in table_m[window.clone()].iter().zip(&now).enumerate() {
            let slope = Vector2::new(slopes[0][k], slopes[1][k]);
            normal += slope * slope.transpose();
            right += slope * (table - y);
        }
        let Some(step) = normal.lu().solve(&right) else { break };
        // Line search: the step is halved until the sum of squares decreases.
        let mut fraction = 1.0;
        loop {
            let next = at + step * fraction;
            let output = modelled(&next);
            if squares(&output) <= squares(&now) || fraction < CONVERGED {
                (at, now) = (next, output);
                break;
            }
            fraction *= 0.5;
        }
        if (step * fraction).amax() < CONVERGED {
            return Ok(from_logarithms(&at));
        }
    }
    Err(ReproduceError::Numerics("the mechanics of the corner's log were not identified".to_owned()))
}

/// From ln ω and ln ζ.
fn from_logarithms(logarithms: &Vector2<f64>) -> Mechanics {
    Mechanics { omega_per_s: libm::exp(logarithms[0]), damping_ratio: libm::exp(logarithms[1]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the output of equation (3) itself, both parameters are recovered.
    #[test]
    fn recovers_the_parameters() {
        let exact = Mechanics { omega_per_s: 471.0, damping_ratio: 0.17 };
        let motor: Vec<f64> = (0..2000).map(|k| 0.02 * (f64::from(k) * 0.01).sin().max(0.3)).collect();
        let found = identify(&motor, &exact.table_m(&motor, 2.5e-4), 2.5e-4, 0..2000).unwrap();
        assert!(
            (found.omega_per_s / 471.0 - 1.0).abs() < 1e-6 && (found.damping_ratio / 0.17 - 1.0).abs() < 1e-6
        );
    }

    #[test]
    fn no_motion_is_an_error() {
        assert!(identify(&[0.0; 100], &[0.0; 100], 2.5e-4, 0..100).is_err());
    }
}
