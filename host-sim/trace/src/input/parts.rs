//! The parts of the logs that are fitted and held out, and the pieces in which they are evaluated.
//!
//! A log that is too long for a search is divided into sections. Effects are searched for in one stretch of each section,
//! that with the most motion; all stretches have the same length, so that their blocks have the same weight. The whole log is
//! evaluated piece by piece, see [`crate::judge::whole`]. A piece begins with a lead-in that is simulated but not evaluated.

use std::borrow::Cow;
use std::ops::Range;

use crate::options::AdmissionOptions;
use files::log::{AxisLog, Channel, Log};

/// Number of sections of all long logs of a set together.
const SECTIONS: usize = 8;
/// Largest number of samples of a piece of a whole log.
const PIECE: usize = 30_000;
/// Shortest lead-in, s: 30 time constants 1/Kp of a position gain of 30 1/s.
const LEAD_IN_S: f64 = 1.0;
/// Longest lead-in, s.
const MAX_LEAD_IN_S: f64 = 16.0;
/// Travel of each moving axis in a lead-in, mm or degrees: ten times the distance over which friction and a gap of 10 µm
/// reach the state of sliding.
const LEAD_IN_TRAVEL: f64 = 0.1;
/// Number of samples after a piece that the filters reach.
const LEAD_OUT: usize = 20;

/// A part of a log.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    /// The log.
    pub log: &'a Log,
    /// Its samples.
    pub samples: Range<usize>,
}

/// A part of a log that is evaluated at once, with samples before and after it.
#[derive(Clone, Debug)]
pub struct Piece<'a> {
    /// Index of its part.
    pub part: usize,
    /// The log.
    pub log: &'a Log,
    /// The samples that are evaluated.
    pub evaluated: Range<usize>,
    /// Number of samples before them.
    pub lead_in: usize,
    /// Number of samples after them.
    pub lead_out: usize,
}

impl Piece<'_> {
    /// The samples of the piece.
    #[must_use]
    pub fn samples(&self) -> Range<usize> {
        self.evaluated.start - self.lead_in..self.evaluated.end + self.lead_out
    }
}

/// The parts that are fitted and held out.
#[derive(Clone, Debug)]
pub struct Parts<'a> {
    /// Parts that are fitted, then parts that are held out.
    pub sets: [Vec<Part<'a>>; 2],
    /// Whether the logs are too long for a search in all of their samples.
    pub are_long: bool,
}

impl<'a> Parts<'a> {
    /// The parts of fit logs and validation logs. Without validation logs, the last quarter of each log, or of each section of
    /// a long one, is held out.
    #[must_use]
    pub fn of(logs: [&'a [Cow<'a, Log>]; 2], options: &AdmissionOptions) -> Self {
        let total = logs.map(|logs| logs.iter().map(|log| log.len()).sum::<usize>());
        let are_long = total.iter().any(|total| *total > options.max_samples);
        let sections = |set: usize| -> Vec<Part<'a>> {
            let of_log = |log: &'a Cow<'a, Log>| {
                let share = log.len() as f64 / total[set] as f64;
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to SECTIONS")]
                let count = ((SECTIONS as f64 * share).round() as usize).max(1);
                let count = if are_long { count } else { 1 };
                let start = move |i: usize| i * log.len() / count;
                (0..count).map(move |i| Part { log: log.as_ref(), samples: start(i)..start(i + 1) })
            };
            logs[set].iter().flat_map(of_log).collect()
        };
        if !logs[1].is_empty() {
            return Self { sets: [sections(0), sections(1)], are_long };
        }
        let halves = sections(0).into_iter().map(|Part { log, samples }| {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a fraction of a length"
            )]
            let end = samples.start + ((1.0 - options.held_out) * samples.len() as f64).round() as usize;
            [samples.start..end, end..samples.end].map(|samples| Part { log, samples })
        });
        let (fit, validate) = halves.map(|[fit, held_out]| (fit, held_out)).unzip();
        Self { sets: [fit, validate], are_long }
    }

    /// A sentence for each long fit log: what is computed from which samples.
    #[must_use]
    pub fn note(&self, options: &AdmissionOptions) -> Vec<String> {
        let mut notes: Vec<String> = Vec::new();
        let pieces = self.searched(0, options);
        for log in self.sets[0].iter().map(|part| part.log) {
            let of_log: Vec<&Piece<'_>> =
                pieces.iter().filter(|piece| std::ptr::eq(piece.log, log)).collect();
            let Some(first) = of_log.first().filter(|first| first.evaluated.len() < log.len()) else {
                continue;
            };
            let duration_s = first.evaluated.len() as f64 * log.sample_time_s;
            let note = format!(
                "{}: {} samples; effects are searched for in {} stretches of {duration_s:.1} s, spread over the log, to which the \
                 intervals belong; values and residuals are those of all samples.",
                log.source,
                log.len(),
                of_log.len()
            );
            if !notes.contains(&note) {
                notes.push(note);
            }
        }
        notes
    }

    /// The samples of a set in which effects are searched for, one piece for each part. Unless the logs are long, these are all
    /// samples.
    #[must_use]
    pub fn searched(&self, set: usize, options: &AdmissionOptions) -> Vec<Piece<'a>> {
        let parts = &self.sets[set];
        let total: usize = parts.iter().map(|part| part.samples.len()).sum();
        let share = if set == 0 { 1.0 - options.held_out } else { options.held_out };
        let ratio = share * options.searched_samples as f64 / total.max(1) as f64;
        let piece = |(index, part): (usize, &Part<'a>)| {
            let Part { log, samples } = part.clone();
            if !self.are_long {
                return Piece { part: index, log, evaluated: samples, lead_in: 0, lead_out: 0 };
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a fraction of a length"
            )]
            let length = ((ratio * samples.len() as f64) as usize).max(options.min_samples);
            let evaluated = if length < samples.len() { most_moving(part, length) } else { samples };
            with_margins(index, log, evaluated)
        };
        parts.iter().enumerate().map(piece).collect()
    }

    /// All samples of a set, piece by piece.
    #[must_use]
    pub fn pieces(&self, set: usize) -> Vec<Piece<'a>> {
        let of_part = |(index, part): (usize, &Part<'a>)| {
            let Part { log, samples } = part.clone();
            let count = samples.len().div_ceil(PIECE).max(1);
            let start = move |i: usize| samples.start + i * samples.len() / count;
            (0..count).map(move |i| with_margins(index, log, start(i)..start(i + 1))).collect::<Vec<_>>()
        };
        self.sets[set].iter().enumerate().flat_map(of_part).collect()
    }
}

/// The channel that shows the motion of an axis best.
fn motion(axis: &AxisLog) -> Option<&[f64]> {
    [Channel::Command, Channel::Motor, Channel::Table].into_iter().find_map(|channel| axis.channel(channel))
}

/// Σ|Δx|, mm or degrees.
fn path(values: &[f64]) -> f64 {
    values.windows(2).map(|two| (two[1] - two[0]).abs()).sum()
}

/// The stretch of a part in which the axes move most, each relative to its motion in the part.
fn most_moving(part: &Part<'_>, length: usize) -> Range<usize> {
    let Part { log, samples } = part;
    let axes: Vec<(&[f64], f64)> = log
        .axes
        .iter()
        .filter_map(|axis| motion(axis).map(|values| (values, path(&values[samples.clone()]).max(1e-9))))
        .collect();
    // A root, so that a stretch in which both axes move precedes one in which one moves twice as far.
    let moved = |stretch: &Range<usize>| -> f64 {
        axes.iter().map(|(values, whole)| (path(&values[stretch.clone()]) / whole).sqrt()).sum()
    };
    let last = samples.end - length;
    let starts = (samples.start..last).step_by((length / 2).max(1)).chain([last]);
    let best = starts.map(|start| start..start + length).max_by(|a, b| moved(a).total_cmp(&moved(b)));
    best.unwrap_or(last..samples.end)
}

fn with_margins(part: usize, log: &Log, evaluated: Range<usize>) -> Piece<'_> {
    let lead_in = lead_in(log, evaluated.start);
    let lead_out = LEAD_OUT.min(log.len() - evaluated.end);
    Piece { part, log, evaluated, lead_in, lead_out }
}

/// Number of samples before a sample in which all moving axes have travelled far enough, if that is not too long ago.
fn lead_in(log: &Log, start: usize) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few seconds of samples")]
    let [mut samples, most] =
        [LEAD_IN_S, MAX_LEAD_IN_S].map(|duration_s| (duration_s / log.sample_time_s).round() as usize);
    let has_moved = |samples: usize| {
        let from = start.saturating_sub(samples);
        log.axes.iter().filter_map(motion).all(|values| path(&values[from..start]) >= LEAD_IN_TRAVEL)
    };
    while samples < most && !has_moved(samples) {
        samples *= 2;
    }
    samples.min(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    /// An axis that oscillates in each second second, at 1 kHz.
    fn log(count: usize) -> Log {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let at = |i: usize| if (i / 1000).is_multiple_of(2) { (0.02 * i as f64).sin() } else { 0.0 };
        axis.motor = Some((0..count).map(at).collect());
        Log::new("l.csv", 0.0, 1e-3, [axis])
    }

    #[test]
    fn the_last_quarter_of_a_short_log_is_held_out() {
        let logs = [Cow::Owned(log(4000))];
        let options = AdmissionOptions::default();
        let parts = Parts::of([&logs, &[]], &options);
        let ranges =
            [0, 1].map(|set| parts.searched(set, &options).iter().map(Piece::samples).collect::<Vec<_>>());
        assert_eq!(ranges.concat(), [0..3000, 3000..4000]);
        assert!(ranges.iter().all(|of_set| of_set.len() == 1) && !parts.are_long);
    }

    #[test]
    fn the_pieces_of_a_long_log_are_all_of_its_samples() {
        let options = AdmissionOptions::default();
        let count = 2 * options.max_samples + 7;
        let logs = [Cow::Owned(log(count))];
        let parts = Parts::of([&logs, &[]], &options);
        assert!(parts.are_long);
        let mut evaluated: Vec<Range<usize>> =
            [0, 1].iter().flat_map(|&set| parts.pieces(set)).map(|piece| piece.evaluated).collect();
        evaluated.sort_by_key(|range| range.start);
        assert_eq!((evaluated[0].start, evaluated.last().unwrap().end), (0, count));
        assert!(evaluated.windows(2).all(|two| two[0].end == two[1].start));
        assert!(evaluated.iter().all(|range| range.len() <= PIECE));
    }

    #[test]
    fn effects_are_searched_for_in_stretches_of_equal_length_with_motion() {
        let options = AdmissionOptions::default();
        let logs = [Cow::Owned(log(1_600_000))];
        let parts = Parts::of([&logs, &[]], &options);
        for (set, quarters) in [(0, 3), (1, 1)] {
            let pieces = parts.searched(set, &options);
            assert_eq!(pieces.len(), SECTIONS);
            let length = quarters * options.searched_samples / 4 / SECTIONS;
            assert!(pieces.iter().all(|piece| piece.evaluated.len().abs_diff(length) <= 1));
            // Within a stretch the axis moves in at least half of the time: amplitude 1 mm, 0.02 rad per sample.
            let values = logs[0].axes[0].motor.as_ref().unwrap();
            let least = 0.45 * length as f64 * 0.02 * 2.0 / std::f64::consts::PI;
            assert!(pieces.iter().all(|piece| path(&values[piece.evaluated.clone()]) > least));
        }
    }

    #[test]
    fn a_lead_in_reaches_back_to_a_motion() {
        let log = log(20_000);
        // At rest from 1000 to 2000: one second before 2000 is at rest, two seconds contain motion.
        assert_eq!((lead_in(&log, 2000), lead_in(&log, 2500), lead_in(&log, 300)), (2000, 1000, 300));
    }
}
