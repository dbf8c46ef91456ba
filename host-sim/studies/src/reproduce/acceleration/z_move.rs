//! The paper's 20 mm movement in z (section 3.4), and the limit that its acceleration depends on.
//!
//! From rest to rest with only the jerk j limited, the acceleration is one positive and one negative triangle of peak a.
//! Each takes 2a/j and covers half of the distance s = 2a³/j²; the peak speed is a²/j. If both peaks are below their
//! limits, the jerk and the distance alone determine the movement.

use shared::interpolate::{Block, Path, PathError, Ramps};
use shared::units::Position;

use super::closed_loop::{ClosedLoop, RATES, Row, SAMPLE_S, Z};
use crate::reproduce::study::ReproduceError;
use plant::controller::ControllerError;
use plant::simulate::SimulationError;

/// Distance of the movement, m.
pub const DISTANCE_M: f64 = 0.02;

/// Half width of the window in which an acceleration is fitted, rows: ±1.25 ms.
const HALF_WINDOW: usize = 5;

/// Limits of a movement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed.
    pub speed_m_per_s: f64,
    /// Acceleration.
    pub acceleration_m_per_s2: f64,
    /// Jerk.
    pub jerk_m_per_s3: f64,
}

/// The paper's limits: 30,000 mm/min, 10 m/s², 250 m/s³.
pub const PRINTED: Limits = Limits { speed_m_per_s: 0.5, acceleration_m_per_s2: 10.0, jerk_m_per_s3: 250.0 };

/// Peak absolute values of a movement.
pub type Peaks = Limits;

/// Peaks of a movement over a distance (m) with only the jerk limited: a = ∛(s·j²/2), v = a²/j.
#[must_use]
pub fn jerk_limited_peaks(distance_m: f64, jerk_m_per_s3: f64) -> Peaks {
    let acceleration = libm::cbrt(0.5 * distance_m * jerk_m_per_s3.powi(2));
    Peaks {
        speed_m_per_s: acceleration.powi(2) / jerk_m_per_s3,
        acceleration_m_per_s2: acceleration,
        jerk_m_per_s3,
    }
}

/// Jerk at which a movement over a distance (m) just reaches an acceleration, m/s³: j = √(2a³/s).
#[must_use]
pub fn jerk_reaching(distance_m: f64, acceleration_m_per_s2: f64) -> f64 {
    (2.0 * acceleration_m_per_s2.powi(3) / distance_m).sqrt()
}

/// Peaks that the interpolator of `shared` commands on the movement, from differences of its positions.
///
/// # Errors
/// If the interpolator rejects the movement.
pub fn commanded(limits: Limits) -> Result<Peaks, ReproduceError> {
    let mut path = Path::<1>::new([Position(0)], RATES.velocity_loop_hz);
    let block = Block::line([DISTANCE_M], limits.speed_m_per_s, limits.acceleration_m_per_s2)
        .with_ramps(Ramps::SCurve { jerk_m_per_s3: limits.jerk_m_per_s3 });
    path.push(&block).map_err(rejected)?;
    let mut positions = vec![0.0];
    while !path.is_done() {
        positions.push(path.advance()[0].to_m());
    }
    let rates = |values: &[f64]| -> Vec<f64> {
        values.windows(2).map(|pair| (pair[1] - pair[0]) / SAMPLE_S).collect()
    };
    let peak = |values: &[f64]| numerics::max_abs(values.iter().copied());
    let speeds = rates(&positions);
    let accelerations = rates(&speeds);
    Ok(Peaks {
        speed_m_per_s: peak(&speeds),
        acceleration_m_per_s2: peak(&accelerations),
        jerk_m_per_s3: peak(&rates(&accelerations)),
    })
}

/// A simulated run of the movement.
#[derive(Clone, Debug)]
pub struct ZMove {
    /// All rows.
    pub rows: Vec<Row>,
    /// Acceleration of z from the internal reading, m/s²; 0 within half a window of either end.
    pub acceleration: Vec<f64>,
}

impl ZMove {
    /// Runs the movement, from z = −10 mm to 10 mm.
    ///
    /// # Errors
    /// If the simulation fails.
    pub fn run(machine: &ClosedLoop) -> Result<Self, ReproduceError> {
        let line =
            Block::line([0.0, 0.0, 0.5 * DISTANCE_M], PRINTED.speed_m_per_s, PRINTED.acceleration_m_per_s2)
                .with_ramps(Ramps::SCurve { jerk_m_per_s3: PRINTED.jerk_m_per_s3 });
        let rows =
            machine.run([0.0, 0.0, -0.5 * DISTANCE_M], &[Block::dwell(0.05), line, Block::dwell(0.15)])?;
        let positions: Vec<f64> = rows.iter().map(|row| row.scale_m[Z]).collect();
        Ok(Self { acceleration: accelerations(&positions), rows })
    }

    /// Error of the structure along one axis, µm.
    #[must_use]
    pub fn error_um(&self, axis: usize) -> Vec<f64> {
        self.rows.iter().map(|row| 1e6 * row.error_m(axis)).collect()
    }

    /// Maximum acceleration of z (m/s²), and the error of an axis at that time (µm).
    #[must_use]
    pub fn peak(&self, axis: usize) -> (f64, f64) {
        let errors = self.error_um(axis);
        let peak = self.acceleration.iter().zip(errors).max_by(|a, b| a.0.total_cmp(b.0));
        peak.map_or((0.0, 0.0), |(acceleration, error)| (*acceleration, error))
    }

    /// Error of an axis per acceleration of z, by least squares over the whole movement, µm per m/s².
    #[must_use]
    pub fn coefficient(&self, axis: usize) -> f64 {
        let terms = |(error, a): (f64, &f64)| (error * a, a * a);
        let pairs = self.error_um(axis).into_iter().zip(&self.acceleration).map(terms);
        let (products, squares) = pairs.fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        products / squares
    }

    /// Rms error of an axis after subtraction of a coefficient (µm per m/s² of z), µm.
    #[must_use]
    pub fn rms_residual_um(&self, axis: usize, um_s2_per_m: f64) -> f64 {
        let residual = |(error, a): (f64, &f64)| error - um_s2_per_m * a;
        numerics::rms(self.error_um(axis).into_iter().zip(&self.acceleration).map(residual))
    }
}

/// Second derivative, m/s², of positions a sample apart: least-squares parabola in a window about each row; 0 within half
/// a window of either end.
pub fn accelerations(positions_m: &[f64]) -> Vec<f64> {
    let squares: Vec<f64> = (0..=2 * HALF_WINDOW).map(|k| (k as f64 - HALF_WINDOW as f64).powi(2)).collect();
    let mean = numerics::mean(squares.iter().copied());
    let weights: Vec<f64> = squares.iter().map(|square| square - mean).collect();
    let sum: f64 = weights.iter().map(|weight| weight * weight).sum::<f64>() * 0.5 * SAMPLE_S.powi(2);
    let mut found = vec![0.0; positions_m.len()];
    for (i, window) in positions_m.windows(weights.len()).enumerate() {
        // Relative to the middle: the weights then multiply millimetres at most, which keeps the rounding small.
        let middle = window[HALF_WINDOW];
        found[i + HALF_WINDOW] =
            window.iter().zip(&weights).map(|(position, weight)| (position - middle) * weight).sum::<f64>()
                / sum;
    }
    found
}

fn rejected(error: PathError) -> ReproduceError {
    SimulationError::from(ControllerError::Refused(error.into())).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a = ∛(0.02·250²/2) = ∛625 = 8.550 m/s², v = a²/j = 0.2924 m/s; 10 m/s² take √(2·1000/0.02) = 316.2 m/s³.
    #[test]
    fn the_jerk_limits_the_move() {
        let alone = jerk_limited_peaks(DISTANCE_M, PRINTED.jerk_m_per_s3);
        assert!(
            (alone.acceleration_m_per_s2.powi(3) - 625.0).abs() < 1e-9
                && (alone.speed_m_per_s - 0.2924).abs() < 1e-4
        );
        assert!((jerk_reaching(DISTANCE_M, 10.0) - 316.228).abs() < 1e-3);
        let commanded = commanded(PRINTED).unwrap();
        // The peak of the triangle lies between two ticks: half a tick of jerk on either side of it.
        let tolerance = PRINTED.jerk_m_per_s3 * SAMPLE_S;
        assert!(
            (alone.acceleration_m_per_s2 - tolerance..=alone.acceleration_m_per_s2)
                .contains(&commanded.acceleration_m_per_s2),
            "{commanded:?}"
        );
        assert!((commanded.speed_m_per_s - alone.speed_m_per_s).abs() < tolerance * SAMPLE_S * 2.0);
        assert!((commanded.jerk_m_per_s3 / PRINTED.jerk_m_per_s3 - 1.0).abs() < 1e-3);
        // A higher speed limit changes nothing; a higher jerk limit does.
        assert_eq!(super::commanded(Limits { speed_m_per_s: 1.0, ..PRINTED }).unwrap(), commanded);
        let more_jerk = super::commanded(Limits { jerk_m_per_s3: 330.0, ..PRINTED }).unwrap();
        assert!((more_jerk.acceleration_m_per_s2 - 10.0).abs() < 0.01);
    }

    /// The fit is exact for a parabola, and for a cubic at the middle of the window.
    #[test]
    fn the_acceleration_of_a_polynomial_is_exact() {
        let time = |i: usize| i as f64 * SAMPLE_S;
        let positions: Vec<f64> = (0..100).map(|i| 3.0 * time(i).powi(2) - 20.0 * time(i).powi(3)).collect();
        let found = accelerations(&positions);
        assert!(found[..HALF_WINDOW].iter().all(|a| *a == 0.0));
        for (i, found) in found.iter().enumerate().take(100 - HALF_WINDOW).skip(HALF_WINDOW) {
            assert!((found - (6.0 - 120.0 * time(i))).abs() < 1e-6, "{i}: {found}");
        }
    }
}
