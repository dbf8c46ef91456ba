//! The motions that are tried: rounds of strokes over the travel.
//!
//! Every round has all strokes, over other parts of the travel: a trace compares parts of a log with each other, and holds the last quarter out of
//! its fits. A part with strokes that no other has would not be described by what the others show. No motion keeps to a part of the travel: there, an
//! error of one place passes for a slope or a wave.

use indexmap::IndexMap;

use crate::limits::{AxisLimits, MotionLimits};
use motion::Lines;

/// A stroke to a position, as fractions of half of the travel, of the speed and of the acceleration, and the standstill after it, s.
type Stroke = ([f64; 3], f64);

/// There and back at full speed.
const STROKES: &[Stroke] = &[([1.0, 1.0, 1.0], 0.1), ([-1.0, 1.0, 1.0], 0.1), ([0.0, 1.0, 1.0], 0.1)];

/// Over a part of the travel, slower each time.
const SLOWER: &[Stroke] = &[
    ([0.6, 0.3, 0.4], 0.0),
    ([-0.6, 0.3, 0.4], 0.1),
    ([-0.45, 0.08, 1.0], 0.0),
    ([-0.6, 0.08, 1.0], 0.0),
    ([0.0, 0.5, 0.7], 0.1),
];

/// In steps over the travel, with reversals at several places.
const STEPS: &[Stroke] = &[
    ([0.7, 0.6, 1.0], 0.0),
    ([0.3, 0.3, 0.6], 0.1),
    ([1.0, 0.45, 1.0], 0.1),
    ([-0.1, 1.0, 1.0], 0.0),
    ([-0.7, 0.6, 0.6], 0.1),
    ([-0.3, 0.3, 1.0], 0.0),
    ([-1.0, 0.8, 1.0], 0.1),
    ([0.0, 0.6, 0.6], 0.1),
];

/// Short and quick, as often as they excite a structure.
const QUICK: &[Stroke] = &[
    ([0.06, 1.0, 1.0], 0.0),
    ([-0.06, 1.0, 1.0], 0.0),
    ([0.06, 1.0, 1.0], 0.0),
    ([-0.03, 1.0, 1.0], 0.0),
    ([0.03, 1.0, 1.0], 0.0),
    ([0.0, 1.0, 1.0], 0.2),
];

/// Parts of the travel in the rounds of a motion.
const ROUNDS: [f64; 4] = [1.0, 0.8, 0.6, 0.9];

/// Strokes that are combined in each round.
struct Pattern {
    name: &'static str,
    parts: &'static [&'static [Stroke]],
    /// Whether all axes move at once, each to another place. Otherwise they move one after the other: what one axis does to another shows
    /// best while the other one stands.
    is_together: bool,
    /// Standstill before the last round, s: what changes with the time and not with the motion.
    pause_s: f64,
}

const PATTERNS: [Pattern; 8] = [
    Pattern { name: "strokes", parts: &[STROKES], is_together: false, pause_s: 0.0 },
    Pattern { name: "strokes", parts: &[STROKES], is_together: true, pause_s: 0.0 },
    Pattern { name: "short quick strokes", parts: &[QUICK], is_together: false, pause_s: 0.0 },
    Pattern {
        name: "strokes and short quick ones",
        parts: &[STROKES, QUICK],
        is_together: false,
        pause_s: 0.0,
    },
    Pattern { name: "steps", parts: &[STEPS], is_together: true, pause_s: 0.0 },
    Pattern {
        name: "strokes at several speeds",
        parts: &[STROKES, SLOWER],
        is_together: false,
        pause_s: 0.0,
    },
    Pattern {
        name: "steps and short quick strokes",
        parts: &[STEPS, QUICK],
        is_together: true,
        pause_s: 0.0,
    },
    Pattern {
        name: "all strokes, with a pause",
        parts: &[STEPS, QUICK, SLOWER],
        is_together: true,
        pause_s: 12.0,
    },
];

/// A motion with its duration.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Its name.
    pub name: String,
    /// The motion.
    pub motion: Lines,
    /// Its duration, s.
    pub seconds: f64,
}

/// The motions within some limits, the shortest first.
#[must_use]
pub fn candidates(limits: &MotionLimits) -> Vec<Candidate> {
    let all = PATTERNS.iter().map(|pattern| pattern.within(limits));
    let mut candidates: Vec<Candidate> =
        all.filter(|one| one.seconds <= limits.time_s && one.motion.motion().is_some()).collect();
    candidates.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    // With one axis, all move alone.
    candidates.dedup_by(|a, b| a.name == b.name);
    candidates
}

impl Pattern {
    fn within(&self, limits: &MotionLimits) -> Candidate {
        let how = if self.is_together && limits.axes.len() > 1 { "diagonal " } else { "" };
        let name = format!("{how}{}", self.name);
        let start_mm: IndexMap<String, f64> =
            limits.axes.iter().map(|axis| (axis.name.clone(), axis.middle_mm)).collect();
        let lines = Lines::begin(&name, start_mm, slowest(&limits.axes));
        let mut timed = Timed { lines, seconds: 0.0 };
        timed.dwell(0.5);
        for (number, round) in ROUNDS.iter().enumerate() {
            if number + 1 == ROUNDS.len() && self.pause_s > 0.0 {
                timed.dwell(self.pause_s);
            }
            for part in self.parts {
                if self.is_together {
                    timed.strokes(&limits.axes, *round, part);
                } else {
                    limits.axes.chunks(1).for_each(|axis| timed.strokes(axis, *round, part));
                }
            }
        }
        Candidate { name, motion: timed.lines, seconds: timed.seconds }
    }
}

impl AxisLimits {
    /// Feed, mm/min, and acceleration, m/s².
    fn pace(&self) -> [f64; 2] {
        [60.0 * self.speed_mm_s, self.acceleration_m_per_s2]
    }
}

/// A motion that is being made, and its duration so far.
struct Timed {
    lines: Lines,
    seconds: f64,
}

impl Timed {
    fn dwell(&mut self, seconds: f64) {
        self.lines.dwell(seconds);
        self.seconds += seconds;
    }

    /// Strokes of axes that move at once, from the middle of their travel and back to it; the path keeps to the limits of each.
    fn strokes(&mut self, axes: &[AxisLimits], span: f64, strokes: &[Stroke]) {
        let [feed, most] = slowest(axes);
        let mut from_mm: Vec<f64> = axes.iter().map(|axis| axis.middle_mm).collect();
        for (number, &([_, speed, acceleration], pause_s)) in strokes.iter().enumerate() {
            let to_mm: Vec<f64> = axes
                .iter()
                .enumerate()
                .map(|(axis, limits)| {
                    limits.middle_mm + span * limits.half_mm * fraction(strokes, number, axis)
                })
                .collect();
            let named = axes.iter().zip(&to_mm).map(|(axis, mm)| (axis.name.as_str(), *mm));
            let (feed, acceleration) = (speed * feed, acceleration * most);
            self.lines.line(named, [feed, acceleration]);
            let squares = from_mm.iter().zip(&to_mm).map(|(from, to)| (to - from).powi(2));
            let length_mm = squares.sum::<f64>().sqrt();
            self.seconds += rest_to_rest_s(1e-3 * length_mm, feed / 6e4, acceleration);
            from_mm = to_mm;
            if pause_s > 0.0 {
                self.dwell(pause_s);
            }
        }
    }
}

/// Where a stroke leads an axis, as a fraction of half of its travel. The second axis is one stroke behind, so that axes that move at once
/// do not move alike; all end in the middle.
fn fraction(strokes: &[Stroke], number: usize, axis: usize) -> f64 {
    let is_last = number + 1 == strokes.len();
    let behind = (number + strokes.len() - axis % strokes.len()) % strokes.len();
    if is_last { 0.0 } else { strokes[behind].0[0] }
}

/// The smallest feed, mm/min, and acceleration, m/s², of some axes.
fn slowest(axes: &[AxisLimits]) -> [f64; 2] {
    let paces = axes.iter().map(AxisLimits::pace);
    paces.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]).unwrap_or_default()
}

/// Time of a line from rest to rest, m, m/s and m/s²: a trapezoid, or a triangle that does not reach the speed.
fn rest_to_rest_s(length_m: f64, speed_m_per_s: f64, acceleration_m_per_s2: f64) -> f64 {
    let reached = speed_m_per_s.min((length_m * acceleration_m_per_s2).sqrt());
    if reached > 0.0 { length_m / reached + reached / acceleration_m_per_s2 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(time_s: f64) -> MotionLimits {
        let axis = |name: &str, middle_mm: f64| AxisLimits {
            name: name.to_owned(),
            middle_mm,
            half_mm: 50.0,
            speed_mm_s: 100.0,
            acceleration_m_per_s2: 2.0,
        };
        MotionLimits { axes: vec![axis("x", 200.0), axis("y", -30.0)], time_s }
    }

    #[test]
    fn every_motion_stays_within_its_limits_and_ends_where_it_starts() {
        let candidates = candidates(&limits(200.0));
        assert_eq!(candidates.len(), PATTERNS.len());
        for candidate in &candidates {
            let motion = candidate.motion.motion().unwrap();
            let mut at = [200.0, -30.0];
            for block in &motion.blocks {
                if let motion::Block::Line { to_mm, pace } = block {
                    assert!((to_mm["x"] - 200.0).abs() <= 50.0 && (to_mm["y"] + 30.0).abs() <= 50.0);
                    assert!(pace.feed_mm_per_min <= 6000.0 && pace.acceleration_m_per_s2 <= 2.0);
                    at = [to_mm["x"], to_mm["y"]];
                }
            }
            assert!((at[0] - 200.0).abs() < 1e-9 && (at[1] + 30.0).abs() < 1e-9, "{}", candidate.name);
        }
    }

    #[test]
    fn one_axis_has_no_diagonals() {
        let two = limits(200.0);
        let one = MotionLimits { axes: two.axes[..1].to_vec(), ..two };
        let names: Vec<String> = candidates(&one).into_iter().map(|candidate| candidate.name).collect();
        assert_eq!(names.len(), PATTERNS.len() - 1, "{names:?}");
        assert!(names.iter().all(|name| !name.contains("diagonal")), "{names:?}");
    }

    #[test]
    fn axes_that_move_at_once_do_not_move_alike() {
        let moves = |name: &str| {
            let all = candidates(&limits(200.0));
            let motion = all.iter().find(|one| one.name == name).unwrap().motion.motion().unwrap().clone();
            let mut from = [200.0, -30.0];
            let mut moves = Vec::new();
            for block in &motion.blocks {
                if let motion::Block::Line { to_mm, .. } = block {
                    let to = [to_mm["x"], to_mm["y"]];
                    moves.push([0, 1].map(|i: usize| to[i] - from[i]));
                    from = to;
                }
            }
            moves
        };
        let alone = moves("strokes");
        assert!(alone.iter().all(|[x, y]| (*x == 0.0) != (*y == 0.0)), "{alone:?}");
        // The ratio of their moves differs from stroke to stroke.
        let together = moves("diagonal steps");
        let ratios: Vec<f64> = together.iter().filter(|[x, _]| *x != 0.0).map(|[x, y]| y / x).collect();
        assert!(
            ratios.iter().any(|ratio| *ratio > 0.5) && ratios.iter().any(|ratio| *ratio < -0.5),
            "{ratios:?}"
        );
    }

    #[test]
    fn motions_are_ordered_by_their_duration_and_none_is_too_long() {
        let all = candidates(&limits(200.0));
        assert!(all.windows(2).all(|pair| pair[0].seconds <= pair[1].seconds));
        let short = candidates(&limits(20.0));
        assert!(!short.is_empty() && short.len() < all.len());
        assert!(short.iter().all(|one| one.seconds <= 20.0));
        // Four rounds over parts of the travel, in all 3.3 of it. Each has strokes of 50, 100 and 50 mm at 100 mm/s and 2 m/s²: 2 s over the whole
        // lengths, 0.05 s of ramps and 0.1 s after each; two axes, after 0.5 s.
        let strokes = all.iter().find(|one| one.name == "strokes").unwrap();
        let expected_s = 0.5 + 2.0 * (2.0 * 3.3 + 4.0 * 3.0 * 0.15);
        assert!((strokes.seconds - expected_s).abs() < 1e-9, "{} {expected_s}", strokes.seconds);
    }
}
