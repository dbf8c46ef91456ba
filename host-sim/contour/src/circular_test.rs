//! Evaluation of a circular test after ISO 230-4: one lap in each direction, about the least-squares circle.
//!
//! Radial deviation of a lap: r(θ) = hypot(x, y) − R. For small deviations the least-squares circle is
//! c + a·cos θ + b·sin θ; it is subtracted, which removes the effect of centre and radius.
//!
//! - Circular deviation G (ISO 230-4, 3.4): range of r over one lap.
//! - Bidirectional circular deviation G(b): range of r over both laps about one least-squares circle for both.
//! - Circular hysteresis H (ISO 230-4, 3.3): maximum radial difference between the laps of both directions.
//! - Reversal value B (ISO 230-2): difference of an axis' position at one point between the two directions of
//!   approach. On a circle one lap passes the point in + and the other in −, on either side of the axis' reversal.
//!   There the laps differ by B·cos δ + C·sin δ + D·sin 2δ, with δ the angle from the reversal, C the contribution
//!   of the other axis, and D that of an oval which changes sign with the direction. The three are fitted on either
//!   side of both reversals, beyond the angle in which the reversal itself takes place.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Matrix3, Vector3};

/// Points per lap, 0.1° apart.
pub const POINTS: usize = 3600;

/// Angles from a reversal between which the reversal value is fitted, degrees.
const FIT_DEGREES: (usize, usize) = (3, 20);

/// Radial deviation over one lap.
#[derive(Clone, Debug, PartialEq)]
pub struct Lap {
    /// Radial deviation from the least-squares circle, µm, positive outwards, at [`POINTS`] equally spaced angles
    /// from 0.
    pub deviation_um: Vec<f64>,
    /// The subtracted circle: change of the radius and coordinates of the centre, µm.
    pub circle_um: [f64; 3],
}

impl Lap {
    /// A lap through points of the actual path about the origin, m. The path may cover more than one turn, in either
    /// direction. `None` if there are no points, or a coordinate is not finite.
    #[must_use]
    pub fn from_path(path_m: &[[f64; 2]], radius_m: f64) -> Option<Self> {
        let polar = |[x, y]: &[f64; 2]| (libm::atan2(*y, *x), 1e6 * (libm::hypot(*x, *y) - radius_m));
        Self::from_polar(path_m.iter().map(polar).collect())
    }

    /// A lap through points of angle (rad) and radial deviation (µm), in any order. `None` as for [`Lap::from_path`].
    #[must_use]
    pub fn from_polar(mut points: Vec<(f64, f64)>) -> Option<Self> {
        if points.is_empty() || points.iter().any(|(angle, um)| !(angle + um).is_finite()) {
            return None;
        }
        for (angle, _) in &mut points {
            *angle = angle.rem_euclid(TAU);
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first, last) = (points[0], points[points.len() - 1]);
        points.push((first.0 + TAU, first.1));
        points.insert(0, (last.0 - TAU, last.1));
        Some(Self::from_deviations((0..POINTS).map(|i| interpolate(&points, angle_rad(i))).collect()))
    }

    /// Subtracts the least-squares circle from radial deviations, µm, at the [`POINTS`] angles.
    fn from_deviations(mut deviation_um: Vec<f64>) -> Self {
        let mean = |weight: fn(f64) -> f64| {
            let weighted = deviation_um.iter().enumerate().map(|(i, um)| um * weight(angle_rad(i)));
            numerics::mean(weighted)
        };
        let (c, a, b) = (mean(|_| 1.0), 2.0 * mean(libm::cos), 2.0 * mean(libm::sin));
        for (i, um) in deviation_um.iter_mut().enumerate() {
            *um -= radial_um([c, a, b], i);
        }
        Self { deviation_um, circle_um: [c, a, b] }
    }

    /// Radial deviation from the programmed circle at the [`POINTS`] angles, µm.
    fn about_programmed_um(&self) -> impl Iterator<Item = f64> {
        self.deviation_um.iter().enumerate().map(|(i, um)| um + radial_um(self.circle_um, i))
    }

    /// Circular deviation G, µm.
    #[must_use]
    pub fn circular_deviation_um(&self) -> f64 {
        numerics::peak_to_peak(self.deviation_um.iter().copied())
    }

    /// Fraction, 0 to 1, of the deviation's mean square that lies in the second harmonic (an oval).
    #[must_use]
    pub fn oval_fraction(&self) -> f64 {
        let sum = |weight: fn(f64) -> f64| {
            self.deviation_um.iter().enumerate().map(|(i, um)| um * weight(2.0 * angle_rad(i))).sum::<f64>()
        };
        let square = self.deviation_um.iter().map(|um| um * um).sum::<f64>();
        2.0 / POINTS as f64 * (sum(libm::cos).powi(2) + sum(libm::sin).powi(2)) / square
    }

    /// Angle of the maximum absolute deviation, rad, 0 to 2π.
    #[must_use]
    pub fn max_deviation_rad(&self) -> f64 {
        let um = |i: &usize| self.deviation_um[*i].abs();
        angle_rad((0..POINTS).max_by(|i, j| um(i).total_cmp(&um(j))).unwrap_or(0))
    }

    /// Angle, rad, 0 to 2π, in the middle of the two degrees over which the deviation changes most.
    #[must_use]
    pub fn max_change_rad(&self) -> f64 {
        const HALF_SPAN: usize = POINTS / 360;
        let change = |i: usize| {
            let at = |i: usize| self.deviation_um[i % POINTS];
            (at(i + HALF_SPAN) - at(i + POINTS - HALF_SPAN)).abs()
        };
        angle_rad((0..POINTS).max_by(|&i, &j| change(i).total_cmp(&change(j))).unwrap_or(0))
    }

    /// Points of angle (rad) and deviation (µm) for a polar plot, closed.
    #[must_use]
    pub fn polar_points(&self) -> Vec<(f64, f64)> {
        // Every 0.5°: about one pixel.
        (0..=POINTS).step_by(5).map(|i| (angle_rad(i), self.deviation_um[i % POINTS])).collect()
    }
}

/// A circular test: one lap in each direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Ballbar {
    /// Counter-clockwise: from + of the first axis to + of the second.
    pub positive: Lap,
    /// Clockwise.
    pub negative: Lap,
}

impl Ballbar {
    /// Circular deviation G of the worse direction, µm.
    #[must_use]
    pub fn circular_deviation_um(&self) -> f64 {
        self.positive.circular_deviation_um().max(self.negative.circular_deviation_um())
    }

    /// Bidirectional circular deviation G(b), µm.
    #[must_use]
    pub fn bidirectional_deviation_um(&self) -> f64 {
        let laps = [&self.positive, &self.negative];
        // Both laps have the same angles: their common least-squares circle is the mean of both.
        let common = [0, 1, 2].map(|k| 0.5 * (laps[0].circle_um[k] + laps[1].circle_um[k]));
        let about_common = |lap: &Lap| {
            lap.about_programmed_um().enumerate().map(|(i, um)| um - radial_um(common, i)).collect()
        };
        numerics::peak_to_peak(laps.into_iter().flat_map(|lap| -> Vec<f64> { about_common(lap) }))
    }

    /// Circular hysteresis H, µm.
    #[must_use]
    pub fn hysteresis_um(&self) -> f64 {
        numerics::max_abs((0..POINTS).map(|i| self.difference_um(i)))
    }

    /// Reversal value B of both axes, µm; positive if the axis falls short in both directions (lost motion).
    #[must_use]
    pub fn reversal_um(&self) -> [f64; 2] {
        // Counter-clockwise, the first axis moves in − after its reversal at 0. If it fell short in +, it is then too
        // far out. Clockwise, the same holds before the reversal.
        [0, POINTS / 4].map(|axis| {
            let reversals = [axis, axis + POINTS / 2];
            let step = |at| self.fitted_difference_um(at, true) - self.fitted_difference_um(at, false);
            reversals.into_iter().map(step).sum::<f64>() / 4.0
        })
    }

    /// Difference of the laps extrapolated to a reversal, µm, from the angles after it or before it.
    fn fitted_difference_um(&self, reversal: usize, is_after: bool) -> f64 {
        let (from, to) = FIT_DEGREES;
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for step in from * POINTS / 360..=to * POINTS / 360 {
            let at = if is_after { reversal + step } else { reversal + POINTS - step };
            let (sin, cos) = libm::sincos(angle_rad(step));
            let row = Vector3::new(cos, sin, 2.0 * sin * cos);
            normal += row * row.transpose();
            right += row * self.difference_um(at % POINTS);
        }
        normal.lu().solve(&right).map_or(f64::NAN, |fit| fit[0])
    }

    /// Counter-clockwise minus clockwise, µm.
    fn difference_um(&self, point: usize) -> f64 {
        self.positive.deviation_um[point] - self.negative.deviation_um[point]
    }
}

/// Radial deviation of a circle of [`Lap::circle_um`] at a point of a lap, µm.
fn radial_um([c, a, b]: [f64; 3], point: usize) -> f64 {
    let (sin, cos) = libm::sincos(angle_rad(point));
    c + a * cos + b * sin
}

/// Angle of a point of a lap, rad.
fn angle_rad(point: usize) -> f64 {
    TAU * point as f64 / POINTS as f64
}

/// Angle to the nearest axis, rad: 0 on an axis, π/4 on a diagonal.
#[must_use]
pub fn to_axis_rad(angle_rad: f64) -> f64 {
    let within = angle_rad.rem_euclid(FRAC_PI_2);
    within.min(FRAC_PI_2 - within)
}

/// Linear interpolation in points sorted by abscissa, which enclose `at`.
fn interpolate(points: &[(f64, f64)], at: f64) -> f64 {
    let above = points.partition_point(|point| point.0 < at).clamp(1, points.len() - 1);
    let ((from, low), (to, high)) = (points[above - 1], points[above]);
    if to > from { low + (at - from) / (to - from) * (high - low) } else { low }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.1;

    /// A lap with the given radial deviation (µm) over the angle (rad), its centre shifted by (3, −2) µm.
    fn lap(of_angle: impl Fn(f64) -> f64) -> Lap {
        let point = |i: i32| {
            let angle = f64::from(i) * TAU / 7001.0;
            let r = RADIUS_M + 1e-6 * of_angle(angle);
            [r * angle.cos() + 3e-6, r * angle.sin() - 2e-6]
        };
        Lap::from_path(&(0..7001).map(point).collect::<Vec<_>>(), RADIUS_M).unwrap()
    }

    #[test]
    fn centre_and_radius_are_removed() {
        // A shift e leaves e²/2R = 7e-5 µm.
        assert!(lap(|_| 5.0).circular_deviation_um() < 2e-4);
        let oval = lap(|angle| 5.0 + 2.0 * (2.0 * angle).sin());
        assert!((oval.circular_deviation_um() - 4.0).abs() < 1e-3);
        assert!((oval.oval_fraction() - 1.0).abs() < 1e-5);
        assert!(lap(|angle| (3.0 * angle).sin()).oval_fraction() < 1e-6);
        let peak = lap(|angle| (3.0 * (angle - 1.0)).cos() + (2.0 * (angle - 1.0)).cos()).max_deviation_rad();
        assert!((peak - 1.0).abs() < 0.002, "{peak}");
        assert!(Lap::from_path(&[], RADIUS_M).is_none());
        assert!(Lap::from_path(&[[f64::NAN, 0.0]], RADIUS_M).is_none());
    }

    /// Lost motion w of 4 µm on the first axis and 1 µm on the second, r = (w/2)·cos θ against the velocity. B is 4
    /// and 1, independent of the other axis; H is the larger of the two, next to its axis.
    #[test]
    fn reversal_values_of_the_axes_are_separated() {
        let direction = |sense: f64| {
            lap(move |a| {
                2.0 * (sense * a.sin()).signum() * a.cos() - 0.5 * (sense * a.cos()).signum() * a.sin()
            })
        };
        let ballbar = Ballbar { positive: direction(1.0), negative: direction(-1.0) };
        let [x, y] = ballbar.reversal_um();
        assert!((x - 4.0).abs() < 0.01 && (y - 1.0).abs() < 0.01, "{x} {y}");
        assert!((ballbar.hysteresis_um() - 4.0).abs() < 0.05, "{}", ballbar.hysteresis_um());
        let jump = to_axis_rad(ballbar.positive.max_change_rad()).to_degrees();
        assert!(jump < 1.0, "{jump}");
    }

    /// Laps of cos 2θ in one direction and −cos 2θ in the other have G = 2 µm each, and 2 µm in common. Radii that differ by
    /// 3 µm add to the common range only: 2 + 3 µm.
    #[test]
    fn the_bidirectional_deviation_contains_the_difference_of_the_radii() {
        let direction = |sign: f64, c: f64| lap(move |angle| c + sign * (2.0 * angle).cos());
        for (difference, expected) in [(0.0, 2.0), (3.0, 5.0), (-3.0, 5.0)] {
            let ballbar = Ballbar { positive: direction(1.0, difference), negative: direction(-1.0, 0.0) };
            assert!((ballbar.circular_deviation_um() - 2.0).abs() < 1e-3);
            let both = ballbar.bidirectional_deviation_um();
            assert!((both - expected).abs() < 1e-3, "{difference}: {both}");
        }
    }

    /// A deviation common to both directions gives no reversal value, nor does an oval that changes sign with the
    /// direction.
    #[test]
    fn an_oval_has_no_reversal_value() {
        for sign in [1.0, -1.0] {
            let oval = |sense: f64| lap(move |angle| 5.0 * sense * (2.0 * angle).sin());
            let ballbar = Ballbar { positive: oval(1.0), negative: oval(sign) };
            let [x, y] = ballbar.reversal_um();
            assert!(x.abs() < 0.01 && y.abs() < 0.01, "{x} {y}");
        }
    }

    #[test]
    fn angles_to_the_nearest_axis() {
        for (degrees, expected) in [(0.0, 0.0), (45.0, 45.0), (100.0, 10.0), (359.0, 1.0), (-3.0, 3.0)] {
            assert!((to_axis_rad(f64::to_radians(degrees)).to_degrees() - expected).abs() < 1e-9);
        }
    }
}
