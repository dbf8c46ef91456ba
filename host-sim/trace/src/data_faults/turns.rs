//! The instants at which axes turn over.

use super::channels;
use crate::input::encoder_step::encoder_step;
use files::log::Log;

/// Smallest motion on each side of a reversal: mm, in standard deviations of the noise, and in steps of an encoder, which may change to and fro by
/// one while the axis stands.
const MIN_MOVE_MM: f64 = 2e-4;
const MIN_MOVE_NOISE: f64 = 10.0;
const MIN_MOVE_STEPS: f64 = 2.0;
/// Samples on each side of a reversal in which the axis moves by that much.
const AROUND: usize = 50;
/// Samples by which a jump may be beside a reversal.
const BESIDE: usize = 2;

/// The motions of the axes of a log, to find their reversals.
pub struct Turns<'a>(Vec<Motion<'a>>);

/// A position reading of an axis.
struct Motion<'a> {
    values_mm: &'a [f64],
    /// What counts as a motion, mm.
    min_move_mm: f64,
}

impl<'a> Turns<'a> {
    /// The motions of all axes of a log: those of the table, or of the next channel before it.
    #[must_use]
    pub fn of(log: &'a Log) -> Self {
        let reading = log
            .axes
            .iter()
            .filter_map(|axis| axis.table.as_ref().or(axis.motor.as_ref()).or(axis.command.as_ref()));
        Self(reading.map(|values_mm| Motion::of(values_mm)).collect())
    }

    /// Whether an axis turns over at a sample or beside it. An axis that overshoots when it stops does so twice within some milliseconds.
    #[must_use]
    pub fn are_at(&self, sample: usize) -> bool {
        let beside = sample.saturating_sub(BESIDE)..=sample + BESIDE;
        self.0.iter().any(|motion| beside.clone().any(|sample| motion.turns_at(sample)))
    }
}

impl<'a> Motion<'a> {
    fn of(values_mm: &'a [f64]) -> Self {
        let step_mm = encoder_step(values_mm).unwrap_or(0.0);
        let min_move_mm =
            MIN_MOVE_MM.max(MIN_MOVE_NOISE * channels::noise(values_mm)).max(MIN_MOVE_STEPS * step_mm);
        Self { values_mm, min_move_mm }
    }

    /// Whether the last motion before a sample and the first one after it have opposite directions.
    fn turns_at(&self, sample: usize) -> bool {
        let Some(now) = self.values_mm.get(sample) else { return false };
        let end = self.values_mm.len().min(sample + 1 + AROUND);
        let (before, after) =
            (&self.values_mm[sample.saturating_sub(AROUND)..sample], &self.values_mm[sample + 1..end]);
        let is_move = |mm: &f64| mm.abs() > self.min_move_mm;
        let back = before.iter().rev().map(|mm| now - mm).find(is_move);
        let on = after.iter().map(|mm| mm - now).find(is_move);
        back.zip(on).is_some_and(|(back, on)| back * on < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};

    fn log(values_mm: Vec<f64>) -> Log {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.table = Some(values_mm);
        Log::new("l", 0.0, 1e-3, [axis])
    }

    /// A stop at sample 500 with an overshoot e^(−t/τ)·sin ωt of 25 Hz: it turns over where tan ωt = ωτ, at 8.0 ms and each half period of 20 ms
    /// after that, with 6, 2 and 0.8 µm.
    #[test]
    fn each_reversal_of_an_overshoot_counts() {
        let (omega, tau_s) = (157.0_f64, 0.02_f64);
        let at = |i: i32| {
            let t_s = f64::from(i - 500) * 1e-3;
            if t_s < 0.0 { 9e-3 * omega * t_s } else { 9e-3 * (-t_s / tau_s).exp() * (omega * t_s).sin() }
        };
        let log = log((0..1000).map(at).collect());
        let turns = Turns::of(&log);
        for reversal in [508, 528, 548] {
            assert!(turns.are_at(reversal), "{reversal}");
            assert!(!turns.are_at(reversal + 10), "{reversal}");
        }
        assert!(!turns.are_at(480) && !turns.are_at(900));
    }

    /// Steps of 1 µm that alternate while the axis stands, and a motion through them.
    #[test]
    fn an_encoder_that_changes_by_one_step_does_not_turn_over() {
        let at = |i: i32| 1e-3 * f64::from(if i < 600 { i % 2 } else { (i - 600) / 3 });
        let log = log((0..1200).map(at).collect());
        let turns = Turns::of(&log);
        assert!((0..1200).all(|sample| !turns.are_at(sample)));
    }

    #[test]
    fn a_reversal_of_a_circle_counts_and_full_speed_does_not() {
        let log = log((0..6000).map(|i| 20.0 * (3e-3 * f64::from(i)).sin()).collect());
        let turns = Turns::of(&log);
        assert!(turns.are_at(524) && turns.are_at(1571));
        assert!(!turns.are_at(474) && !turns.are_at(1047));
    }
}
