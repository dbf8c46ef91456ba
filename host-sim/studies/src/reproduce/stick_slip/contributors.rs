//! The contributors to circle error that the paper lists, one at a time, at its radius and lower speed.
//!
//! Squareness, backlash and servo mismatch are effects of the simulated machine ([`super::simulated_circle`]);
//! hysteresis and the master–slave changeover are paths in closed form ([`super::closed_form_circle`]); stick-slip is
//! the paper's model ([`super::table_model`]). [`Contributor::expected_um`] gives the theoretical size of each. The paper
//! prints no sizes; those here are chosen.

use std::f64::consts::FRAC_PI_2;

use super::closed_form_circle::{dahl_lag_um, delay_um, from_axis_errors};
use super::simulated_circle::{POSITION_GAIN_PER_S, SPEED_RAD_PER_S, simulate};
use super::table_model::{self, RADIUS_M};
use crate::reproduce::study::ReproduceError;
use contour::circular_test::Ballbar;
use model::effects::{Backlash, Effect, ServoMismatch, Squareness};

/// A cause of circle error.
#[derive(Clone, Debug, PartialEq)]
pub enum Contributor {
    /// The axes are not perpendicular.
    Squareness {
        /// Displacement of x per displacement of y.
        um_per_m: f64,
    },
    /// Backlash in the screws of both axes.
    Backlash {
        /// Total width.
        width_um: f64,
    },
    /// Dahl friction on an elastic drive: the table position depends on the direction, with an exponential transition
    /// after each reversal.
    Hysteresis {
        /// Difference of the table position between the directions.
        width_um: f64,
        /// Distance from the reversal in which the transition decays to 1/e.
        distance_um: f64,
    },
    /// Position gain of X higher than that of Y.
    ServoMismatch {
        /// Relative difference.
        percent: f64,
    },
    /// The faster axis is the master; the slower one follows it with a delay.
    MasterSlaveChangeover {
        /// Delay of the slower axis.
        delay_s: f64,
    },
    /// The paper's model of stick-slip.
    StickSlip,
}

/// The contributors and sizes that are run.
pub const CONTRIBUTORS: [Contributor; 6] = [
    Contributor::Squareness { um_per_m: 50.0 },
    Contributor::Backlash { width_um: 5.0 },
    Contributor::Hysteresis { width_um: 5.0, distance_um: 30.0 },
    Contributor::ServoMismatch { percent: 0.5 },
    Contributor::MasterSlaveChangeover { delay_s: 1e-4 },
    Contributor::StickSlip,
];

/// Theoretical size of a circle error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedSize {
    /// Circular deviation G, µm.
    pub circular_deviation_um: f64,
    /// Reversal value B of either axis, µm.
    pub reversal_um: f64,
}

impl Contributor {
    /// Name, as a heading.
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

    /// The size that is set, as text.
    #[must_use]
    pub fn description(&self) -> String {
        match self {
            Self::Squareness { um_per_m } => format!("{um_per_m} µm/m between the axes"),
            Self::Backlash { width_um } => format!("{width_um} µm in each screw"),
            Self::Hysteresis { width_um, distance_um } => {
                format!("{width_um} µm in each axis, with a transition to 1/e within {distance_um} µm")
            }
            Self::ServoMismatch { percent } => format!("position gain of X {percent} % above that of Y"),
            Self::MasterSlaveChangeover { delay_s } => {
                format!("the slower axis is delayed by {} ms", 1e3 * delay_s)
            }
            Self::StickSlip => {
                "friction that first falls and then rises with speed, on elastic drives".to_owned()
            }
        }
    }

    /// Theoretical size; `None` for stick-slip, which has no closed form.
    ///
    /// - Squareness s, x = s·y: r = (s·R/2)·sin 2θ in both directions.
    /// - Backlash w, each axis offset by w/2 against its velocity: r = (w/2)·(cos θ − sin θ) after each reversal, falling
    ///   from w/2 to −w/2.
    /// - Hysteresis w: the same, far from the reversal, where B is fitted. G is at most w: the transition is not quite
    ///   complete when the other axis reverses.
    /// - Servo mismatch: X lags by 1/Kx and Y by 1/Ky, r = ∓(v/2)·(1/Kx − 1/Ky)·sin 2θ, with v the path speed; the sign
    ///   changes with the direction.
    /// - Changeover: the slower axis is delayed by T, r = ±(v·T/2)·sin 2θ, with the sign of the octant: a jump of v·T on
    ///   each diagonal.
    #[must_use]
    pub fn expected_um(&self) -> Option<ExpectedSize> {
        let path_speed_um_per_s = 1e6 * RADIUS_M * SPEED_RAD_PER_S;
        let size =
            |circular_deviation_um, reversal_um| Some(ExpectedSize { circular_deviation_um, reversal_um });
        match *self {
            Self::Squareness { um_per_m } => size(um_per_m * RADIUS_M, 0.0),
            Self::Backlash { width_um } | Self::Hysteresis { width_um, .. } => size(width_um, width_um),
            Self::ServoMismatch { percent } => {
                let lag_s = 1.0 / POSITION_GAIN_PER_S;
                size(path_speed_um_per_s * (lag_s - lag_s / (1.0 + 0.01 * percent)), 0.0)
            }
            Self::MasterSlaveChangeover { delay_s } => size(path_speed_um_per_s * delay_s, 0.0),
            Self::StickSlip => None,
        }
    }

    /// The circular test with this contributor alone.
    ///
    /// # Errors
    /// If a simulation or an integration fails.
    pub fn ballbar(&self) -> Result<Ballbar, ReproduceError> {
        match *self {
            Self::Squareness { um_per_m } => {
                simulate([vec![Effect::Squareness(Squareness { um_per_m })], vec![]])
            }
            Self::Backlash { width_um } => {
                simulate([(); 2].map(|()| vec![Effect::Backlash(Backlash { width_um })]))
            }
            Self::ServoMismatch { percent } => {
                simulate([vec![Effect::ServoMismatch(ServoMismatch { percent })], vec![]])
            }
            Self::Hysteresis { width_um, distance_um } => from_axis_errors(|angle, sense| {
                [angle, angle - FRAC_PI_2].map(|from| dahl_lag_um(from, sense, width_um, distance_um))
            }),
            Self::MasterSlaveChangeover { delay_s } => {
                from_axis_errors(|angle, sense| delay_um(angle, sense, delay_s))
            }
            Self::StickSlip => table_model::ballbar(SPEED_RAD_PER_S),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contour::circular_test::Lap;

    /// Sizes against theory. With backlash, the gap is crossed within √(2w/R) = 10 mrad, half of which reduces G. With
    /// λ = 30 µm, 1 % of the hysteresis transition remains at 3°, and G = w·(½ + (½ − e^(−s/λ))·(1 − δ)), s = R·δ²/2,
    /// has its maximum of 0.96·w at δ ≈ 3.4°.
    #[test]
    fn each_has_the_theoretical_size() {
        for contributor in &CONTRIBUTORS {
            let Some(expected) = contributor.expected_um() else { continue };
            let ballbar = contributor.ballbar().unwrap();
            let g = ballbar.circular_deviation_um();
            let tolerance = if matches!(contributor, Contributor::Hysteresis { .. }) { 0.05 } else { 0.01 };
            assert!((g / expected.circular_deviation_um - 1.0).abs() < tolerance, "{contributor:?}: G {g}");
            for b in ballbar.reversal_um() {
                let off_um = (b - expected.reversal_um).abs();
                assert!(off_um < 0.03 * expected.circular_deviation_um, "{contributor:?}: B {b}");
            }
        }
    }

    /// Radial deviation, µm, at an angle, rad, in a direction, 1 or −1.
    type Shape = fn(f64, f64) -> f64;

    /// Signs and shapes: r over the angle in both directions, from the formulas of [`Contributor::expected_um`].
    #[test]
    fn each_has_the_theoretical_shape() {
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
            let ballbar = CONTRIBUTORS[index].ballbar().unwrap();
            for degrees in [5, 30, 60, 85, 110, 160, 200, 255, 300, 340] {
                let angle = (degrees as f64).to_radians();
                for (lap, sense) in [(&ballbar.positive, 1.0), (&ballbar.negative, -1.0)] {
                    let off_um = at(lap, degrees) - shape(angle, sense);
                    assert!(off_um.abs() < 0.1, "{:?} at {degrees}, {sense}: {off_um}", CONTRIBUTORS[index]);
                }
            }
        }
    }
}
