//! The family of short motions that a plan is made of: each begins and ends at rest in the middle of the travel.

use indexmap::IndexMap;
use motion::{Block, Motion, Pace, Sweep};

use crate::Limits;

/// Part of the travel that is used: an axis overshoots.
const WITHIN: f64 = 0.9;

/// Longest half of a stroke, mm, and largest radius.
const HALF_MM: f64 = 150.0;
const RADIUS_MM: f64 = 30.0;

/// Rest at the end of a part, s.
const REST_S: f64 = 0.1;

/// Strokes of one axis: name, and their fractions of travel, speed and acceleration; pause before the last one, s.
const STROKES: [(&str, &[[f64; 3]], f64); 8] = [
    ("stroke", &[[1.0, 1.0, 1.0]], 0.0),
    ("stroke at medium speed", &[[1.0, 0.35, 1.0]], 0.0),
    ("slow stroke", &[[0.3, 0.1, 1.0]], 0.0),
    ("creeping", &[[0.03, 0.01, 0.3]], 0.0),
    ("gentle stroke", &[[1.0, 1.0, 0.2]], 0.0),
    ("short quick strokes", &[[0.1, 1.0, 1.0], [0.04, 1.0, 1.0], [0.02, 1.0, 1.0]], 0.0),
    ("strokes of three lengths", &[[1.0, 0.35, 0.5], [0.5, 0.35, 0.5], [0.2, 0.35, 0.5]], 0.0),
    ("stroke after a rest", &[[0.5, 0.5, 1.0], [0.5, 0.5, 1.0]], 8.0),
];

/// The stroke that every plan has.
const WHOLE_TRAVEL: &str = "stroke at medium speed";

/// Circles: name, fractions of the radius and of the speed.
const CIRCLES: [(&str, f64, f64); 3] =
    [("circles", 1.0, 0.6), ("small circles", 0.3, 0.3), ("slow circles", 1.0, 0.2)];

/// A part that a plan may take.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// What it is.
    pub name: String,
    /// The motion alone.
    pub motion: Motion,
    /// How long it takes, s.
    pub seconds: f64,
    /// The axis whose whole travel it is, of which a plan takes one for each axis with something open: the rivals of a model may all be
    /// wrong, which only a motion beyond the earlier ones shows.
    pub whole_travel_of: Option<String>,
}

/// Axes of a plan, with the middle and the usable half of their travels.
struct Space {
    centre_mm: IndexMap<String, f64>,
    half_mm: Vec<f64>,
}

/// All parts that fit the limits: strokes of each axis, and circles of each pair of axes.
#[must_use]
pub fn all(limits: &Limits) -> Vec<Candidate> {
    let space = Space {
        centre_mm: limits
            .travels
            .iter()
            .map(|travel| (travel.axis.clone(), 0.5 * (travel.ends_mm[0] + travel.ends_mm[1])))
            .collect(),
        half_mm: limits
            .travels
            .iter()
            .map(|travel| (WITHIN * 0.5 * (travel.ends_mm[1] - travel.ends_mm[0])).min(HALF_MM))
            .collect(),
    };
    let mut all = Vec::new();
    for index in 0..limits.travels.len() {
        for stroke in &STROKES {
            let part = space.strokes(limits, index, stroke);
            let axis = limits.travels[index].axis.clone();
            all.push(Candidate { whole_travel_of: (stroke.0 == WHOLE_TRAVEL).then_some(axis), ..part });
        }
        for second in index + 1..limits.travels.len() {
            // The plane of G17, whose sense of rotation every control has.
            if !(space.is_named(index, "x") && space.is_named(second, "y")) {
                continue;
            }
            for circle in &CIRCLES {
                all.push(space.circles(limits, [index, second], circle));
            }
        }
    }
    all
}

impl Space {
    fn is_named(&self, index: usize, name: &str) -> bool {
        self.centre_mm.get_index(index).is_some_and(|(axis, _)| axis == name)
    }

    fn candidate(&self, name: String, mut blocks: Vec<Block>) -> Candidate {
        blocks.push(Block::Dwell { seconds: REST_S });
        let seconds = seconds(&self.centre_mm, &blocks);
        let motion = Motion { name: name.clone(), start_mm: self.centre_mm.clone(), blocks };
        Candidate { name, motion, seconds, whole_travel_of: None }
    }

    fn strokes(
        &self,
        limits: &Limits,
        index: usize,
        (name, strokes, pause_s): &(&str, &[[f64; 3]], f64),
    ) -> Candidate {
        let (axis, _) = self.centre_mm.get_index(index).map_or(("", &0.0), |(axis, mm)| (axis.as_str(), mm));
        let mut blocks = Vec::new();
        for (at, [travel, speed, acceleration]) in strokes.iter().enumerate() {
            if *pause_s > 0.0 && at + 1 == strokes.len() {
                blocks.push(Block::Dwell { seconds: *pause_s });
            }
            let pace =
                Pace::with_exact_stop(speed * limits.speed_mm_s, acceleration * limits.acceleration_m_per_s2);
            for end in [1.0, -1.0, 0.0] {
                let mut to_mm = self.centre_mm.clone();
                to_mm[axis] = rounded(to_mm[axis] + end * travel * self.half_mm[index]);
                blocks.push(Block::Line { to_mm, pace });
            }
        }
        self.candidate(format!("{name} of {axis}"), blocks)
    }

    /// A full circle in each direction, from its rightmost point.
    fn circles(
        &self,
        limits: &Limits,
        axes: [usize; 2],
        (name, size, speed): &(&str, f64, f64),
    ) -> Candidate {
        let plane =
            axes.map(|index| self.centre_mm.get_index(index).map_or(String::new(), |(axis, _)| axis.clone()));
        let half_mm = self.half_mm[axes[0]].min(self.half_mm[axes[1]]);
        let radius_mm = rounded(size * half_mm.min(RADIUS_MM));
        // The centripetal acceleration takes half of what is allowed.
        let greatest = (500.0 * limits.acceleration_m_per_s2 * radius_mm).sqrt();
        let pace =
            Pace::with_exact_stop((speed * limits.speed_mm_s).min(greatest), limits.acceleration_m_per_s2);
        let centre_mm = [self.centre_mm[&plane[0]], self.centre_mm[&plane[1]]];
        let mut right_mm = self.centre_mm.clone();
        right_mm[&plane[0]] += radius_mm;
        let arc =
            |turns: f64| Block::Arc { plane: plane.clone(), centre_mm, sweep: Sweep::Turns(turns), pace };
        let blocks = vec![
            Block::Line { to_mm: right_mm, pace },
            arc(1.0),
            arc(-1.0),
            Block::Line { to_mm: self.centre_mm.clone(), pace },
        ];
        let name = format!("{name} of {} and {}", plane[0], plane[1]);
        self.candidate(name, blocks)
    }
}

/// A position to 1 µm, as its file says it.
fn rounded(mm: f64) -> f64 {
    (1e3 * mm).round() / 1e3
}

/// Time of blocks with trapezoidal speed and exact stops, s.
fn seconds(start_mm: &IndexMap<String, f64>, blocks: &[Block]) -> f64 {
    let mut at_mm = start_mm.clone();
    let mut seconds = 0.0;
    for block in blocks {
        let (length_mm, pace) = match block {
            Block::Dwell { seconds: rest } => {
                seconds += rest;
                continue;
            }
            Block::Line { to_mm, pace } => {
                let squares = to_mm.iter().map(|(axis, mm)| (mm - at_mm[axis]).powi(2));
                let length_mm = squares.sum::<f64>().sqrt();
                at_mm.clone_from(to_mm);
                (length_mm, pace)
            }
            Block::Arc { plane, centre_mm, sweep, pace } => {
                let radius_mm = (at_mm[&plane[0]] - centre_mm[0]).hypot(at_mm[&plane[1]] - centre_mm[1]);
                let turns = if let Sweep::Turns(turns) = sweep { turns.abs() } else { 1.0 };
                (std::f64::consts::TAU * turns * radius_mm, pace)
            }
        };
        let speed = pace.feed_mm_per_min / 60.0;
        let acceleration = 1e3 * pace.acceleration_m_per_s2;
        seconds += if length_mm * acceleration > speed * speed {
            length_mm / speed + speed / acceleration
        } else {
            2.0 * (length_mm / acceleration).sqrt()
        };
    }
    seconds
}
