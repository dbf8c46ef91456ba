//! What of a residual comes again when the motion does: all that a model of the machine can ever explain.
//!
//! Where the command repeats, the laps of a residual share what the machine does the same way each time.
//! What differs between them is noise, or a machine that has changed.

use serde::Serialize;

use super::residual::{Evidence, Part};
use model::effects::Stage;

/// Shortest period that is looked for, s.
const SHORTEST_S: f64 = 0.2;

/// Two commands are the same within this share of the travel: the last digit of a log.
const SAME: f64 = 1e-7;

/// The two parts of a stage's residual.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeatability {
    /// Stage.
    pub channel: Stage,
    /// Axis.
    pub axis: String,
    /// After which the command comes again, s.
    pub period_s: f64,
    /// What comes again with it, rms, in the unit of the residual; written under its name.
    #[serde(skip)]
    pub repeatable: f64,
    /// What does not, rms of one lap.
    #[serde(skip)]
    pub non_repeatable: f64,
}

/// Samples after which a command comes again, to the end of the log; `None` where it does not within half
/// of it, or where nothing moves.
#[must_use]
pub fn period(command: &[f64], sample_s: f64) -> Option<usize> {
    let [least, most] = numerics::min_max(command.iter().copied());
    let same = SAME * (most - least);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "samples of a fifth of a second"
    )]
    let shortest = ((SHORTEST_S / sample_s).ceil() as usize).max(1);
    // A dwell repeats at once: in a period the command has been everywhere.
    let has_been_everywhere = |period: usize| {
        let lap = &command[..period];
        lap.iter().any(|m| m - least <= same) && lap.iter().any(|m| most - m <= same)
    };
    let comes_again = |&period: &usize| {
        command.iter().zip(&command[period..]).all(|(a, b)| (a - b).abs() <= same)
            && has_been_everywhere(period)
    };
    (same > 0.0).then(|| (shortest..=command.len() / 2).find(comes_again)).flatten()
}

/// Splits the residual of a stage over the logs whose command repeats.
#[must_use]
pub fn repeatability(evidence: &Evidence<'_>, parts: &[Part], stage: Stage) -> Option<Repeatability> {
    let (mut of_means, mut within, mut phases, mut spare) = (0.0, 0.0, 0usize, 0usize);
    let mut period_s = None;
    for part in parts.iter().filter(|part| part.stage == stage) {
        let log = &evidence.logs[part.log];
        let command = log.axes[evidence.axis].command.as_ref()?;
        let Some(lap) = period(command, log.sample_s) else { continue };
        let counts = evidence.counting(stage, part.log);
        for phase in 0..lap {
            let counting =
                (phase..part.values.len()).step_by(lap).filter(|&i| counts(i)).map(|i| part.values[i]);
            let values: Vec<f64> = counting.collect();
            if values.len() < 2 {
                continue;
            }
            let laps = values.len() as f64;
            let mean = numerics::mean(values.iter().copied());
            let scatter = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            // The mean of the laps has 1/laps of their scatter in it.
            of_means += mean * mean - scatter / (laps * (laps - 1.0));
            within += scatter;
            spare += values.len() - 1;
            phases += 1;
        }
        period_s.get_or_insert(lap as f64 * log.sample_s);
    }
    (phases > 0).then(|| Repeatability {
        channel: stage,
        axis: evidence.names[evidence.axis].clone(),
        period_s: period_s.unwrap_or(0.0),
        repeatable: (of_means / phases as f64).max(0.0).sqrt(),
        non_repeatable: (within / spare as f64).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Signals;
    use files::log::{AxisLog, Log, Unit};
    use shared::config::Rates;

    /// To and fro over 10 mm in 0.8 s, with a dwell of 0.3 s in front.
    fn command(i: usize) -> f64 {
        let t = 1e-3 * (i % 1100) as f64;
        if t < 0.3 { 0.0 } else { 0.005 * (1.0 - (std::f64::consts::TAU * (t - 0.3) / 0.8).cos()) }
    }

    #[test]
    fn finds_the_period_and_not_the_dwell() {
        let long: Vec<f64> = (0..4000).map(command).collect();
        assert_eq!(period(&long, 1e-3), Some(1100));
        assert_eq!(period(&long[..2100], 1e-3), None, "less than two laps");
        assert_eq!(period(&vec![0.0; 4000], 1e-3), None, "a standstill");
        let growing: Vec<f64> = (0..4000).map(|i| command(i) + 1e-7 * i as f64).collect();
        assert_eq!(period(&growing, 1e-3), None, "a drift");
    }

    #[test]
    fn splits_what_repeats_from_what_does_not() {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.command = Some((0..11_000).map(|i| 1e3 * command(i)).collect());
        axis.motor = axis.command.clone();
        let log = Log { source: "test".to_owned(), start_s: 0.0, sample_time_s: 1e-3, axes: vec![axis] };
        let names = ["x".to_owned()];
        let logs = [Signals::new(&log, &names)];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let evidence = Evidence { logs: &logs, names: &names, axis: 0, rates, aside: &[], own: &[] };
        // A sine over the lap of 3 rms, and ±1 from lap to lap, five of either: their variance about their mean of
        // 0 is 10/9.
        let value = |i: usize| {
            let wave = 3.0 * 2.0f64.sqrt() * (std::f64::consts::TAU * (i % 1100) as f64 / 1100.0).sin();
            wave + if (i / 1100).is_multiple_of(2) { 1.0 } else { -1.0 }
        };
        let parts = [Part { stage: Stage::Motor, log: 0, values: (0..11_000).map(value).collect() }];
        let split = repeatability(&evidence, &parts, Stage::Motor).unwrap();
        // Laps that alternate leave less in their mean than laps at random, 0.11 of 9, and where the settling takes
        // the first of ten the others' mean is 1/9 off, which takes another 0.17: 1.6 % of 3.
        assert!((split.repeatable - 2.953).abs() < 0.003, "{split:?}");
        assert!((split.non_repeatable - (10.0f64 / 9.0).sqrt()).abs() < 0.02, "{split:?}");
        assert!((split.period_s - 1.1).abs() < 1e-12);
    }
}
