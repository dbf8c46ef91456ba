//! Which tones are measured: logarithmically spaced harmonics of a period that is a power of two ticks, in groups that act at once.

use shared::excitation::{ExcitationSettings, LONGEST_PERIOD_TICKS, SHORTEST_PERIOD_TICKS, TONES};

/// Highest frequency over the tick rate: beyond it the hold of the force takes most of it.
const HIGHEST: f64 = 0.4;

/// What is to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lowest frequency, Hz.
    pub from_hz: f64,
    /// Highest frequency, Hz.
    pub to_hz: f64,
    /// Number of tones; fewer where two of them are the same harmonic.
    pub tones: usize,
    /// Tones that act at once, 1 to [`TONES`].
    pub at_once: usize,
}

/// The tones of a measurement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Period, ticks.
    pub period_ticks: u16,
    /// The harmonics of each group, ascending.
    pub groups: Vec<Vec<u16>>,
}

/// Why there is no plan.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The lowest frequency is outside its range.
    #[error(
        "expected at least {least_hz:.3} Hz, a period of {LONGEST_PERIOD_TICKS} ticks, and less than --to-hz"
    )]
    From {
        /// Lowest frequency that can be measured, Hz.
        least_hz: f64,
    },
    /// The highest frequency is outside its range.
    #[error("expected up to {most_hz} Hz, 0.4 times the tick rate")]
    To {
        /// Highest frequency that can be measured, Hz.
        most_hz: f64,
    },
    /// The number of tones, or that of tones at once, is outside its range.
    #[error("expected 2 to 200 tones, and 1 to {TONES} of them at once")]
    Tones,
}

impl Plan {
    /// The plan for a range at a tick rate, Hz. The tones of a group are spread over the whole range.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn new(range: &Range, tick_hz: f64) -> Result<Self, PlanError> {
        let Range { from_hz, to_hz, tones, at_once } = *range;
        let least_hz = tick_hz / f64::from(LONGEST_PERIOD_TICKS);
        if !(from_hz >= least_hz && from_hz < to_hz) {
            return Err(PlanError::From { least_hz });
        }
        if to_hz > HIGHEST * tick_hz {
            return Err(PlanError::To { most_hz: HIGHEST * tick_hz });
        }
        if !(2..=200).contains(&tones) || !(1..=TONES).contains(&at_once) {
            return Err(PlanError::Tones);
        }
        let mut period_ticks = SHORTEST_PERIOD_TICKS;
        while tick_hz / f64::from(period_ticks) > from_hz {
            period_ticks *= 2;
        }
        let line_hz = tick_hz / f64::from(period_ticks);
        let ratio = libm::log(to_hz / from_hz) / (tones - 1) as f64;
        let mut harmonics: Vec<u16> = (0..tones)
            .map(|tone| {
                let harmonic = from_hz / line_hz * libm::exp(ratio * tone as f64);
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 0.4·8192")]
                let harmonic = harmonic.round().max(1.0) as u16;
                harmonic
            })
            .collect();
        harmonics.dedup();
        let count = harmonics.len().div_ceil(at_once);
        let groups = (0..count).map(|group| harmonics.iter().skip(group).step_by(count).copied().collect());
        Ok(Self { period_ticks, groups: groups.collect() })
    }

    /// Number of tones.
    #[must_use]
    pub fn tones(&self) -> usize {
        self.groups.iter().map(Vec::len).sum()
    }

    /// The force of a group; `force_n` is the sum of its amplitudes, N.
    #[must_use]
    pub fn excitation(&self, group: &[u16], axis: u8, force_n: f64) -> ExcitationSettings {
        let harmonics = group.iter().copied().take(TONES).collect();
        ExcitationSettings { axis, force_n, period_ticks: self.period_ticks, harmonics }
    }
}
