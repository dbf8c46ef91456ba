//! The radial deviation over the angle of a motion that is a circle, for a picture.

use contour::ContourError;
use contour::circle::CircleDeviation;
use motion::{Block, Motion};

/// Parts of a turn: one degree each.
const PARTS: usize = 360;

/// A circle as the tool moved it.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialDeviation {
    /// Names of the two axes.
    pub axes: [String; 2],
    /// Programmed radius, m.
    pub radius_m: f64,
    /// The directions in which it is full, counter-clockwise first.
    pub laps: Vec<RadialLap>,
}

/// One direction of a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct RadialLap {
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
    /// Angle, rad, and deviation from the programmed circle, µm: of each degree the point that is farthest off, so that no spike is lost.
    pub points: Vec<(f64, f64)>,
}

impl RadialDeviation {
    /// The largest full circle of a contour error; `None` without one.
    #[must_use]
    pub fn of(error: &ContourError, axes: &[String]) -> Option<Self> {
        let circle = error.largest_circle()?;
        let name = |axis: usize| axes.get(axis).cloned().unwrap_or_default();
        Some(Self { axes: circle.plane.map(name), radius_m: circle.radius, laps: laps(circle) })
    }

    /// The greatest deviation in either direction, µm.
    #[must_use]
    pub fn greatest_um(&self) -> f64 {
        let points = self.laps.iter().flat_map(|lap| &lap.points);
        points.map(|point| point.1.abs()).fold(0.0, f64::max)
    }
}

/// Whether a motion moves along arcs alone.
pub(crate) fn is_circle(motion: &Motion) -> bool {
    let is_arc = |block: &Block| matches!(block, Block::Arc { .. });
    motion.blocks.iter().any(is_arc)
        && motion.blocks.iter().all(|block| is_arc(block) || matches!(block, Block::Dwell { .. }))
}

fn laps(circle: &CircleDeviation) -> Vec<RadialLap> {
    let of = |lap: &contour::circle::LapDeviation| RadialLap {
        is_clockwise: lap.is_clockwise,
        points: farthest(&lap.points),
    };
    circle.laps.iter().map(of).collect()
}

/// Of each part of a turn, the point that is farthest off; the angles are in ascending order.
fn farthest(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let part = |angle: f64| (angle / std::f64::consts::TAU * PARTS as f64).floor();
    points
        .chunk_by(|a, b| (part(a.0) - part(b.0)).abs() < 0.5)
        .filter_map(|part| part.iter().copied().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn every_degree_keeps_its_farthest_point() {
        let at = |i: u32| {
            (TAU * (f64::from(i) + 0.5) / 1440.0, if i == 777 { -9.0 } else { 0.001 * f64::from(i % 4) })
        };
        let points: Vec<(f64, f64)> = (0..1440).map(at).collect();
        let kept = farthest(&points);
        assert_eq!(kept.len(), PARTS);
        assert!(kept.contains(&points[777]), "the spike");
        assert_eq!(kept.iter().filter(|point| point.1 > 0.0025).count(), PARTS - 1);
        assert!(kept.is_sorted_by(|a, b| a.0 < b.0));
    }
}
