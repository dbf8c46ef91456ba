//! Corners of a path: where they are, and how the tool passes them.

use super::path::{Nearest, NominalPath};
use super::vector::{Point, distance, dot, minus, plus, unit};

/// A corner is a change of direction of more than this angle, rad (20°), over [`SPAN_M`] on either side.
const MIN_TURN_RAD: f64 = 0.35;

/// Lengths of path over which the directions before and after a corner are taken, m. An arc of more than 0.6 mm radius
/// turns by less than [`MIN_TURN_RAD`] over both.
const SPAN_M: f64 = 1e-4;

/// Largest length of path on either side that belongs to a corner, m.
const MAX_REACH_M: f64 = 0.02;

/// Part of the reach, at its end, over which the steady error after the corner is averaged.
const STEADY_FRACTION: f64 = 0.2;

/// Above this angle (rad, 150°) the direction before the corner has hardly a part across the line after it.
const REVERSAL_RAD: f64 = 2.618;

/// A corner of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Position, m.
    pub point: Point,
    /// Length of the path up to it, m.
    pub progress_m: f64,
    /// Change of direction, rad, 0 to π.
    pub turn_rad: f64,
    /// Unit vector to the outer side of the line after the corner; of a reversal, the direction before it.
    outward: Point,
    /// Length of path on either side that belongs to it, m.
    reach_m: f64,
}

impl Corner {
    /// The corners of a path, in its order.
    pub fn all(path: &NominalPath) -> Vec<Self> {
        let mut corners: Vec<Self> = Vec::new();
        for progress_m in path.joints_m() {
            let Some(corner) = Self::at(path, progress_m) else { continue };
            match corners.last_mut() {
                // The samples around a corner are one corner, at the sample with the largest change of direction.
                Some(last) if progress_m - last.progress_m < 2.0 * SPAN_M => {
                    if corner.turn_rad > last.turn_rad {
                        *last = corner;
                    }
                }
                _ => corners.push(corner),
            }
        }
        let positions: Vec<f64> = corners.iter().map(|corner| corner.progress_m).collect();
        for (i, corner) in corners.iter_mut().enumerate() {
            let before = if i > 0 { positions[i - 1] } else { 0.0 };
            let after = positions.get(i + 1).copied().unwrap_or(path.length_m());
            let free_m = (corner.progress_m - before).min(after - corner.progress_m);
            corner.reach_m = MAX_REACH_M.min(0.5 * free_m);
        }
        corners
    }

    fn at(path: &NominalPath, progress_m: f64) -> Option<Self> {
        let point = path.point_at(progress_m);
        let before = unit(&minus(&point, &path.point_at(progress_m - SPAN_M)));
        let after = unit(&minus(&path.point_at(progress_m + SPAN_M), &point));
        let along = dot(&before, &after).clamp(-1.0, 1.0);
        let turn_rad = libm::acos(along);
        let outward = if turn_rad > REVERSAL_RAD { before } else { unit(&plus(&before, -along, &after)) };
        (turn_rad > MIN_TURN_RAD).then_some(Self { point, progress_m, turn_rad, outward, reach_m: 0.0 })
    }
}

/// How the tool passes a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerDeviation {
    /// Position of the corner, m.
    pub point: Point,
    /// Change of direction, rad, 0 to π.
    pub turn_rad: f64,
    /// Largest distance to the outer side of the path after the corner, beyond the steady one if that is on this side, too,
    /// µm; not negative.
    pub overshoot_um: f64,
    /// Smallest distance of the tool from the corner, µm.
    pub rounding_um: f64,
}

/// Running evaluation of one corner.
#[derive(Clone, Debug)]
pub(crate) struct CornerSum {
    corner: Corner,
    outward_max_m: f64,
    steady_m: f64,
    steady_samples: u32,
    smallest_m: f64,
}

impl CornerSum {
    pub fn new(corner: Corner) -> Self {
        Self { corner, outward_max_m: 0.0, steady_m: 0.0, steady_samples: 0, smallest_m: f64::INFINITY }
    }

    /// Adds a position of the tool with its nearest point.
    pub fn add(&mut self, tool: &Point, nearest: &Nearest) {
        let after_m = nearest.progress_m - self.corner.progress_m;
        if after_m.abs() > self.corner.reach_m {
            return;
        }
        self.smallest_m = self.smallest_m.min(distance(tool, &self.corner.point));
        if after_m < 0.0 {
            return;
        }
        let outward_m = dot(&minus(tool, &nearest.point), &self.corner.outward);
        self.outward_max_m = self.outward_max_m.max(outward_m);
        if after_m > (1.0 - STEADY_FRACTION) * self.corner.reach_m {
            self.steady_m += outward_m;
            self.steady_samples += 1;
        }
    }

    /// The result; `None` if the tool was not seen on both parts of the corner.
    pub fn finish(&self) -> Option<CornerDeviation> {
        let steady_m = self.steady_m / f64::from(self.steady_samples);
        (self.steady_samples > 0 && self.smallest_m.is_finite()).then(|| CornerDeviation {
            point: self.corner.point,
            turn_rad: self.corner.turn_rad,
            overshoot_um: 1e6 * (self.outward_max_m - steady_m.max(0.0)).max(0.0),
            rounding_um: 1e6 * self.smallest_m,
        })
    }
}

/// The corners, of all in the order of the path, that a length of the path may belong to.
pub(crate) fn near(corners: &mut [CornerSum], progress_m: f64) -> impl Iterator<Item = &mut CornerSum> {
    let first = corners.partition_point(|sum| sum.corner.progress_m < progress_m - MAX_REACH_M);
    corners[first..].iter_mut().take_while(move |sum| sum.corner.progress_m <= progress_m + MAX_REACH_M)
}
