//! The contour error of a long log, section by section: the path through the samples of a command takes several times the memory
//! of the samples.
//!
//! Sections are cut at the end of standstills of the command, which separate the blocks of its path. Of the circles the largest remains, as of a log that is
//! evaluated as a whole; its directions are those of one section.

use std::ops::Range;

use super::across::Across;
use super::evaluation::{BlockError, ContourError};
use super::logged::LoggedMotion;
use files::log::{Channel, Log, Unit};

/// Number of samples from which a log is divided.
const LONG: usize = 400_000;
/// Smallest number of samples of a section.
const SECTION: usize = 200_000;
/// Number of samples after the smallest length in which a standstill is looked for; without one, the section ends there.
const SEARCHED: usize = 100_000;
/// Duration of a standstill, s, as of those that separate the blocks of a path.
const STANDSTILL_S: f64 = 0.05;

/// The contour error of a log and the motion of its first section; `None` if the log lacks what it needs.
#[must_use]
pub fn contour_error(log: &Log) -> Option<(LoggedMotion, ContourError)> {
    if log.len() < LONG {
        let motion = LoggedMotion::of(log).ok()?;
        let error = motion.contour_error()?;
        return Some((motion, error));
    }
    of_sections(log, &sections(log, SECTION))
}

fn of_sections(log: &Log, sections: &[Range<usize>]) -> Option<(LoggedMotion, ContourError)> {
    let mut all: Option<(LoggedMotion, ContourError)> = None;
    for section in sections {
        let motion = LoggedMotion::of(&log.slice(section.clone())).ok()?;
        let is_first = section.start == 0;
        let error = if is_first { motion.contour_error() } else { motion.contour_error_of_continuation() };
        let Some(error) = error else { continue };
        all = Some(match all {
            None => (motion, error),
            Some((first, sum)) => (first, merged(sum, error)),
        });
    }
    all
}

/// The error of two sections, the second after the first.
fn merged(first: ContourError, second: ContourError) -> ContourError {
    let samples = first.samples + second.samples;
    let mean_square = |a: f64, b: f64| {
        let sum = a * a * first.samples as f64 + b * b * second.samples as f64;
        (sum / samples.max(1) as f64).sqrt()
    };
    let known = first.blocks.last().map_or(0, |last| last.block + 1);
    let later = second.blocks.iter().map(|of| BlockError { block: of.block + known, ..*of });
    let radius = |error: &ContourError| numerics::max(error.circles.iter().map(|circle| circle.radius));
    ContourError {
        max_um: first.max_um.max(second.max_um),
        rms_um: mean_square(first.rms_um, second.rms_um),
        samples,
        noise_um: mean_square(first.noise_um, second.noise_um),
        across: Across::merged([(&first.across, first.samples), (&second.across, second.samples)]),
        is_along_axis: first.is_along_axis,
        blocks: first.blocks.iter().copied().chain(later).collect(),
        circles: if first.circles.is_empty() || radius(&second) > radius(&first) {
            second.circles
        } else {
            first.circles
        },
        corners: first.corners.into_iter().chain(second.corners).collect(),
    }
}

/// The sections of a log, each at least `length` samples long.
fn sections(log: &Log, length: usize) -> Vec<Range<usize>> {
    let commands: Vec<&[f64]> = log
        .axes
        .iter()
        .filter(|axis| axis.unit == Unit::Millimetre)
        .filter_map(|axis| axis.channel(Channel::Command))
        .collect();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some samples")]
    let standstill = (STANDSTILL_S / log.sample_time_s).round().max(1.0) as usize;
    let rests =
        |at: usize| commands.iter().all(|command| (command[at] - command[at - 1]).abs() <= f64::EPSILON);
    let mut sections = Vec::new();
    let mut start = 0;
    while start + 2 * length < log.len() {
        let searched = start + length..(start + length + SEARCHED.min(length)).min(log.len());
        let mut still = 0;
        let end_of_standstill = |&at: &usize| {
            let has_ended = still >= standstill && !rests(at);
            still = if rests(at) { still + 1 } else { 0 };
            has_ended
        };
        // The command of the sample before is that of the standstill, from which the next motion starts.
        let end = searched.clone().find(end_of_standstill).map_or(searched.end, |at| at - 1);
        sections.push(start..end);
        start = end;
    }
    sections.push(start..log.len());
    sections
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::AxisLog;

    /// Strokes of 2 s along a bent path with pauses of 0.3 s, at 1 kHz; the tool is off by a wave of 3 µm and more in each
    /// stroke.
    fn log(strokes: usize) -> Log {
        let count = strokes * 2300;
        let phase = |i: usize| {
            let within = ((i % 2300) as f64 / 2000.0).min(1.0);
            0.5 - 0.5 * (std::f64::consts::PI * (within + (i / 2300 % 2) as f64)).cos()
        };
        let mut axes = [AxisLog::new("x", Unit::Millimetre), AxisLog::new("y", Unit::Millimetre)];
        let of = [|s: f64| 40.0 * s, |s: f64| 9.0 * s * s];
        for (number, axis) in axes.iter_mut().enumerate() {
            let command: Vec<f64> = (0..count).map(|i| of[number](phase(i))).collect();
            let off = |i: usize| 1e-3 * (3.0 + (i / 2300) as f64) * (0.02 * i as f64 + number as f64).sin();
            axis.tool = Some(command.iter().enumerate().map(|(i, mm)| mm + off(i)).collect());
            axis.command = Some(command);
        }
        Log::new("l.csv", 0.0, 1e-3, axes.to_vec())
    }

    #[test]
    fn the_error_of_sections_is_that_of_the_log() {
        let log = log(12);
        let parts = sections(&log, 5000);
        assert!(parts.len() > 2 && parts[0].start == 0 && parts.last().unwrap().end == log.len());
        assert!(parts.windows(2).all(|two| two[0].end == two[1].start));
        let whole = LoggedMotion::of(&log).unwrap().contour_error().unwrap();
        let (_, sum) = of_sections(&log, &parts).unwrap();
        assert_eq!((sum.samples, sum.blocks.len()), (whole.samples, whole.blocks.len()));
        // The last sample of a standstill is the first of the next section; rounding of the length of the path.
        assert!((sum.max_um / whole.max_um - 1.0).abs() < 1e-6, "{} {}", sum.max_um, whole.max_um);
        assert!((sum.rms_um / whole.rms_um - 1.0).abs() < 1e-3, "{} {}", sum.rms_um, whole.rms_um);
        for (of_sum, of_whole) in sum.blocks.iter().zip(&whole.blocks) {
            assert!(of_sum.block == of_whole.block, "{of_sum:?} {of_whole:?}");
            assert!((of_sum.max_um / of_whole.max_um - 1.0).abs() < 1e-6, "{of_sum:?} {of_whole:?}");
        }
    }
}
