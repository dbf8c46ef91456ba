//! The remaining residual, and the physical variable that explains most of it.

use super::binned_mean::BinnedMean;
use super::fitted_bump::fitted_bump;
use super::variable::Variable;
use crate::fit::exclusion::{ExcludedPart, Exclusion};
use crate::fit::fit_data::{FitData, ResidualSeries};
use model::effects::Stage;
use numerics::spectrum::PowerSpectrum;

/// Number of bins on each side of a spectral peak that belong to it, in a log as long as the transform.
const PEAK_HALF_BINS: usize = 2;

/// The unexplained residual of one stage.
#[derive(Clone, Debug, PartialEq)]
pub struct UnexplainedResidual {
    /// Stage.
    pub stage: Stage,
    /// Axis.
    pub axis: String,
    /// Rms on the fit logs, in the unit of the stage's residual; its JSON key contains the unit.
    pub rms: f64,
    /// Fraction of the mean square that the variable explains, percent.
    pub share_percent: f64,
    /// The variable that explains most.
    pub variable: Variable,
    /// Frequency of the vibration, if the variable is `time`.
    pub frequency_hz: Option<f64>,
    /// Position of the largest residual, if the variable is `position`.
    pub centre_mm: Option<f64>,
}

/// The part of a residual that a variable explains.
struct Explanation {
    variable: Variable,
    fraction: f64,
    frequency_hz: Option<f64>,
    centre_mm: Option<f64>,
}

/// The unexplained residual of a stage with this noise, or `None` if the residual is within the noise.
#[must_use]
pub fn unexplained(
    data: &FitData<'_>,
    residuals: &[ResidualSeries],
    stage: Stage,
    noise: f64,
) -> Option<UnexplainedResidual> {
    let options = &data.options.analysis;
    let rms = data.rms(residuals, stage);
    if rms < options.max_noise_ratio * noise {
        return None;
    }
    let of_stage: Vec<&ResidualSeries> = residuals.iter().filter(|series| series.stage == stage).collect();
    let mut best = best_explanation(data, &of_stage);
    if best.fraction < options.min_fraction {
        best = Explanation { variable: Variable::None, frequency_hz: None, centre_mm: None, ..best };
    }
    Some(UnexplainedResidual {
        stage,
        axis: data.name().to_owned(),
        rms,
        share_percent: 100.0 * best.fraction.max(0.0),
        variable: best.variable,
        frequency_hz: best.frequency_hz,
        centre_mm: best.centre_mm,
    })
}

/// The variable that explains most of a stage's residuals.
fn best_explanation(data: &FitData<'_>, residuals: &[&ResidualSeries]) -> Explanation {
    let none = Explanation { variable: Variable::None, fraction: 0.0, frequency_hz: None, centre_mm: None };
    let vibration = vibration(data, residuals).map(|(frequency_hz, fraction)| Explanation {
        variable: Variable::Time,
        fraction,
        frequency_hz: Some(frequency_hz),
        centre_mm: None,
    });
    let mut best = vibration.unwrap_or(none);
    for variable in [
        Variable::Position,
        Variable::Velocity,
        Variable::Acceleration,
        Variable::Direction,
        Variable::Force,
        Variable::OtherPosition,
        Variable::OtherAcceleration,
    ] {
        let Some(mean) = BinnedMean::of(data, residuals, variable) else { continue };
        if mean.fraction > best.fraction {
            let centre_mm = (variable == Variable::Position).then_some(mean.centre);
            best = Explanation { variable, fraction: mean.fraction, frequency_hz: None, centre_mm };
        }
    }
    best
}

impl UnexplainedResidual {
    /// The exclusion of this part from the residuals in which it was found, if it is a vibration or a local defect of table or
    /// tool and large enough.
    #[must_use]
    pub fn exclusion(
        &self,
        data: &FitData<'_>,
        residuals: &[ResidualSeries],
        noise: f64,
    ) -> Option<Exclusion> {
        let options = &data.options.exclusion;
        let is_of_structure = matches!(self.stage, Stage::Table | Stage::Tool);
        if !is_of_structure
            || self.share_percent < 100.0 * options.min_fraction
            || self.rms < options.min_noise_ratio * noise
        {
            return None;
        }
        let part = match self.variable {
            Variable::Time => ExcludedPart::Sine { frequency_hz: self.frequency_hz? },
            Variable::Position => {
                let of_stage: Vec<&ResidualSeries> =
                    residuals.iter().filter(|series| series.stage == self.stage).collect();
                let mean = BinnedMean::of(data, &of_stage, Variable::Position)?;
                if let Some(bump) = fitted_bump(&mean, options.min_bump_fraction) {
                    ExcludedPart::Bump(bump)
                } else {
                    let [from_mm, to_mm] = mean.local_defect(options.edge, options.max_width)?;
                    ExcludedPart::Position { from_mm, to_mm }
                }
            }
            _ => return None,
        };
        Some(Exclusion { stage: self.stage, part })
    }
}

/// The strongest line in the spectrum of all logs: its frequency and its fraction of Σr².
fn vibration(data: &FitData<'_>, residuals: &[&ResidualSeries]) -> Option<(f64, f64)> {
    let longest = residuals.iter().map(|series| series.values.len()).max()?;
    let sample_s = data.logs.first()?.sample_s;
    // All logs are padded to the same length, so that their spectra have the same bins.
    let length = longest.next_power_of_two();
    let spectrum = PowerSpectrum::new(length);
    let mut power = vec![0.0; length / 2];
    let mut total = 0.0;
    for series in residuals {
        total += series.values.iter().map(|r| r * r).sum::<f64>();
        for (sum, value) in power.iter_mut().zip(spectrum.of(&series.values)) {
            *sum += value;
        }
    }
    let hertz = 1.0 / (length as f64 * sample_s);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin number")]
    let first = (data.options.analysis.min_frequency_hz / hertz).ceil() as usize;
    let (peak, _) = power.iter().enumerate().skip(first).max_by(|a, b| a.1.total_cmp(b.1))?;
    // The width of a line is determined by the shortest log.
    let shortest = residuals.iter().map(|series| series.values.len()).min()?.max(1);
    let half = PEAK_HALF_BINS * length.div_ceil(shortest);
    let around = peak.saturating_sub(half)..(peak + half + 1).min(power.len());
    let line: f64 = power[around.clone()].iter().sum();
    let weighted: f64 = around.map(|bin| bin as f64 * power[bin]).sum();
    // Parseval: Σr² is the sum over both sides of the spectrum, divided by its length.
    Some((
        hertz * weighted / line.max(f64::MIN_POSITIVE),
        2.0 * line / length as f64 / total.max(f64::MIN_POSITIVE),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::signals::Signals;
    use crate::options::TraceOptions;
    use files::log::{AxisLog, Log, Unit};
    use shared::config::Rates;

    /// 10 s at 1 kHz of an axis that moves back and forth over 100 mm.
    fn signals() -> Signals {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let at = |i: u32| 50.0 * (f64::from(i) * 1e-3 * 0.7).sin();
        axis.table = Some((0..10_000).map(at).collect());
        let log = Log::new("test", 0.0, 1e-3, [axis]);
        Signals::new(&log, &["x".to_owned()], &TraceOptions::default().samples)
    }

    fn analysed(residual: impl Fn(u32, f64) -> f64) -> UnexplainedResidual {
        let logs = [signals()];
        let names = ["x".to_owned()];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let options = TraceOptions::default();
        let data = FitData::new(&logs, &names, 0, rates, &options);
        let positions = &logs[0].axes[0].table.as_ref().unwrap().value;
        let values = positions.iter().zip(0..).map(|(m, i)| residual(i, 1e3 * m)).collect();
        let residuals = [ResidualSeries { stage: Stage::Tool, log: 0, values }];
        unexplained(&data, &residuals, Stage::Tool, 0.01).unwrap()
    }

    #[test]
    fn a_vibration_is_reported_with_its_frequency() {
        let found = analysed(|i, _| (std::f64::consts::TAU * 61.2e-3 * f64::from(i)).sin());
        assert_eq!(found.variable, Variable::Time);
        assert!((found.frequency_hz.unwrap() - 61.2).abs() < 0.1, "{found:?}");
        assert!(found.share_percent > 90.0 && found.share_percent < 101.0, "{found:?}");
        // A sine of amplitude 1 over all samples after the settling.
        assert!((found.rms - 0.5f64.sqrt()).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn a_local_defect_is_reported_with_its_position() {
        let found = analysed(|_, mm| (-((mm - 20.0) / 3.0).powi(2)).exp());
        assert_eq!(found.variable, Variable::Position);
        // A bin of a 64th of 100 mm is 1.6 mm wide.
        assert!((found.centre_mm.unwrap() - 20.0).abs() < 1.6, "{found:?}");
    }

    #[test]
    fn a_residual_within_its_noise_is_not_reported() {
        let logs = [signals()];
        let names = ["x".to_owned()];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let options = TraceOptions::default();
        let data = FitData::new(&logs, &names, 0, rates, &options);
        let residuals = [ResidualSeries { stage: Stage::Tool, log: 0, values: vec![0.1; 10_000] }];
        assert_eq!(unexplained(&data, &residuals, Stage::Tool, 0.1), None);
    }
}
