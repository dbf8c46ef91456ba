//! The figures of ISO 230-4 from means over sectors of 0.25°.
//!
//! - F: radial deviation from the nominal circle about the nominal centre, smallest and largest.
//! - G: range of the radial deviation of one direction about the least-squares circle of this direction.
//! - G(b): range over both directions about the least-squares circle of both together.
//! - H: greatest difference of the radial deviations of both directions at one angle, each about its own least-squares circle, as in
//!   `contour::circular_test`.
//!
//! For small deviations the least-squares circle is c + a·cos θ + b·sin θ, fitted to the measured sectors, which may be an arc.

use nalgebra::{Matrix3, Vector3};

use contour::sectors::{SECTORS, Sectors, middle_rad};

use super::samples::Samples;

/// A direction is a full circle from this angle on: the ramps at the start and the end of a turn are not evaluated.
const FULL_DEG: f64 = 345.0;

/// One direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Direction {
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
    /// Angle that was measured, degrees, at most 360.
    pub covered_deg: f64,
    /// Angle swept, in turns.
    pub turns: f64,
    /// Circular deviation G, µm.
    pub circular_um: f64,
    /// Smallest and largest radial deviation F, µm.
    pub radial_um: [f64; 2],
    /// Angle (rad) and radial deviation from the nominal circle (µm).
    pub points: Vec<(f64, f64)>,
    /// Least-squares circle: radius and centre, µm.
    pub circle_um: [f64; 3],
}

/// The figures of a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// The directions that were measured, counter-clockwise first.
    pub directions: Vec<Direction>,
    /// Circular hysteresis H, µm, if both directions were measured.
    pub hysteresis_um: Option<f64>,
    /// Bidirectional circular deviation G(b), µm; `None` with one direction only.
    pub bidirectional_um: Option<f64>,
}

impl Figures {
    /// The figures of samples.
    #[must_use]
    pub fn of(samples: &Samples) -> Self {
        let mut sectors = [Sectors::new(), Sectors::new()];
        for ((angle, um), at) in samples.polar().into_iter().zip(&samples.instants) {
            sectors[usize::from(at.direction < 0.0)].add(angle, um);
        }
        let directions: Vec<Direction> =
            [false, true].into_iter().filter_map(|way| direction(samples, &sectors, way)).collect();
        let [Some(positive), Some(negative)] = [directions.first(), directions.get(1)] else {
            return Self { directions, hysteresis_um: None, bidirectional_um: None };
        };
        let about_own = |direction: &Direction, sector: usize| {
            let um = sectors[usize::from(direction.is_clockwise)].mean_um(sector)?;
            Some(um - radius_um(direction.circle_um, middle_rad(sector)))
        };
        let difference =
            |sector: usize| Some((about_own(positive, sector)? - about_own(negative, sector)?).abs());
        let hysteresis_um = Some(numerics::max_abs((0..SECTORS).filter_map(difference)));
        let both: Vec<(f64, f64)> = positive.points.iter().chain(&negative.points).copied().collect();
        let bidirectional_um = least_squares(&both).map(|circle| range_um(&both, circle));
        Self { directions, hysteresis_um, bidirectional_um }
    }

    /// The larger circular deviation G of the directions, µm.
    #[must_use]
    pub fn circular_um(&self) -> f64 {
        numerics::max(self.directions.iter().map(|direction| direction.circular_um))
    }

    /// The larger circular deviation G of the directions that are full circles, µm; `None` without one.
    #[must_use]
    pub fn full_circular_um(&self) -> Option<f64> {
        let full = self.directions.iter().filter(|direction| direction.covered_deg >= FULL_DEG);
        full.map(|direction| direction.circular_um).reduce(f64::max)
    }

    /// Smallest and largest radial deviation F of the directions, µm.
    #[must_use]
    pub fn radial_um(&self) -> [f64; 2] {
        numerics::min_max(self.directions.iter().flat_map(|direction| direction.radial_um))
    }
}

fn direction(samples: &Samples, sectors: &[Sectors; 2], is_clockwise: bool) -> Option<Direction> {
    let points = sectors[usize::from(is_clockwise)].points();
    let circle_um = least_squares(&points)?;
    let arcs = samples
        .arcs
        .iter()
        .filter(|arc| samples.instants.get(arc.start).is_some_and(|at| (at.direction < 0.0) == is_clockwise));
    let turns = arcs.map(|arc| samples.swept_rad(arc)).sum::<f64>() / std::f64::consts::TAU;
    Some(Direction {
        is_clockwise,
        covered_deg: (360.0 * turns).min(360.0),
        turns,
        circular_um: range_um(&points, circle_um),
        radial_um: numerics::min_max(points.iter().map(|point| point.1)),
        points,
        circle_um,
    })
}

fn range_um(points: &[(f64, f64)], circle: [f64; 3]) -> f64 {
    numerics::peak_to_peak(points.iter().map(|(angle, um)| um - radius_um(circle, *angle)))
}

/// Radial deviation of a circle at an angle, µm.
fn radius_um([c, a, b]: [f64; 3], angle: f64) -> f64 {
    c + a * libm::cos(angle) + b * libm::sin(angle)
}

/// The circle through points of angle and radial deviation, by least squares.
fn least_squares(points: &[(f64, f64)]) -> Option<[f64; 3]> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (angle, um) in points {
        let row = Vector3::new(1.0, libm::cos(*angle), libm::sin(*angle));
        normal += row * row.transpose();
        right += row * *um;
    }
    let circle = normal.lu().solve(&right)?;
    Some([circle[0], circle[1], circle[2]])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use contour::circular_test::{Ballbar, Lap};

    use super::*;
    use crate::samples::{Instant, Observed};

    /// A full circle in both directions with the given radial deviation, µm, by angle and direction.
    fn circle(of: impl Fn(f64, f64) -> f64) -> Samples {
        let steps = 14_400_u32;
        let at = |i: u32| {
            let arc = usize::from(i >= steps);
            let direction = if arc == 0 { 1.0 } else { -1.0 };
            let angle = direction * TAU * (f64::from(i) + 0.5) / f64::from(steps);
            Instant { arc, ..Instant::new(angle, direction) }
        };
        let instants: Vec<Instant> = (0..2 * steps).map(at).collect();
        let radial = instants.iter().map(|at| of(at.angle, at.direction)).collect();
        Samples {
            radius_mm: 100.0,
            speed_mm_s: None,
            sample_s: None,
            instants,
            arcs: vec![0..14_400, 14_400..28_800],
            observed: Observed::Radial(radial),
        }
    }

    /// By hand: 3 + 5·cos θ is a circle, of which F runs from −2 to 8. cos 2θ has a range of 2 µm in each direction. With opposite
    /// signs the difference is 2·cos 2θ, at most 2; ±0.5 of radius adds to the range of both, not to that of one direction, nor to H.
    #[test]
    fn figures_agree_with_the_definitions() {
        let only_circle = Figures::of(&circle(|angle, _| 3.0 + 5.0 * angle.cos()));
        assert!(only_circle.circular_um() < 1e-9);
        let [min, max] = only_circle.radial_um();
        assert!((min + 2.0).abs() < 1e-4 && (max - 8.0).abs() < 1e-4);
        let ovals = Figures::of(&circle(|angle, d| d * (2.0 * angle).cos() + 0.5 * d));
        assert!((ovals.circular_um() - 2.0).abs() < 1e-4);
        assert!((ovals.hysteresis_um.unwrap() - 2.0).abs() < 1e-4);
        assert!((ovals.bidirectional_um.unwrap() - 3.0).abs() < 1e-4);
    }

    /// On full circles the figures are those of `contour::circular_test`, which interpolates between the sectors.
    #[test]
    fn figures_agree_with_the_circular_test_of_contour() {
        let figures = Figures::of(&circle(|angle, d| {
            2.0 * (3.0 * angle + d).sin() + 4.0 * angle.sin() - d * (2.0 * angle).cos()
        }));
        let lap = |i: usize| Lap::from_polar(figures.directions[i].points.clone()).unwrap();
        let ballbar = Ballbar { positive: lap(0), negative: lap(1) };
        assert!((figures.circular_um() - ballbar.circular_deviation_um()).abs() < 1e-3);
        assert!((figures.hysteresis_um.unwrap() - ballbar.hysteresis_um()).abs() < 1e-3);
        assert!((figures.bidirectional_um.unwrap() - ballbar.bidirectional_deviation_um()).abs() < 1e-3);
    }
}
