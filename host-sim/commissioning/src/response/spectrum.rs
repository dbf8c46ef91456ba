//! Recordings of one group of tones to force and position at each of them.

use std::f64::consts::TAU;

use nalgebra::Complex;
use shared::excitation::{Excitation, ExcitationProblem, ExcitationSettings};
use shared::scalar::{Fixed, Scalar};

/// A recording of a period and one more tick, by which a drift is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Tick of the first sample since the start of the board.
    pub start_tick: u64,
    /// Motor readings, m.
    pub motor_m: Vec<f64>,
    /// Readings of the linear scale, m; `None`: a signal was missing.
    pub table_m: Option<Vec<f64>>,
    /// Forces that acted during the tick before each sample, N.
    pub force_n: Vec<f64>,
}

/// What the recordings have at one frequency: amplitudes in phase with the excitation, whose phase is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the excitation, N.
    pub excitation_n: f64,
    /// Force, N.
    pub force_n: Complex<f64>,
    /// Motor, m.
    pub motor_m: Complex<f64>,
    /// Table, m; `None`: without a scale.
    pub table_m: Option<Complex<f64>>,
    /// The part of the power of the motor at this frequency that is in phase with the excitation from period to period, 0 to 1; 1 for a
    /// single period.
    pub coherence: f64,
}

/// The lines of a group, one for each tone, from its recordings at `tick_hz`.
///
/// # Errors
/// [`ExcitationProblem`] for settings that are no excitation.
pub fn lines(
    settings: &ExcitationSettings,
    records: &[Record],
    tick_hz: f64,
) -> Result<Vec<Line>, ExcitationProblem> {
    let excitation = Excitation::<Fixed>::new(settings)?;
    let period = usize::from(settings.period_ticks);
    let excitations: Vec<Vec<f64>> = records
        .iter()
        .map(|record| {
            // A force that is computed in one tick is recorded in the next one, in which it has acted.
            let before = record.start_tick.wrapping_sub(1);
            (before..).take(period).map(|tick| excitation.force(tick).value()).collect()
        })
        .collect();
    let lines = settings.harmonics.iter().map(|harmonic| {
        let harmonic = usize::from(*harmonic);
        let of = |values: &[f64]| coefficient(values, period, harmonic);
        let at = |values: &[f64]| of_positions(values, period, harmonic);
        let references: Vec<Complex<f64>> = excitations.iter().map(|values| of(values)).collect();
        let mean = |values: &dyn Fn(&Record) -> Complex<f64>| {
            let turned = records
                .iter()
                .zip(&references)
                .map(|(record, reference)| values(record) * reference.conj() / reference.norm());
            turned.sum::<Complex<f64>>() / records.len() as f64
        };
        let motor_m = mean(&|record| at(&record.motor_m));
        let power: f64 = records.iter().map(|record| at(&record.motor_m).norm_sqr()).sum();
        let has_scale = records.iter().all(|record| record.table_m.is_some());
        Line {
            frequency_hz: tick_hz * harmonic as f64 / period as f64,
            excitation_n: references.iter().map(|reference| reference.norm()).sum::<f64>()
                / records.len() as f64,
            force_n: mean(&|record| of(&record.force_n)),
            motor_m,
            table_m: has_scale.then(|| mean(&|record| at(record.table_m.as_deref().unwrap_or_default()))),
            coherence: if power > 0.0 { motor_m.norm_sqr() * records.len() as f64 / power } else { 0.0 },
        }
    });
    Ok(lines.collect())
}

/// The complex amplitude of a harmonic of the first `period` positions. The way from the first one to that after a period is a drift, no part
/// of something periodic: it is taken off as a straight line.
fn of_positions(values: &[f64], period: usize, harmonic: usize) -> Complex<f64> {
    let first = values.first().copied().unwrap_or(0.0);
    let slope = values.get(period).map_or(0.0, |after| (after - first) / period as f64);
    let level: Vec<f64> =
        values.iter().take(period).enumerate().map(|(n, value)| value - first - slope * n as f64).collect();
    coefficient(&level, period, harmonic)
}

/// The complex amplitude of a harmonic of the first `period` values. For forces: they jump from tick to tick, by counts of the encoder and by
/// the ticks of the position loop, so that two of them tell no drift.
fn coefficient(values: &[f64], period: usize, harmonic: usize) -> Complex<f64> {
    let sum: Complex<f64> = values
        .iter()
        .take(period)
        .enumerate()
        .map(|(n, value)| {
            let (sine, cosine) = libm::sincos(TAU * (harmonic * n % period) as f64 / period as f64);
            Complex::new(cosine, -sine) * *value
        })
        .sum();
    sum * (2.0 / period as f64)
}
