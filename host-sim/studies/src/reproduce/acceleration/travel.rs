//! The paper's 20 mm movement in z (section 3.4), and which of its limits the acceleration stops at.
//!
//! From rest to rest with jerk j alone the acceleration is a triangle up and down, twice: each ramp takes 2a/j and covers
//! half of the way s = 2a³/j², at the peak speed a²/j. What stays below both other limits is limited by nothing but
//! the jerk and the way.

use shared::interpolate::{Block, Path, PathError, Ramps};
use shared::units::Position;

use super::bench::{Bench, RATES, Row, SAMPLE_S};
use crate::reproduce::ReproduceError;
use link::controller::ControllerError;
use plant::simulate::SimulationError;

/// How far, m.
pub const WAY_M: f64 = 0.02;

/// The axis that moves.
pub const Z: usize = 2;

/// Half the window of the parabola that gives an acceleration, rows: ±1.25 ms.
const HALF_WINDOW: usize = 5;

/// Limits of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed.
    pub speed_m_per_s: f64,
    /// Acceleration.
    pub acceleration_m_per_s2: f64,
    /// Jerk.
    pub jerk_m_per_s3: f64,
}

/// 30,000 mm/min, 10 m/s², 250 m/s³.
pub const PRINTED: Limits = Limits { speed_m_per_s: 0.5, acceleration_m_per_s2: 10.0, jerk_m_per_s3: 250.0 };

/// The greatest values of a move.
pub type Peaks = Limits;

/// What the jerk alone makes of a way.
#[must_use]
pub fn by_jerk_alone(way_m: f64, jerk_m_per_s3: f64) -> Peaks {
    let acceleration = (0.5 * way_m * jerk_m_per_s3.powi(2)).cbrt();
    Peaks {
        speed_m_per_s: acceleration.powi(2) / jerk_m_per_s3,
        acceleration_m_per_s2: acceleration,
        jerk_m_per_s3,
    }
}

/// The jerk with which a way is just long enough for an acceleration, m/s³.
#[must_use]
pub fn jerk_for(way_m: f64, acceleration_m_per_s2: f64) -> f64 {
    (2.0 * acceleration_m_per_s2.powi(3) / way_m).sqrt()
}

/// What the interpolator of `shared` makes of the move, by differences of its commands.
///
/// # Errors
/// Where it refuses the move.
pub fn commanded(limits: Limits) -> Result<Peaks, ReproduceError> {
    let mut path = Path::<1>::new([Position(0)], RATES.velocity_loop_hz);
    let block = Block::line([WAY_M], limits.speed_m_per_s, limits.acceleration_m_per_s2)
        .with_ramps(Ramps::SCurve { jerk_m_per_s3: limits.jerk_m_per_s3 });
    path.push(&block).map_err(refused)?;
    let mut places = vec![0.0];
    while !path.is_done() {
        places.push(path.advance()[0].to_m());
    }
    let rates = |values: &[f64]| -> Vec<f64> {
        values.windows(2).map(|pair| (pair[1] - pair[0]) / SAMPLE_S).collect()
    };
    let most = |values: &[f64]| numerics::max_abs(values.iter().copied());
    let speeds = rates(&places);
    let accelerations = rates(&speeds);
    Ok(Peaks {
        speed_m_per_s: most(&speeds),
        acceleration_m_per_s2: most(&accelerations),
        jerk_m_per_s3: most(&rates(&accelerations)),
    })
}

/// The move as it was run.
#[derive(Clone, Debug)]
pub struct Travel {
    /// All rows.
    pub rows: Vec<Row>,
    /// Acceleration of z by the internal reading, m/s²; zero within half a window of the ends.
    pub acceleration: Vec<f64>,
}

impl Travel {
    /// Runs the move.
    ///
    /// # Errors
    /// When the loop does not hold.
    pub fn run(bench: &Bench) -> Result<Self, ReproduceError> {
        let line = Block::line([0.0, 0.0, 0.5 * WAY_M], PRINTED.speed_m_per_s, PRINTED.acceleration_m_per_s2)
            .with_ramps(Ramps::SCurve { jerk_m_per_s3: PRINTED.jerk_m_per_s3 });
        let rows = bench.run([0.0, 0.0, -0.5 * WAY_M], &[Block::dwell(0.05), line, Block::dwell(0.15)])?;
        let places: Vec<f64> = rows.iter().map(|row| row.scale_m[Z]).collect();
        Ok(Self { acceleration: accelerations(&places), rows })
    }

    /// What one axis errs by, µm.
    #[must_use]
    pub fn error_um(&self, axis: usize) -> Vec<f64> {
        self.rows.iter().map(|row| 1e6 * row.error_m(axis)).collect()
    }

    /// The greatest acceleration, and the error of an axis then (µm).
    #[must_use]
    pub fn at_most(&self, axis: usize) -> (f64, f64) {
        let errors = self.error_um(axis);
        let most = self.acceleration.iter().zip(errors).max_by(|a, b| a.0.total_cmp(b.0));
        most.map_or((0.0, 0.0), |(acceleration, error)| (*acceleration, error))
    }

    /// Error of an axis per acceleration of z by least squares over the whole move, µm per m/s².
    #[must_use]
    pub fn coefficient(&self, axis: usize) -> f64 {
        let both = |(error, a): (f64, &f64)| (error * a, a * a);
        let pairs = self.error_um(axis).into_iter().zip(&self.acceleration).map(both);
        let (products, squares) = pairs.fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        products / squares
    }

    /// Root mean square of an axis' error that coefficients (µm per m/s² of z) leave, µm.
    #[must_use]
    pub fn left_um(&self, axis: usize, um_s2_per_m: f64) -> f64 {
        let left = |(error, a): (f64, &f64)| error - um_s2_per_m * a;
        numerics::rms(self.error_um(axis).into_iter().zip(&self.acceleration).map(left))
    }
}

/// Second derivatives by a parabola through a window about each row.
pub fn accelerations(places_m: &[f64]) -> Vec<f64> {
    let squares: Vec<f64> = (0..=2 * HALF_WINDOW).map(|k| (k as f64 - HALF_WINDOW as f64).powi(2)).collect();
    let mean = numerics::mean(squares.iter().copied());
    let weights: Vec<f64> = squares.iter().map(|square| square - mean).collect();
    let sum: f64 = weights.iter().map(|weight| weight * weight).sum::<f64>() * 0.5 * SAMPLE_S.powi(2);
    let mut all = vec![0.0; places_m.len()];
    for (i, window) in places_m.windows(weights.len()).enumerate() {
        // About the middle: the weights then multiply millimetres at the most.
        let middle = window[HALF_WINDOW];
        all[i + HALF_WINDOW] =
            window.iter().zip(&weights).map(|(place, weight)| (place - middle) * weight).sum::<f64>() / sum;
    }
    all
}

fn refused(error: PathError) -> ReproduceError {
    SimulationError::from(ControllerError::Refused(error.into())).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: a = ∛(0.02·250²/2) = ∛625 = 8.550 m/s², v = a²/j = 0.2924 m/s; 10 m/s² take √(2·1000/0.02) = 316.2 m/s³.
    #[test]
    fn the_jerk_limits_the_move() {
        let alone = by_jerk_alone(WAY_M, PRINTED.jerk_m_per_s3);
        assert!(
            (alone.acceleration_m_per_s2.powi(3) - 625.0).abs() < 1e-9
                && (alone.speed_m_per_s - 0.2924).abs() < 1e-4
        );
        assert!((jerk_for(WAY_M, 10.0) - 316.228).abs() < 1e-3);
        let commanded = commanded(PRINTED).unwrap();
        // The tip of the triangle falls between ticks: half a tick of jerk either side of it.
        let blunt = PRINTED.jerk_m_per_s3 * SAMPLE_S;
        assert!(
            (alone.acceleration_m_per_s2 - blunt..=alone.acceleration_m_per_s2)
                .contains(&commanded.acceleration_m_per_s2),
            "{commanded:?}"
        );
        assert!((commanded.speed_m_per_s - alone.speed_m_per_s).abs() < blunt * SAMPLE_S * 2.0);
        assert!((commanded.jerk_m_per_s3 / PRINTED.jerk_m_per_s3 - 1.0).abs() < 1e-3);
        // A higher speed changes nothing, a higher jerk does.
        assert_eq!(super::commanded(Limits { speed_m_per_s: 1.0, ..PRINTED }).unwrap(), commanded);
        let harder = super::commanded(Limits { jerk_m_per_s3: 330.0, ..PRINTED }).unwrap();
        assert!((harder.acceleration_m_per_s2 - 10.0).abs() < 0.01);
    }

    /// A parabola has its second derivative everywhere, a cubic too at the middle of the window.
    #[test]
    fn the_acceleration_of_a_polynomial_is_exact() {
        let time = |i: usize| i as f64 * SAMPLE_S;
        let places: Vec<f64> = (0..100).map(|i| 3.0 * time(i).powi(2) - 20.0 * time(i).powi(3)).collect();
        let found = accelerations(&places);
        assert!(found[..HALF_WINDOW].iter().all(|a| *a == 0.0));
        for (i, found) in found.iter().enumerate().take(100 - HALF_WINDOW).skip(HALF_WINDOW) {
            assert!((found - (6.0 - 120.0 * time(i))).abs() < 1e-6, "{i}: {found}");
        }
    }
}
