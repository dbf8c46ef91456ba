//! The part of a residual that repeats with the motion. A model of the machine can explain only this part.
//!
//! If the command is periodic, the mean of the residual over the periods is its repeatable part. The differences between the
//! periods are noise or changes of the machine.

use crate::fit::fit_data::{FitData, ResidualSeries};
use crate::options::AnalysisOptions;
use model::effects::Stage;

/// The repeatable and the non-repeatable part of a stage's residual.
#[derive(Clone, Debug, PartialEq)]
pub struct Repeatability {
    /// Stage.
    pub stage: Stage,
    /// Axis.
    pub axis: String,
    /// Period of the command, s.
    pub period_s: f64,
    /// Rms of the mean over the periods, in the unit of the residual; its JSON key contains the unit.
    pub repeatable: f64,
    /// Rms of the difference of one period from that mean.
    pub non_repeatable: f64,
}

/// Period of a command up to the end of the log, samples; `None` if it is longer than half of the log, or if the command
/// is constant.
#[must_use]
pub fn period(command: &[f64], sample_s: f64, options: &AnalysisOptions) -> Option<usize> {
    let [min, max] = numerics::min_max(command.iter().copied());
    let tolerance = options.command_tolerance * (max - min);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "samples of a fifth of a second"
    )]
    let shortest = ((options.min_period_s / sample_s).ceil() as usize).max(1);
    // A dwell is periodic with any period. Therefore a period must contain both ends of the travel.
    let contains_both_ends = |period: usize| {
        let lap = &command[..period];
        lap.iter().any(|m| m - min <= tolerance) && lap.iter().any(|m| max - m <= tolerance)
    };
    let repeats = |&period: &usize| {
        command.iter().zip(&command[period..]).all(|(a, b)| (a - b).abs() <= tolerance)
            && contains_both_ends(period)
    };
    (tolerance > 0.0).then(|| (shortest..=command.len() / 2).find(repeats)).flatten()
}

/// Splits the residual of a stage over the logs with a periodic command.
#[must_use]
pub fn repeatability(
    data: &FitData<'_>,
    residuals: &[ResidualSeries],
    stage: Stage,
) -> Option<Repeatability> {
    let (mut of_means, mut within, mut phases, mut degrees_of_freedom) = (0.0, 0.0, 0usize, 0usize);
    let mut period_s = None;
    for series in residuals.iter().filter(|series| series.stage == stage) {
        let log = &data.logs[series.log];
        let command = log.axes[data.axis].command.as_ref()?;
        let Some(lap) = period(command, log.sample_s, &data.options.analysis) else { continue };
        let counts = data.counting(stage, series.log);
        for phase in 0..lap {
            let counting =
                (phase..series.values.len()).step_by(lap).filter(|&i| counts(i)).map(|i| series.values[i]);
            let values: Vec<f64> = counting.collect();
            if values.len() < 2 {
                continue;
            }
            let laps = values.len() as f64;
            let mean = numerics::mean(values.iter().copied());
            let scatter = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
            // The square of the mean less the variance of the mean, which is the variance of the laps divided by their number.
            of_means += mean * mean - scatter / (laps * (laps - 1.0));
            within += scatter;
            degrees_of_freedom += values.len() - 1;
            phases += 1;
        }
        period_s.get_or_insert(lap as f64 * log.sample_s);
    }
    (phases > 0).then(|| Repeatability {
        stage,
        axis: data.name().to_owned(),
        period_s: period_s.unwrap_or(0.0),
        repeatable: (of_means / phases as f64).max(0.0).sqrt(),
        non_repeatable: (within / degrees_of_freedom as f64).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::signals::Signals;
    use crate::options::TraceOptions;
    use files::log::{AxisLog, Log, Unit};
    use shared::config::Rates;

    /// Command, m: a dwell of 0.3 s, then back and forth over 10 mm in 0.8 s, repeatedly.
    fn command(i: usize) -> f64 {
        let t = 1e-3 * (i % 1100) as f64;
        if t < 0.3 { 0.0 } else { 0.005 * (1.0 - (std::f64::consts::TAU * (t - 0.3) / 0.8).cos()) }
    }

    #[test]
    fn the_period_is_not_confused_with_the_dwell() {
        let options = AnalysisOptions::default();
        let long: Vec<f64> = (0..4000).map(command).collect();
        assert_eq!(period(&long, 1e-3, &options), Some(1100));
        assert_eq!(period(&long[..2100], 1e-3, &options), None, "less than two laps");
        assert_eq!(period(&vec![0.0; 4000], 1e-3, &options), None, "a standstill");
        let growing: Vec<f64> = (0..4000).map(|i| command(i) + 1e-7 * i as f64).collect();
        assert_eq!(period(&growing, 1e-3, &options), None, "a drift");
    }

    #[test]
    fn a_residual_is_split_into_a_repeatable_and_a_non_repeatable_part() {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.command = Some((0..11_000).map(|i| 1e3 * command(i)).collect());
        axis.motor = axis.command.clone();
        let log = Log::new("test", 0.0, 1e-3, [axis]);
        let names = ["x".to_owned()];
        let options = TraceOptions::default();
        let logs = [Signals::new(&log, &names, &options.samples)];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let data = FitData::new(&logs, &names, 0, rates, &options);
        // A sine over the period with an rms of 3, and ±1 in alternate periods, five of each, whose variance is 10/9.
        let value = |i: usize| {
            let wave = 3.0 * 2.0f64.sqrt() * (std::f64::consts::TAU * (i % 1100) as f64 / 1100.0).sin();
            wave + if (i / 1100).is_multiple_of(2) { 1.0 } else { -1.0 }
        };
        let residuals =
            [ResidualSeries { stage: Stage::Motor, log: 0, values: (0..11_000).map(value).collect() }];
        let split = repeatability(&data, &residuals, Stage::Motor).unwrap();
        // The signs alternate and cancel in the mean, while the correction assumes random signs: this lowers the square of 9
        // by 0.11. Where the settling excludes the first of ten periods, the mean of the signs is −1/9, which lowers it by
        // another 0.17. Together this is 1.6 % of 3.
        assert!((split.repeatable - 2.953).abs() < 0.003, "{split:?}");
        assert!((split.non_repeatable - (10.0f64 / 9.0).sqrt()).abs() < 0.02, "{split:?}");
        assert!((split.period_s - 1.1).abs() < 1e-12);
    }
}
