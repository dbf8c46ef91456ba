//! Motions that turn, stop and creep: with a compensation, none of them may have a larger contour error than without.

use indexmap::IndexMap;

use crate::compensate::mapped;
use crate::compensate::prediction::TestMotion;
use files::error::InputError;
use model::machine::Machine;
use motion::{Block, Motion, Pace, Sweep};
use plant::equivalent;

/// Strokes between reversals, mm, with their feeds, mm/s: from creeping through presliding to brisk.
const REVERSALS: [(f64, f64); 5] = [(0.05, 0.1), (0.2, 0.5), (1.0, 2.5), (4.0, 10.0), (12.0, 40.0)];

/// Steps back and forth, as fractions of half of the travel, with their feeds, mm/s, and a pause after some of them, s.
const STEPS: [(f64, f64, f64); 7] = [
    (1.0, 100.0, 0.0),
    (0.4, 50.0, 0.0),
    (0.7, 25.0, 0.1),
    (-1.0, 160.0, 0.0),
    (-0.4, 100.0, 0.0),
    (-0.7, 50.0, 0.0),
    (0.0, 100.0, 0.1),
];

/// Half of the longest travel of the steps, mm.
const LONGEST_MM: f64 = 100.0;

/// Part of the travel that is used: an axis overshoots.
const WITHIN: f64 = 0.95;

/// Feed and greatest radius of the circle, mm/s and mm.
const CIRCLE: (f64, f64) = (50.0, 25.0);

/// A diagonal that all axes creep along: feed, mm/s, and length along each axis, mm.
const CREEPING: (f64, f64) = (0.1, 0.1);

/// The standard motions of a machine within the travel of other motions, as far as the model knows it. They start at `start_s` on
/// the session clock. There are none for a machine whose loops or masses are not known: what these motions show hangs on both.
///
/// # Errors
/// If one of the motions does not fit the machine.
pub fn all(machine: &Machine, tests: &[TestMotion], start_s: f64) -> Result<Vec<TestMotion>, InputError> {
    if !equivalent::is_known(machine) {
        return Ok(Vec::new());
    }
    let axis = |(index, (name, axis))| {
        let travel_m = mapped::known_m(axis, mapped::travel_m(machine, tests, index)?);
        Ok((String::clone(name), travel_m.map(|m| 1e3 * m)))
    };
    let axes = machine.axis.iter().enumerate().map(axis).collect::<Result<_, InputError>>()?;
    let fastest = machine.axis.values().filter_map(|axis| axis.settings.limits.fastest_mm_per_s);
    let builder = Builder { axes, fastest_mm_per_s: fastest.fold(f64::INFINITY, f64::min) };
    let motions =
        [builder.reversals(), builder.steps(), builder.creeping()].into_iter().chain(builder.circle());
    Ok(motions.map(|motion| TestMotion::of_program(motion, start_s)).collect())
}

/// Axes with their travel, mm, and the fastest feed.
struct Builder {
    axes: Vec<(String, [f64; 2])>,
    fastest_mm_per_s: f64,
}

impl Builder {
    fn centre_mm(&self) -> IndexMap<String, f64> {
        self.axes.iter().map(|(name, [from, to])| (name.clone(), 0.5 * (from + to))).collect()
    }

    fn half_mm(&self, axis: usize) -> f64 {
        let [from, to] = self.axes[axis].1;
        WITHIN * 0.5 * (to - from)
    }

    fn pace(&self, mm_per_s: f64, acceleration_m_per_s2: f64) -> Pace {
        Pace::with_exact_stop(mm_per_s.min(self.fastest_mm_per_s), acceleration_m_per_s2)
    }

    /// A motion from the centre of the travel, after a rest.
    fn motion(&self, name: &str, blocks: Vec<Block>) -> Motion {
        let rest = Block::Dwell { seconds: 0.2 };
        Motion {
            name: name.to_owned(),
            start_mm: self.centre_mm(),
            blocks: std::iter::once(rest).chain(blocks).collect(),
        }
    }

    /// A line from the centre along one axis.
    fn line(&self, axis: usize, offset_mm: f64, pace: Pace) -> Block {
        let mut to_mm = self.centre_mm();
        to_mm[axis] += offset_mm;
        Block::Line { to_mm, pace }
    }

    /// One axis after the other turns at ever larger strokes.
    fn reversals(&self) -> Motion {
        let of_axis = |axis: usize| {
            let strokes = REVERSALS.into_iter().filter(move |(mm, _)| *mm <= self.half_mm(axis));
            let there = move |(mm, feed): (f64, f64)| {
                [mm, -mm].map(|offset| self.line(axis, offset, self.pace(feed, 1.0)))
            };
            strokes
                .flat_map(there)
                .chain([self.line(axis, 0.0, self.pace(40.0, 1.0)), Block::Dwell { seconds: 0.1 }])
        };
        self.motion("reversals", (0..self.axes.len()).flat_map(of_axis).collect())
    }

    /// One axis after the other moves over its travel in steps.
    fn steps(&self) -> Motion {
        let of_axis = |axis: usize| {
            let half_mm = self.half_mm(axis).min(LONGEST_MM);
            STEPS.into_iter().flat_map(move |(part, feed, pause_s)| {
                let pause = (pause_s > 0.0).then_some(Block::Dwell { seconds: pause_s });
                std::iter::once(self.line(axis, part * half_mm, self.pace(feed, 2.0))).chain(pause)
            })
        };
        self.motion("steps", (0..self.axes.len()).flat_map(of_axis).collect())
    }

    /// All axes together, slower than any friction breaks loose, there and back.
    fn creeping(&self) -> Motion {
        let (mm_per_s, mm) = CREEPING;
        let to = |offset_mm: f64| {
            let to_mm = self.centre_mm().into_iter().map(|(name, mm)| (name, mm + offset_mm)).collect();
            Block::Line { to_mm, pace: self.pace(mm_per_s, 1.0) }
        };
        self.motion("creeping", vec![to(mm), to(0.0)])
    }

    /// A circle of the first two axes in both directions. Its name differs from that of a user's own circle, which is listed beside it.
    fn circle(&self) -> Option<Motion> {
        let [(x, _), (y, _), ..] = &self.axes[..] else { return None };
        let (mm_per_s, most_mm) = CIRCLE;
        let radius_mm = most_mm.min(self.half_mm(0)).min(self.half_mm(1));
        let centre = self.centre_mm();
        let arc = |turns: f64| Block::Arc {
            plane: [x.clone(), y.clone()],
            centre_mm: [centre[0], centre[1]],
            sweep: Sweep::Turns(turns),
            pace: self.pace(mm_per_s, 1.0),
        };
        let pause = || Block::Dwell { seconds: 0.1 };
        let mut motion = self.motion("standard circle", vec![arc(1.0), pause(), arc(-1.0), pause()]);
        motion.start_mm[0] += radius_mm;
        Some(motion)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a circle of 30 mm: all of them within ±30 mm and the 2 % of 60 mm that the tables cover beyond it.
    #[test]
    fn the_standard_motions_stay_within_the_travel_and_move_every_axis() {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let circle = include_str!("../../../motions/demo_ballbar.toml");
        let test = TestMotion::parse(circle, "circle", 0.0).unwrap();
        let motions = all(&machine, &[test], 5.0).unwrap();
        let names: Vec<&str> = motions.iter().map(|test| test.motion.name.as_str()).collect();
        assert_eq!(names, ["reversals", "steps", "creeping", "standard circle"]);
        for test in motions {
            let path = test.nominal_path(&machine).unwrap();
            for axis in [0, 1] {
                let [least, greatest] = path.extent_m(axis);
                assert!(least >= -0.0312 && greatest <= 0.0312 && greatest - least > 5e-5, "{}", test.source);
            }
        }
    }
}
