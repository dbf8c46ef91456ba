//! The circular test as ISO 230-4 evaluates it: one lap in each direction, held against the least-squares circle.
//!
//! The radial deviation of a lap is r(θ) = hypot(x, y) − R. The least-squares circle of small deviations is
//! c + a·cos θ + b·sin θ: what is left behind it has no share of centre and radius.
//!
//! - Circular deviation G (ISO 230-4, 3.4): range of one lap about its own least-squares circle.
//! - Circular hysteresis H (3.3): greatest radial distance between the laps of both directions.
//! - Reversal value B: how far an axis stands apart at one place for its two directions of approach. ISO 230-2
//!   measures it on a line; on the circle the axis is approached in + by one lap and in − by the other, on either side
//!   of its reversal. There the laps are apart by B·cos δ + C·sin δ + D·sin 2δ, δ the angle from the reversal, C the
//!   other axis's share and D that of an oval which turns with the direction. They are fitted on either side of the
//!   axis's two reversals, far enough away for the reversal itself to be over.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Matrix3, Vector3};

/// Points of a lap: every tenth of a degree.
pub const POINTS: usize = 3600;

/// Where the reversal value is read: degrees from the reversal of the axis.
const READ_DEGREES: (usize, usize) = (3, 20);

/// Radial deviations of one lap.
#[derive(Clone, Debug, PartialEq)]
pub struct Lap {
    /// Outwards, µm, at each of [`POINTS`] equal angles from 0; least-squares circle taken off.
    pub deviation_um: Vec<f64>,
}

impl Lap {
    /// A lap through points of the actual path, m, about the origin, which may go round more than once or in any
    /// sense. `None` where there are none, or not numbers.
    #[must_use]
    pub fn of(path_m: &[[f64; 2]], radius_m: f64) -> Option<Self> {
        let polar = |[x, y]: &[f64; 2]| (y.atan2(*x).rem_euclid(TAU), 1e6 * (x.hypot(*y) - radius_m));
        let mut points: Vec<(f64, f64)> = path_m.iter().map(polar).collect();
        if points.is_empty() || points.iter().any(|(angle, um)| !(angle + um).is_finite()) {
            return None;
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (first, last) = (points[0], points[points.len() - 1]);
        points.push((first.0 + TAU, first.1));
        points.insert(0, (last.0 - TAU, last.1));
        Some(Self::from_deviations((0..POINTS).map(|i| between(&points, angle(i))).collect()))
    }

    /// A lap of radial deviations, µm, at each of [`POINTS`] angles.
    fn from_deviations(mut deviation_um: Vec<f64>) -> Self {
        let mean = |weight: fn(f64) -> f64| {
            let weighted = deviation_um.iter().enumerate().map(|(i, um)| um * weight(angle(i)));
            numerics::mean(weighted)
        };
        let (c, a, b) = (mean(|_| 1.0), 2.0 * mean(f64::cos), 2.0 * mean(f64::sin));
        for (i, um) in deviation_um.iter_mut().enumerate() {
            let (sin, cos) = angle(i).sin_cos();
            *um -= c + a * cos + b * sin;
        }
        Self { deviation_um }
    }

    /// G, µm.
    #[must_use]
    pub fn circular_deviation_um(&self) -> f64 {
        numerics::peak_to_peak(self.deviation_um.iter().copied())
    }

    /// Share (0 to 1) of the deviation's mean square that an oval, the second harmonic, makes.
    #[must_use]
    pub fn oval_share(&self) -> f64 {
        let sum = |weight: fn(f64) -> f64| {
            self.deviation_um.iter().enumerate().map(|(i, um)| um * weight(2.0 * angle(i))).sum::<f64>()
        };
        let square = self.deviation_um.iter().map(|um| um * um).sum::<f64>();
        2.0 / POINTS as f64 * (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / square
    }

    /// Angle, rad, from 0 to 2π, of the greatest deviation of either sign.
    #[must_use]
    pub fn greatest_rad(&self) -> f64 {
        let um = |i: &usize| self.deviation_um[*i].abs();
        angle((0..POINTS).max_by(|i, j| um(i).total_cmp(&um(j))).unwrap_or(0))
    }

    /// Angle, rad, from 0 to 2π, in the middle of the steepest change within two degrees.
    #[must_use]
    pub fn jump_rad(&self) -> f64 {
        const REACH: usize = POINTS / 360;
        let change = |i: usize| {
            let at = |i: usize| self.deviation_um[i % POINTS];
            (at(i + REACH) - at(i + POINTS - REACH)).abs()
        };
        angle((0..POINTS).max_by(|&i, &j| change(i).total_cmp(&change(j))).unwrap_or(0))
    }

    /// Points of angle (rad) and deviation (µm), closed, for a picture.
    #[must_use]
    pub fn outline(&self) -> Vec<(f64, f64)> {
        // Half a degree is a pixel and less.
        (0..=POINTS).step_by(5).map(|i| (angle(i), self.deviation_um[i % POINTS])).collect()
    }
}

/// Both directions.
#[derive(Clone, Debug, PartialEq)]
pub struct Ballbar {
    /// Counter-clockwise: from the first axis's + to the second's.
    pub positive: Lap,
    /// Clockwise.
    pub negative: Lap,
}

impl Ballbar {
    /// G of the worse direction, µm.
    #[must_use]
    pub fn circular_deviation_um(&self) -> f64 {
        self.positive.circular_deviation_um().max(self.negative.circular_deviation_um())
    }

    /// H, µm.
    #[must_use]
    pub fn hysteresis_um(&self) -> f64 {
        numerics::max_abs((0..POINTS).map(|i| self.apart_um(i)))
    }

    /// B of both axes, µm; positive where an axis falls short in either direction: lost motion.
    #[must_use]
    pub fn reversal_um(&self) -> [f64; 2] {
        // After the first axis's reversal at 0 the counter-clockwise lap moves it towards −, from where it had fallen
        // short in + it is then too far out; before the reversal it is the clockwise lap.
        [0, POINTS / 4].map(|axis| {
            let crossings = [axis, axis + POINTS / 2];
            let apart = |at| self.beside(at, true) - self.beside(at, false);
            crossings.into_iter().map(apart).sum::<f64>() / 4.0
        })
    }

    /// Distance of the laps at a crossing, µm, continued from what lies behind it, or before it.
    fn beside(&self, crossing: usize, is_behind: bool) -> f64 {
        let (from, to) = READ_DEGREES;
        let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for step in from * POINTS / 360..=to * POINTS / 360 {
            let at = if is_behind { crossing + step } else { crossing + POINTS - step };
            let (sin, cos) = angle(step).sin_cos();
            let row = Vector3::new(cos, sin, 2.0 * sin * cos);
            normal += row * row.transpose();
            right += row * self.apart_um(at % POINTS);
        }
        normal.lu().solve(&right).map_or(f64::NAN, |fit| fit[0])
    }

    fn apart_um(&self, at: usize) -> f64 {
        self.positive.deviation_um[at] - self.negative.deviation_um[at]
    }
}

/// Of a point of a lap, rad.
fn angle(point: usize) -> f64 {
    TAU * point as f64 / POINTS as f64
}

/// Angle, rad, from the nearest crossing of an axis: 0 on an axis, π/4 on a diagonal.
#[must_use]
pub fn from_axis_rad(angle_rad: f64) -> f64 {
    let within = angle_rad.rem_euclid(FRAC_PI_2);
    within.min(FRAC_PI_2 - within)
}

/// Linear between sorted points, which lie on both sides of `at`.
fn between(points: &[(f64, f64)], at: f64) -> f64 {
    let above = points.partition_point(|point| point.0 < at).clamp(1, points.len() - 1);
    let ((from, low), (to, high)) = (points[above - 1], points[above]);
    if to > from { low + (at - from) / (to - from) * (high - low) } else { low }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIUS_M: f64 = 0.1;

    /// A lap whose radial deviation at an angle is given, µm, off its centre by (3, −2) µm.
    fn lap(of_angle: impl Fn(f64) -> f64) -> Lap {
        let point = |i: i32| {
            let angle = f64::from(i) * TAU / 7001.0;
            let r = RADIUS_M + 1e-6 * of_angle(angle);
            [r * angle.cos() + 3e-6, r * angle.sin() - 2e-6]
        };
        Lap::of(&(0..7001).map(point).collect::<Vec<_>>(), RADIUS_M).unwrap()
    }

    #[test]
    fn centre_and_radius_are_no_deviation() {
        // Of the shift e the circle is left e²/2R = 7e-5 µm.
        assert!(lap(|_| 5.0).circular_deviation_um() < 2e-4);
        let oval = lap(|angle| 5.0 + 2.0 * (2.0 * angle).sin());
        assert!((oval.circular_deviation_um() - 4.0).abs() < 1e-3);
        assert!((oval.oval_share() - 1.0).abs() < 1e-5);
        assert!(lap(|angle| (3.0 * angle).sin()).oval_share() < 1e-6);
        let top = lap(|angle| (3.0 * (angle - 1.0)).cos() + (2.0 * (angle - 1.0)).cos()).greatest_rad();
        assert!((top - 1.0).abs() < 0.002, "{top}");
        assert_eq!(Lap::of(&[], RADIUS_M), None);
        assert_eq!(Lap::of(&[[f64::NAN, 0.0]], RADIUS_M), None);
    }

    /// Lost motions of 4 µm on the first and 1 µm on the second axis, each half to either side: half·cos θ against the
    /// velocity. B is 4 and 1, whatever the other axis does, and H is the larger, next to its axis.
    #[test]
    fn reversal_values_of_the_axes_are_told_apart() {
        let direction = |sense: f64| {
            lap(move |a| {
                2.0 * (sense * a.sin()).signum() * a.cos() - 0.5 * (sense * a.cos()).signum() * a.sin()
            })
        };
        let ballbar = Ballbar { positive: direction(1.0), negative: direction(-1.0) };
        let [x, y] = ballbar.reversal_um();
        assert!((x - 4.0).abs() < 0.01 && (y - 1.0).abs() < 0.01, "{x} {y}");
        assert!((ballbar.hysteresis_um() - 4.0).abs() < 0.05, "{}", ballbar.hysteresis_um());
        let jump = from_axis_rad(ballbar.positive.jump_rad()).to_degrees();
        assert!(jump < 1.0, "{jump}");
    }

    /// What both directions share is no reversal value; nor is an oval that turns with the direction.
    #[test]
    fn ovals_have_no_reversal_value() {
        for turned in [1.0, -1.0] {
            let oval = |sense: f64| lap(move |angle| 5.0 * sense * (2.0 * angle).sin());
            let ballbar = Ballbar { positive: oval(1.0), negative: oval(turned) };
            let [x, y] = ballbar.reversal_um();
            assert!(x.abs() < 0.01 && y.abs() < 0.01, "{x} {y}");
        }
    }

    #[test]
    fn angles_from_an_axis() {
        for (degrees, expected) in [(0.0, 0.0), (45.0, 45.0), (100.0, 10.0), (359.0, 1.0), (-3.0, 3.0)] {
            assert!((from_axis_rad(f64::to_radians(degrees)).to_degrees() - expected).abs() < 1e-9);
        }
    }
}
