//! What a motion is recognized by: length, duration and points of its command.

use std::collections::BTreeMap;

use crate::logged::LoggedMotion;
use crate::path::NominalPath;

/// Largest difference of the durations of two commands, as a fraction: the contour error depends on the speed. Planners of other
/// controls plan other ramps: on a circle of 10 s, LinuxCNC takes 1.4 % longer.
const MAX_DURATION_FRACTION: f64 = 0.03;

/// Added to it, in samples of the slower log: a motion starts and ends between samples.
const MAX_DURATION_SAMPLES: f64 = 4.0;

/// Points at equal fractions of the path, from its start to its end.
const POINTS: u32 = 16;

/// A command.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commanded {
    /// Names of the axes, in the order of the log.
    pub axes: Vec<String>,
    /// Length of the path, mm.
    pub length_mm: f64,
    /// Time from the first change of the command to the last, s.
    pub duration_s: f64,
    /// Time from one sample to the next, s.
    pub sample_s: f64,
    /// Least and greatest position of each axis, mm.
    pub reached_mm: BTreeMap<String, [f64; 2]>,
    /// Positions of each axis at equal fractions of the length, mm, from the start to the end.
    pub points_mm: BTreeMap<String, Vec<f64>>,
}

impl Commanded {
    /// The command of a log.
    #[must_use]
    pub fn of(motion: &LoggedMotion) -> Self {
        let path = NominalPath::of_command(&motion.command_m, motion.sample_s);
        let points: Vec<_> =
            (0..=POINTS).map(|k| path.point_at(path.length_m() * f64::from(k) / f64::from(POINTS))).collect();
        // Positions to a tenth of a micrometre: the digits of a file.
        let rounded_mm = |m: f64| (1e7 * m).round() / 1e4;
        let of_axis = |axis: usize| points.iter().map(|point| rounded_mm(point[axis])).collect();
        let reached = motion.command_m.iter().map(|axis| numerics::min_max(axis.iter().map(|m| 1e3 * m)));
        Self {
            axes: motion.axes.clone(),
            length_mm: 1e3 * path.length_m(),
            duration_s: duration_s(motion),
            sample_s: motion.sample_s,
            reached_mm: motion.axes.iter().cloned().zip(reached).collect(),
            points_mm: motion.axes.iter().enumerate().map(|(i, name)| (name.clone(), of_axis(i))).collect(),
        }
    }
}

/// Whether two durations are the same, s; `sample_s` is the longer of the times between two samples.
pub(super) fn is_same_duration(one_s: f64, other_s: f64, sample_s: f64) -> bool {
    (one_s - other_s).abs() <= MAX_DURATION_FRACTION * one_s + MAX_DURATION_SAMPLES * sample_s
}

/// Time from the first change of the command to the last, s.
pub(super) fn duration_s(motion: &LoggedMotion) -> f64 {
    let moves = |i: &usize| motion.command_m.iter().any(|axis| (axis[i + 1] - axis[*i]).abs() > 0.0);
    let steps = motion.command_m.iter().map(Vec::len).min().unwrap_or(0).saturating_sub(1);
    let (first, last) = ((0..steps).find(moves), (0..steps).rfind(moves));
    first.zip(last).map_or(0.0, |(first, last)| (last + 1 - first) as f64 * motion.sample_s)
}
