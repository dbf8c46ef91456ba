//! ωi and ζi of equation (3) from a log: the measured motor goes in, the measured tool has to come out.
//!
//! Least squares over the samples by Gauss and Newton on the logarithms of both, which keeps them positive.

use nalgebra::{Matrix2, Vector2};

use super::drive_model::Mechanics;
use crate::reproduce::ReproduceError;

/// Where the search starts: a structure of 100 Hz.
const START: Mechanics = Mechanics { omega_per_s: 600.0, damping_ratio: 0.3 };

/// Change of a logarithm that its derivative is taken over.
const NUDGE: f64 = 1e-4;

/// Change of both below which the search ends.
const SETTLED: f64 = 1e-8;

const MOST_ROUNDS: u32 = 60;

/// The mechanics that lead from motor to table (m, a sample apart), judged over the samples of `window`.
///
/// # Errors
/// When no mechanics do.
pub fn identify(
    motor_m: &[f64],
    table_m: &[f64],
    sample_s: f64,
    window: std::ops::Range<usize>,
) -> Result<Mechanics, ReproduceError> {
    let modelled = |at: &Vector2<f64>| of(at).table_m(motor_m, sample_s)[window.clone()].to_vec();
    let squares =
        |y: &[f64]| -> f64 { y.iter().zip(&table_m[window.clone()]).map(|(y, t)| (t - y).powi(2)).sum() };
    let mut at = Vector2::new(START.omega_per_s.ln(), START.damping_ratio.ln());
    let mut now = modelled(&at);
    for _ in 0..MOST_ROUNDS {
        let slopes = [Vector2::new(NUDGE, 0.0), Vector2::new(0.0, NUDGE)].map(|nudge| {
            let there = modelled(&(at + nudge));
            there.iter().zip(&now).map(|(there, here)| (there - here) / NUDGE).collect::<Vec<f64>>()
        });
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for (k, (table, y)) in table_m[window.clone()].iter().zip(&now).enumerate() {
            let slope = Vector2::new(slopes[0][k], slopes[1][k]);
            normal += slope * slope.transpose();
            right += slope * (table - y);
        }
        let Some(step) = normal.lu().solve(&right) else { break };
        // Half of the step until it helps.
        let mut share = 1.0;
        loop {
            let there = at + step * share;
            let then = modelled(&there);
            if squares(&then) <= squares(&now) || share < SETTLED {
                (at, now) = (there, then);
                break;
            }
            share *= 0.5;
        }
        if (step * share).amax() < SETTLED {
            return Ok(of(&at));
        }
    }
    Err(ReproduceError::Numerics("the mechanics of the corner's log were not identified".to_owned()))
}

fn of(logarithms: &Vector2<f64>) -> Mechanics {
    Mechanics { omega_per_s: logarithms[0].exp(), damping_ratio: logarithms[1].exp() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From what equation (3) itself made, its two numbers come back to the last digits.
    #[test]
    fn finds_what_made_the_log() {
        let made = Mechanics { omega_per_s: 471.0, damping_ratio: 0.17 };
        let motor: Vec<f64> = (0..2000).map(|k| 0.02 * (f64::from(k) * 0.01).sin().max(0.3)).collect();
        let found = identify(&motor, &made.table_m(&motor, 2.5e-4), 2.5e-4, 0..2000).unwrap();
        assert!(
            (found.omega_per_s / 471.0 - 1.0).abs() < 1e-6 && (found.damping_ratio / 0.17 - 1.0).abs() < 1e-6
        );
    }

    #[test]
    fn says_when_nothing_fits() {
        assert!(identify(&[0.0; 100], &[0.0; 100], 2.5e-4, 0..100).is_err());
    }
}
