//! Motions of dwells and straight lines that a program makes, and their files.

use std::collections::BTreeSet;

use indexmap::IndexMap;
use shared::interpolate::Ramps;

use super::block::{Block, Motion, Pace};
use super::bounds::{LONGEST_TRAVEL_MM, SHORTEST_MM};
use super::duration::Duration;

/// A motion of dwells and straight lines that a program makes, block by block.
///
/// Its numbers are those that its file says: positions in 1 µm, feeds in 0.1 mm/min, accelerations in 1 mm/s², durations in
/// 0.1 s.
#[derive(Clone, Debug)]
pub struct Lines {
    motion: Motion,
    /// Feed and acceleration that the file has as defaults.
    pace: Pace,
    position_mm: IndexMap<String, f64>,
    /// The axes that some line names.
    moving: BTreeSet<String>,
    duration: Duration,
    is_runnable: bool,
}

impl Lines {
    /// Begins a motion at the positions of all axes. The file has the feed (mm/min) and the acceleration (m/s²) as defaults.
    #[must_use]
    pub fn begin(name: &str, start_mm: IndexMap<String, f64>, [feed, acceleration]: [f64; 2]) -> Self {
        let start_mm: IndexMap<String, f64> =
            start_mm.into_iter().map(|(name, mm)| (name, rounded(mm, 3))).collect();
        let pace = pace(feed, acceleration);
        Self {
            is_runnable: !start_mm.is_empty()
                && is_positive(&pace)
                && start_mm.values().copied().all(is_within_travel),
            position_mm: start_mm.clone(),
            moving: BTreeSet::new(),
            motion: Motion { name: name.to_owned(), start_mm, blocks: Vec::new() },
            pace,
            duration: Duration::default(),
        }
    }

    /// Adds a standstill.
    pub fn dwell(&mut self, seconds: f64) {
        let seconds = rounded(seconds, 1);
        self.is_runnable &= seconds > 0.0;
        self.duration.add_dwell(seconds);
        self.motion.blocks.push(Block::Dwell { seconds });
    }

    /// Adds a line to the positions of some axes, mm, with a feed (mm/min) and an acceleration (m/s²); the other axes do not move.
    pub fn line<'a>(
        &mut self,
        to_mm: impl IntoIterator<Item = (&'a str, f64)>,
        [feed, acceleration]: [f64; 2],
    ) {
        let from_mm = self.position_mm.clone();
        for (name, mm) in to_mm {
            self.moving.insert(name.to_owned());
            match self.position_mm.get_mut(name) {
                Some(position_mm) => *position_mm = rounded(mm, 3),
                None => self.is_runnable = false,
            }
        }
        let pace = pace(feed, acceleration);
        let steps_mm = self.position_mm.values().zip(from_mm.values()).map(|(to, from)| to - from);
        let length_mm = steps_mm.map(|step_mm| step_mm * step_mm).sum::<f64>().sqrt();
        self.duration.add_path(length_mm, &pace);
        self.is_runnable &= length_mm >= SHORTEST_MM
            && is_positive(&pace)
            && self.position_mm.values().copied().all(is_within_travel);
        self.motion.blocks.push(Block::Line { to_mm: self.position_mm.clone(), pace });
    }

    /// The motion; `None` if it cannot be run.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        let is_runnable = self.is_runnable && self.duration.is_permitted() && !self.motion.blocks.is_empty();
        is_runnable.then_some(&self.motion)
    }

    /// Text of the motion file, with a comment as its first line.
    #[must_use]
    pub fn to_toml(&self, comment: &str) -> String {
        let Motion { name, start_mm, blocks } = &self.motion;
        let moves = |axis: &String| self.moving.contains(axis);
        let block = |block: &Block| match block {
            Block::Dwell { seconds } => format!("\n[[block]]\ndwell_s = {seconds:.1}\n"),
            Block::Line { to_mm, pace } => {
                let moving = to_mm.iter().filter(|(axis, _)| moves(axis));
                format!("\n[[block]]\nline_to_mm = {{ {} }}\n{}", positions(moving), pace_text(pace))
            }
            // A motion of lines has none.
            Block::Arc { .. } => String::new(),
        };
        format!(
            "# {comment}\nname = \"{name}\"\n{}start_mm = {{ {} }}\n{}",
            pace_text(&self.pace),
            positions(start_mm),
            blocks.iter().map(block).collect::<String>()
        )
    }
}

fn pace(feed: f64, acceleration: f64) -> Pace {
    Pace {
        feed_mm_per_min: rounded(feed, 1),
        acceleration_m_per_s2: rounded(acceleration, 3),
        ramps: Ramps::Trapezoid,
        joint_tolerance_um: 0.0,
    }
}

fn pace_text(pace: &Pace) -> String {
    let Pace { feed_mm_per_min, acceleration_m_per_s2, .. } = pace;
    format!("feed_mm_per_min = {feed_mm_per_min:.1}\nacceleration_m_per_s2 = {acceleration_m_per_s2:.3}\n")
}

fn positions<'a>(of: impl IntoIterator<Item = (&'a String, &'a f64)>) -> String {
    of.into_iter().map(|(axis, mm)| format!("{axis} = {mm:.3}")).collect::<Vec<_>>().join(", ")
}

fn is_positive(pace: &Pace) -> bool {
    pace.feed_mm_per_min > 0.0 && pace.acceleration_m_per_s2 > 0.0
}

fn is_within_travel(mm: f64) -> bool {
    mm.abs() <= LONGEST_TRAVEL_MM
}

/// The number that is printed with these decimals.
fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10.0_f64.powi(decimals);
    (scale * value).round_ties_even() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    fn begun() -> Lines {
        let start_mm = [("x", 1.000_04), ("y", -20.0)].map(|(name, mm)| (name.to_owned(), mm));
        Lines::begin("there and back", start_mm.into(), [6000.0, 2.0])
    }

    #[test]
    fn a_motion_is_what_its_file_says() {
        let mut lines = begun();
        lines.dwell(0.5);
        lines.line([("x", 3.241_59)], [1234.56, 0.123_4]);
        lines.line([("x", 1.0)], [6000.0, 2.0]);
        let text = lines.to_toml("For a test.");
        assert_eq!(&Motion::parse(&text, "test").unwrap(), lines.motion().unwrap());
        assert!(
            text.starts_with("# For a test.\nname = \"there and back\"\nfeed_mm_per_min = 6000.0\n"),
            "{text}"
        );
        assert!(
            text.contains(
                "line_to_mm = { x = 3.242 }\nfeed_mm_per_min = 1234.6\nacceleration_m_per_s2 = 0.123\n"
            ),
            "{text}"
        );
    }

    #[test]
    fn what_a_file_may_not_say_is_no_motion() {
        assert_eq!(begun().motion(), None, "no block");
        let with = |to: (&'static str, f64), pace: [f64; 2]| {
            let mut lines = begun();
            lines.line([to], pace);
            lines.motion().is_some()
        };
        assert!(with(("x", 2.0), [100.0, 1.0]));
        assert!(!with(("x", 1.000_2), [100.0, 1.0]), "no way");
        assert!(!with(("x", 2.0), [0.04, 1.0]), "no feed");
        assert!(!with(("x", 2.0), [100.0, 4e-4]), "no acceleration");
        assert!(!with(("x", 2e5), [100.0, 1.0]), "too far");
        assert!(!with(("x", 9e4), [1.0, 1.0]), "too long");
        assert!(!with(("z", 2.0), [100.0, 1.0]), "another axis");
    }
}
