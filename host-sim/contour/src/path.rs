//! The nominal path, from the blocks of a motion or from the command of a log.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::circle_fit;
use super::path_circle::{PathArc, PathCircle};
use super::piece::{Piece, Shape};
use super::vector::{Point, distance, minus, unit};
use motion::{MAX_AXES, PathBlock, PathShape};

/// Smallest distance of two points of a path that is made of the samples of a command, m. Nearer samples are left out;
/// at a corner of 90° the path is then at most 0.05 µm from the command.
const MIN_SPACING_M: f64 = 1e-7;

/// A standstill of the command of at least this duration separates two blocks of a path without a motion file, s.
const MIN_STANDSTILL_S: f64 = 0.05;

/// Largest step of a command at standstill, m: the resolution of the controller's positions.
const STANDSTILL_STEP_M: f64 = 1e-9;

/// The point of a path that is nearest to another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point, m.
    pub point: Point,
    /// Unit vector of the direction of travel.
    pub tangent: Point,
    /// Length of the path up to it, m.
    pub progress_m: f64,
    /// Index of its block.
    pub block: usize,
}

/// An arc from a point: indices of the axes, centre (m) and signed angle (rad).
struct Arc {
    plane: [usize; 2],
    centre: [f64; 2],
    swept_rad: f64,
}

/// Lines and arcs, and the full circles among them.
#[derive(Clone, Debug, PartialEq)]
pub struct NominalPath {
    axes: usize,
    start: Point,
    pieces: Vec<Piece>,
    blocks: usize,
    circles: Vec<PathCircle>,
}

impl NominalPath {
    /// The path of a motion: its start (m, one position per axis, at most three) and its blocks. The rounding of corners
    /// within their tolerance is not part of it.
    #[must_use]
    pub fn of_blocks(start_m: &[f64], blocks: &[PathBlock]) -> Self {
        let mut path = Self::empty(point(start_m), start_m.len());
        let mut at = path.start;
        for (index, block) in blocks.iter().enumerate() {
            at = match &block.shape {
                PathShape::Dwell { .. } => at,
                PathShape::Line { to_m } => path.push_line(at, point(to_m), index),
                PathShape::Arc { plane, centre_m, turns } => {
                    let plane = plane.map(usize::from);
                    path.push_arc(at, &Arc { plane, centre: *centre_m, swept_rad: TAU * turns }, index)
                }
                PathShape::ArcTo { plane, centre_m, to_m, positive } => {
                    let plane = plane.map(usize::from);
                    let angle = |x: f64, y: f64| libm::atan2(y - centre_m[1], x - centre_m[0]);
                    let difference = angle(to_m[0], to_m[1]) - angle(at[plane[0]], at[plane[1]]);
                    let swept =
                        if *positive { difference.rem_euclid(TAU) } else { -(-difference).rem_euclid(TAU) };
                    let arc = Arc { plane, centre: *centre_m, swept_rad: swept };
                    let mut end = path.push_arc(at, &arc, index);
                    (end[plane[0]], end[plane[1]]) = (to_m[0], to_m[1]);
                    end
                }
            };
        }
        path.blocks = blocks.len();
        path
    }

    /// The path through the samples of a command, one vector per axis (m), at most three. A standstill separates two
    /// blocks.
    #[must_use]
    pub fn of_command(command_m: &[Vec<f64>], sample_s: f64) -> Self {
        let samples = command_m.iter().map(Vec::len).min().unwrap_or(0);
        let at = |i: usize| point(&command_m.iter().map(|axis| axis[i]).collect::<Vec<_>>());
        let start = if samples > 0 { at(0) } else { [0.0; 3] };
        let mut path = Self::empty(start, command_m.len());
        let mut progress_m = Vec::with_capacity(samples);
        let (mut last, mut previous, mut still_s, mut block) = (start, start, 0.0, 0);
        for i in 0..samples {
            let command = at(i);
            if distance(&previous, &command) <= STANDSTILL_STEP_M {
                still_s += sample_s;
            } else {
                block += usize::from(still_s >= MIN_STANDSTILL_S && !path.pieces.is_empty());
                still_s = 0.0;
            }
            previous = command;
            if distance(&last, &command) >= MIN_SPACING_M {
                last = path.push_line(last, command, block);
            }
            progress_m.push(path.length_m());
        }
        path.blocks = block + 1;
        path.circles = circles(command_m, &progress_m);
        path
    }

    fn empty(start: Point, axes: usize) -> Self {
        Self { axes, start, pieces: Vec::new(), blocks: 0, circles: Vec::new() }
    }

    fn push_line(&mut self, from: Point, to: Point, block: usize) -> Point {
        let length_m = distance(&from, &to);
        if length_m > 0.0 {
            let shape = Shape::Line { direction: unit(&minus(&to, &from)) };
            self.pieces.push(Piece { from, shape, start_m: self.length_m(), length_m, block });
        }
        to
    }

    /// Pieces of at most a quarter turn; gives the end of the arc.
    fn push_arc(&mut self, from: Point, arc: &Arc, block: usize) -> Point {
        let Arc { plane, centre, swept_rad } = *arc;
        let [dx, dy] = [from[plane[0]] - centre[0], from[plane[1]] - centre[1]];
        let (radius, start_rad, sense) = (libm::hypot(dx, dy), libm::atan2(dy, dx), swept_rad.signum());
        let from_m = self.length_m();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a motion lasts an hour")]
        let count = (swept_rad.abs() / FRAC_PI_2).ceil() as usize;
        let mut at = from;
        for i in 0..count {
            let piece_rad = swept_rad / count as f64;
            let start_rad = start_rad + piece_rad * i as f64;
            let shape = Shape::Arc { plane, centre, radius, start_rad, sense };
            let length_m = radius * piece_rad.abs();
            let piece = Piece { from: at, shape, start_m: self.length_m(), length_m, block };
            at = piece.point(length_m);
            self.pieces.push(piece);
        }
        let arc = PathArc { from_m, to_m: self.length_m(), is_clockwise: swept_rad < 0.0 };
        PathCircle::add(&mut self.circles, PathCircle { plane, centre, radius, arcs: vec![arc] });
        at
    }

    /// Number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.axes
    }

    /// Number of blocks; without a motion file, of motions between standstills.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.blocks
    }

    /// Its arcs, those of the same circle together.
    #[must_use]
    pub fn circles(&self) -> &[PathCircle] {
        &self.circles
    }

    /// Length, m.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.pieces.last().map_or(0.0, Piece::end_m)
    }

    /// Least and greatest position of an axis on the path, m.
    #[must_use]
    pub fn extent_m(&self, axis: usize) -> [f64; 2] {
        // The extreme of a quarter turn that is not at one of its ends is within 0.01 % of the radius of one of these points.
        const POINTS: u32 = 100;
        let along = |piece: &Piece| {
            let of = *piece;
            (0..=POINTS).map(move |k| of.point(of.length_m * f64::from(k) / f64::from(POINTS))[axis])
        };
        let start = self.start[axis];
        numerics::min_max(self.pieces.iter().flat_map(along).chain([start]))
    }

    /// Lengths of the path at the joints of its pieces, m.
    pub(crate) fn joints_m(&self) -> impl Iterator<Item = f64> {
        self.pieces.iter().skip(1).map(|piece| piece.start_m)
    }

    /// The point at a length of the path, m; its start or end beyond them.
    #[must_use]
    pub fn point_at(&self, progress_m: f64) -> Point {
        let index = self.pieces.partition_point(|piece| piece.end_m() < progress_m);
        let piece = self.pieces.get(index).or(self.pieces.last());
        piece.map_or(self.start, |piece| piece.point((progress_m - piece.start_m).clamp(0.0, piece.length_m)))
    }

    /// The point nearest to `point` between two lengths of the path, m; the first of several.
    #[must_use]
    pub fn nearest(&self, point: &Point, from_m: f64, to_m: f64) -> Nearest {
        let to_m = to_m.max(0.0);
        let first = self.pieces.partition_point(|piece| piece.end_m() < from_m);
        let first = first.min(self.pieces.len().saturating_sub(1));
        let within = self.pieces[first..].iter().enumerate();
        let mut best: Option<(f64, Nearest)> = None;
        for (_, piece) in within.take_while(|(i, piece)| *i == 0 || piece.start_m <= to_m) {
            let limit = |progress_m: f64| (progress_m - piece.start_m).clamp(0.0, piece.length_m);
            let along_m = piece.nearest_along(point, limit(from_m), limit(to_m));
            let on_path = piece.point(along_m);
            let distance_m = distance(point, &on_path);
            if best.is_none_or(|(smallest, _)| distance_m < smallest) {
                let nearest = Nearest {
                    point: on_path,
                    tangent: piece.tangent(along_m),
                    progress_m: piece.start_m + along_m,
                    block: piece.block,
                };
                best = Some((distance_m, nearest));
            }
        }
        let at_start = Nearest { point: self.start, tangent: [0.0; 3], progress_m: 0.0, block: 0 };
        best.map_or(at_start, |(_, nearest)| nearest)
    }
}

/// Coordinates of at most three axes.
fn point(axes: &[f64]) -> Point {
    let mut point = [0.0; MAX_AXES];
    point.iter_mut().zip(axes).for_each(|(coordinate, value)| *coordinate = *value);
    point
}

/// The largest circle of the command in each plane of two axes. `progress_m` is the length of the path at each sample.
fn circles(command_m: &[Vec<f64>], progress_m: &[f64]) -> Vec<PathCircle> {
    let pairs = (0..command_m.len()).flat_map(|x| (x + 1..command_m.len()).map(move |y| [x, y]));
    let find = |plane: [usize; 2]| {
        let circle = circle_fit::find(&command_m[plane[0]], &command_m[plane[1]])?;
        let arcs = circle.arcs.iter().map(|arc| PathArc {
            from_m: progress_m[arc.samples.start],
            to_m: progress_m[arc.samples.end - 1],
            is_clockwise: arc.is_clockwise,
        });
        Some(PathCircle { plane, centre: circle.centre, radius: circle.radius, arcs: arcs.collect() })
    };
    pairs.filter_map(find).collect()
}
