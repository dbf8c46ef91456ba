//! Which logs are of the same motion, by their commands.

use super::commanded::{duration_s, is_same_duration};
use crate::logged::LoggedMotion;
use crate::path::NominalPath;
use crate::vector::distance;
use files::error::InputError;
use files::log::Log;

/// Points at equal fractions of the paths that are compared.
const POINTS: u32 = 200;

/// Largest difference of the lengths of two paths, and of two points on them, as a fraction of the length.
const MAX_FRACTION: f64 = 1e-4;

/// Added to both, m.
const MAX_DISTANCE_M: f64 = 10e-6;

/// The indices of the logs of `after`, one for each of `before`, that have the same command; each is used once.
///
/// # Errors
/// If a log has no counterpart, is a copy of its counterpart, or lacks a command; the message names the log and the other side.
pub fn pairs(before: &[Log], after: &[Log]) -> Result<Vec<usize>, InputError> {
    let motions = |logs: &[Log]| -> Result<Vec<LoggedMotion>, InputError> {
        logs.iter().map(|log| LoggedMotion::of(log).map_err(|missing| missing.in_log(log))).collect()
    };
    let (motions_before, motions_after) = (motions(before)?, motions(after)?);
    let is_same = |i: usize, j: usize| is_same_motion(&motions_before[i], &motions_after[j]);
    let mut taken = vec![false; after.len()];
    let mut pairs = Vec::with_capacity(before.len());
    for (i, log) in before.iter().enumerate() {
        let candidates: Vec<usize> = (0..after.len()).filter(|&j| is_same(i, j)).collect();
        let index = candidates.iter().copied().find(|&j| !taken[j]);
        let index = index.ok_or_else(|| no_counterpart(log, (after, &candidates), "after"))?;
        check_other_run(log, &after[index])?;
        taken[index] = true;
        pairs.push(index);
    }
    match taken.iter().position(|taken| !taken) {
        Some(j) => {
            let candidates: Vec<usize> = (0..before.len()).filter(|&i| is_same(i, j)).collect();
            Err(no_counterpart(&after[j], (before, &candidates), "before"))
        }
        None => Ok(pairs),
    }
}

/// A log that lacks a counterpart among the others, of which some are of the same motion but belong to other logs.
fn no_counterpart(log: &Log, (others, of_same_motion): (&[Log], &[usize]), side: &str) -> InputError {
    let (expected, found) = if of_same_motion.is_empty() {
        (
            format!("a log of the same motion (axes, path and duration of the command) {side} the change"),
            format!("other motions in {}", sources(others)),
        )
    } else {
        let taken = sources(of_same_motion.iter().map(|&index| &others[index]));
        (
            format!("one log {side} the change for each log of this motion"),
            format!("only {taken}, which another log is compared with"),
        )
    };
    InputError::expected(&log.source, expected, found)
}

/// The files of logs.
fn sources<'a>(logs: impl IntoIterator<Item = &'a Log>) -> String {
    logs.into_iter().map(|log| log.source.as_str()).collect::<Vec<_>>().join(", ")
}

/// Checks that two logs are not the same recording: no two runs of a machine have the same samples.
fn check_other_run(before: &Log, after: &Log) -> Result<(), InputError> {
    if before.axes != after.axes {
        return Ok(());
    }
    let expected = "another run of the motion, after the change";
    Err(InputError::expected(&after.source, expected, format!("the samples of {}", before.source)))
}

/// Whether two commands have the same axes, the same path and the same duration.
#[must_use]
pub fn is_same_motion(one: &LoggedMotion, other: &LoggedMotion) -> bool {
    if one.axes != other.axes {
        return false;
    }
    let [path, other_path] =
        [one, other].map(|motion| NominalPath::of_command(&motion.command_m, motion.sample_s));
    let (length_m, other_m) = (path.length_m(), other_path.length_m());
    let max_m = MAX_FRACTION * length_m + MAX_DISTANCE_M;
    let is_near = |i: u32| {
        let fraction = f64::from(i) / f64::from(POINTS);
        distance(&path.point_at(fraction * length_m), &other_path.point_at(fraction * other_m)) <= max_m
    };
    (length_m - other_m).abs() <= max_m
        && is_same_duration(duration_s(one), duration_s(other), one.sample_s.max(other.sample_s))
        && (0..=POINTS).all(is_near)
}
