//! The contributors to the error of a circle that the paper lists, one at a time, at its radius and lower speed.
//!
//! Squareness, backlash and servo mismatch are effects of the machine on the desk, hysteresis and the master–slave
//! changeover paths in closed form (both in [`super::laps`]); stick-slip is the paper's model. What each makes of the
//! circle can be said beforehand, [`Contributor::expected_um`]. The sizes are chosen here: the paper gives none.

use std::f64::consts::FRAC_PI_2;

use super::laps::{POSITION_GAIN_PER_S, SPEED_RAD_PER_S, drawn, lag_um, late_um, on_desk};
use super::table_model::{self, RADIUS_M};
use crate::reproduce::ReproduceError;
use crate::reproduce::ballbar::Ballbar;
use model::effects::{Backlash, Effect, ServoMismatch, Squareness};

/// Something that bends a circle.
#[derive(Clone, Debug, PartialEq)]
pub enum Contributor {
    /// The axes are not at a right angle.
    Squareness {
        /// x for y.
        um_per_m: f64,
    },
    /// A gap in the screw of either axis.
    Backlash {
        /// Total.
        width_um: f64,
    },
    /// Tables that follow the way back later than the way out, by a loop that is closed within some distance from the
    /// reversal: Dahl's friction on an elastic drive.
    Hysteresis {
        /// Between way out and way back.
        width_um: f64,
        /// In which a reversal is over but for 1/e.
        distance_um: f64,
    },
    /// Position gain of X above that of Y.
    ServoMismatch {
        /// How much.
        percent: f64,
    },
    /// The faster axis leads, and the other one follows it late.
    MasterSlaveChangeover {
        /// How late.
        delay_s: f64,
    },
    /// The paper's model of it.
    StickSlip,
}

/// What is shown.
pub const SHOWN: [Contributor; 6] = [
    Contributor::Squareness { um_per_m: 50.0 },
    Contributor::Backlash { width_um: 5.0 },
    Contributor::Hysteresis { width_um: 5.0, distance_um: 30.0 },
    Contributor::ServoMismatch { percent: 0.5 },
    Contributor::MasterSlaveChangeover { delay_s: 1e-4 },
    Contributor::StickSlip,
];

/// Circular deviation and reversal value, µm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// G.
    pub circular_deviation_um: f64,
    /// B of either axis.
    pub reversal_um: f64,
}

impl Contributor {
    /// As a heading.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Squareness { .. } => "Squareness",
            Self::Backlash { .. } => "Backlash",
            Self::Hysteresis { .. } => "Hysteresis",
            Self::ServoMismatch { .. } => "Servo mismatch",
            Self::MasterSlaveChangeover { .. } => "Master–slave changeover",
            Self::StickSlip => "Stick-slip",
        }
    }

    /// What was set, in words.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Squareness { um_per_m } => format!("{um_per_m} µm/m between the axes"),
            Self::Backlash { width_um } => format!("{width_um} µm in either screw"),
            Self::Hysteresis { width_um, distance_um } => {
                format!("{width_um} µm in either axis, closed within {distance_um} µm but for 1/e")
            }
            Self::ServoMismatch { percent } => format!("the position gain of X {percent} % above that of Y"),
            Self::MasterSlaveChangeover { delay_s } => {
                format!("the slower axis follows the faster one {} ms late", 1e3 * delay_s)
            }
            Self::StickSlip => "friction that falls and rises, on elastic drives".to_owned(),
        }
    }

    /// What theory makes of it; none for stick-slip, which is what the paper integrates for.
    ///
    /// - Squareness s, x = s·y: r = (s·R/2)·sin 2θ in both directions.
    /// - Backlash w, half of it against each axis's velocity: r = (w/2)·(cos θ − sin θ) behind each reversal, from w/2
    ///   down to −w/2.
    /// - Hysteresis: the same, long behind the reversal. B is read there; G misses what the loop has not yet closed
    ///   where the other axis takes over, and is not more than w.
    /// - Servo mismatch: X lags by 1/Kx and Y by 1/Ky, r = (v/2)·(1/Kx − 1/Ky)·sin 2θ, v the path speed, turned over
    ///   with the direction.
    /// - Changeover: the slower axis is late by T, r = ±(v·T/2)·sin 2θ, with the sign of the octant: it jumps by v·T on
    ///   each diagonal.
    #[must_use]
    pub fn expected_um(&self) -> Option<Size> {
        let path_speed_um_per_s = 1e6 * RADIUS_M * SPEED_RAD_PER_S;
        let size = |circular_deviation_um, reversal_um| Some(Size { circular_deviation_um, reversal_um });
        match *self {
            Self::Squareness { um_per_m } => size(um_per_m * RADIUS_M, 0.0),
            Self::Backlash { width_um } | Self::Hysteresis { width_um, .. } => size(width_um, width_um),
            Self::ServoMismatch { percent } => {
                let slower_s = 1.0 / POSITION_GAIN_PER_S;
                size(path_speed_um_per_s * (slower_s - slower_s / (1.0 + 0.01 * percent)), 0.0)
            }
            Self::MasterSlaveChangeover { delay_s } => size(path_speed_um_per_s * delay_s, 0.0),
            Self::StickSlip => None,
        }
    }

    /// The circle with it, in both directions.
    ///
    /// # Errors
    /// When a loop does not hold or an integration fails.
    pub fn ballbar(&self) -> Result<Ballbar, ReproduceError> {
        match *self {
            Self::Squareness { um_per_m } => {
                on_desk([vec![Effect::Squareness(Squareness { um_per_m })], vec![]])
            }
            Self::Backlash { width_um } => {
                on_desk([(); 2].map(|()| vec![Effect::Backlash(Backlash { width_um })]))
            }
            Self::ServoMismatch { percent } => {
                on_desk([vec![Effect::ServoMismatch(ServoMismatch { percent })], vec![]])
            }
            Self::Hysteresis { width_um, distance_um } => drawn(|angle, sense| {
                [angle, angle - FRAC_PI_2].map(|from| lag_um(from, sense, width_um, distance_um))
            }),
            Self::MasterSlaveChangeover { delay_s } => drawn(|angle, sense| late_um(angle, sense, delay_s)),
            Self::StickSlip => table_model::ballbar(SPEED_RAD_PER_S),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::ballbar::Lap;

    /// Each has the size that theory gives it. Backlash misses the angle √(2w/R) = 10 mrad in which a gap is crossed,
    /// half of it in G. At λ = 30 µm, 1 % of a hysteresis is open at 3°, and G is w·(½ + (½ − e^(−s/λ))·(1 − δ)) with
    /// s = R·δ²/2 at its greatest, δ ≈ 3.4°: 0.96·w.
    #[test]
    fn each_has_the_size_that_theory_gives_it() {
        for contributor in &SHOWN {
            let Some(expected) = contributor.expected_um() else { continue };
            let ballbar = contributor.ballbar().unwrap();
            let g = ballbar.circular_deviation_um();
            let share = if matches!(contributor, Contributor::Hysteresis { .. }) { 0.05 } else { 0.01 };
            assert!((g / expected.circular_deviation_um - 1.0).abs() < share, "{contributor:?}: G {g}");
            for b in ballbar.reversal_um() {
                let off_um = (b - expected.reversal_um).abs();
                assert!(off_um < 0.03 * expected.circular_deviation_um, "{contributor:?}: B {b}");
            }
        }
    }

    /// Radial deviation, µm, at an angle, rad, in a direction, 1 or −1.
    type Shape = fn(f64, f64) -> f64;

    /// The signs and the shapes: r at an angle in both directions, from the formulas of [`Contributor::expected_um`].
    #[test]
    fn each_has_the_shape_that_theory_gives_it() {
        let at = |lap: &Lap, degrees: usize| lap.deviation_um[10 * degrees];
        let shapes: [(usize, Shape); 4] = [
            (0, |angle, _| 2.5 * (2.0 * angle).sin()),
            (1, |angle, sense| {
                2.5 * ((sense * angle.sin()).signum() * angle.cos()
                    - (sense * angle.cos()).signum() * angle.sin())
            }),
            (3, |angle, sense| -sense * 0.5 * 5e4 * (0.02 - 0.02 / 1.005) * (2.0 * angle).sin()),
            (4, |angle, sense| {
                sense * 2.5 * (2.0 * angle).sin() * if angle.tan().abs() < 1.0 { 1.0 } else { -1.0 }
            }),
        ];
        for (index, shape) in shapes {
            let ballbar = SHOWN[index].ballbar().unwrap();
            for degrees in [5, 30, 60, 85, 110, 160, 200, 255, 300, 340] {
                let angle = (degrees as f64).to_radians();
                for (lap, sense) in [(&ballbar.positive, 1.0), (&ballbar.negative, -1.0)] {
                    let off_um = at(lap, degrees) - shape(angle, sense);
                    assert!(off_um.abs() < 0.1, "{:?} at {degrees}, {sense}: {off_um}", SHOWN[index]);
                }
            }
        }
    }
}
