//! What stays, and which physical variable it follows best.

use numerics::bins::{Bin, binned};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use serde::Serialize;

use super::residual::{Evidence, Part, rms};
use super::signals::Smooth;
use model::effects::Stage;

/// Bins over the range of a variable.
const BINS: usize = 64;

/// A residual within this of its noise is noise.
const ABOVE_NOISE: f64 = 1.15;

/// A variable that explains less than this share of the residual is not named.
const LEAST_SHARE: f64 = 0.1;

/// Slower than this is drift, not a vibration, Hz.
const LEAST_FREQUENCY_HZ: f64 = 2.0;

/// Share of the residual's power in the bins next to a spectral peak that belong to it.
const PEAK_HALF_BINS: usize = 2;

/// The remainder of one stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unexplained {
    /// Stage.
    pub channel: Stage,
    /// Axis.
    pub axis: String,
    /// What remains on the fit logs, in the unit of the stage's residual; written under its name.
    #[serde(skip)]
    pub rms: f64,
    /// Share of its square that the variable explains.
    pub share_percent: f64,
    /// What it follows best.
    pub variable: Variable,
    /// For `time`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frequency_hz: Option<f64>,
    /// For `position`: where it is largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub centre_mm: Option<f64>,
}

/// A physical variable that a residual may follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Variable {
    /// A frequency that belongs to nothing that moves.
    Time,
    /// Place on the axis.
    Position,
    /// Of the axis.
    Velocity,
    /// Of the axis.
    Acceleration,
    /// Sign of the velocity.
    Direction,
    /// Of the drive.
    Force,
    /// Place on the other axis.
    OtherPosition,
    /// Of the other axis.
    OtherAcceleration,
    /// None of these.
    None,
}

/// The remainder of a stage, or `None` where only noise is left.
#[must_use]
pub fn unexplained(
    evidence: &Evidence<'_>,
    parts: &[Part],
    stage: Stage,
    noise: f64,
    axis: &str,
) -> Option<Unexplained> {
    let remains = rms(parts, stage, evidence);
    if remains < ABOVE_NOISE * noise {
        return None;
    }
    let parts: Vec<&Part> = parts.iter().filter(|part| part.stage == stage).collect();
    let mut best = (Variable::None, 0.0, None, None);
    if let Some((frequency_hz, share)) = vibration(evidence, &parts) {
        best = (Variable::Time, share, Some(frequency_hz), None);
    }
    for variable in [
        Variable::Position,
        Variable::Velocity,
        Variable::Acceleration,
        Variable::Direction,
        Variable::Force,
        Variable::OtherPosition,
        Variable::OtherAcceleration,
    ] {
        let Some(curve) = Curve::of(evidence, &parts, variable) else { continue };
        if curve.share > best.1 {
            let centre_mm = (variable == Variable::Position).then_some(curve.centre);
            best = (variable, curve.share, None, centre_mm);
        }
    }
    let (variable, share, frequency_hz, centre_mm) =
        if best.1 < LEAST_SHARE { (Variable::None, best.1, None, None) } else { best };
    Some(Unexplained {
        channel: stage,
        axis: axis.to_owned(),
        rms: remains,
        share_percent: 100.0 * share.max(0.0),
        variable,
        frequency_hz,
        centre_mm,
    })
}

/// Values of a variable over one log, if it was measured. Positions in mm.
pub(super) fn values(evidence: &Evidence<'_>, log: usize, variable: Variable) -> Option<Vec<f64>> {
    let axes = &evidence.logs[log].axes;
    let own = &axes[evidence.axis];
    let other = axes.iter().enumerate().find(|(i, _)| *i != evidence.axis).map(|(_, axis)| axis);
    let millimetres = |smooth: &Smooth| smooth.position.iter().map(|m| 1e3 * m).collect();
    match variable {
        Variable::Position => own.table_or_motor().map(millimetres),
        Variable::Velocity => own.table_or_motor().map(|smooth| smooth.velocity.clone()),
        Variable::Acceleration => own.table_or_motor().map(|smooth| smooth.acceleration.clone()),
        Variable::Direction => own.table_or_motor().map(|smooth| {
            // Slower than this the direction is noise.
            const MOVING_M_PER_S: f64 = 1e-4;
            let sign = |v: &f64| if v.abs() < MOVING_M_PER_S { 0.0 } else { v.signum() };
            smooth.velocity.iter().map(sign).collect()
        }),
        Variable::Force => own.force.as_ref().map(|force| force.position.clone()),
        Variable::OtherPosition => other?.table_or_motor().map(millimetres),
        Variable::OtherAcceleration => other?.table_or_motor().map(|smooth| smooth.acceleration.clone()),
        Variable::Time | Variable::None => None,
    }
}

/// Mean residual over the range of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Middle of each bin that holds samples, and the mean residual there.
    pub points: Vec<(f64, f64)>,
    /// Share of Σr² that the curve explains, corrected for the number of bins.
    pub share: f64,
    /// Where the curve is farthest from its median.
    pub centre: f64,
}

impl Curve {
    /// The curve of a stage's residual over a variable; `None` if that was not measured or never moves.
    #[must_use]
    pub fn of(evidence: &Evidence<'_>, parts: &[&Part], variable: Variable) -> Option<Self> {
        let mut pairs = Vec::new();
        for part in parts {
            let values = values(evidence, part.log, variable)?;
            let settling = evidence.settling(part.log);
            pairs.extend(values.into_iter().zip(part.values.iter().copied()).skip(settling));
        }
        let mut used = binned(&pairs, BINS)?;
        used.retain(|bin| bin.count > 0);
        let total: f64 = pairs.iter().map(|(_, residual)| residual * residual).sum();
        let explained: f64 = used.iter().map(|bin| bin.count as f64 * bin.mean() * bin.mean()).sum();
        let free = pairs.len() as f64 - used.len() as f64;
        let left = (total - explained) / free.max(1.0);
        let means: Vec<f64> = used.iter().map(Bin::mean).collect();
        let median = numerics::median(&means)?;
        let off = |bin: &Bin| (bin.mean() - median).abs();
        let farthest = used.iter().max_by(|a, b| off(a).total_cmp(&off(b)));
        Some(Self {
            points: used.iter().map(|bin| (bin.centre, bin.mean())).collect(),
            share: 1.0 - left / (total / pairs.len().max(1) as f64).max(f64::MIN_POSITIVE),
            centre: farthest.map_or(0.0, |bin| bin.centre),
        })
    }
}

impl Curve {
    /// Ends of the one spot where the curve lies beyond `edge` of its greatest distance from its median, on the same
    /// side; `None` if it takes more than `widest` of the range.
    #[must_use]
    pub fn spot(&self, edge: f64, widest: f64) -> Option<[f64; 2]> {
        let values: Vec<f64> = self.points.iter().map(|point| point.1).collect();
        let median = numerics::median(&values)?;
        let from_centre = |point: &(f64, f64)| (point.0 - self.centre).abs();
        let (centre, _) =
            self.points.iter().enumerate().min_by(|a, b| from_centre(a.1).total_cmp(&from_centre(b.1)))?;
        let height = self.points[centre].1 - median;
        let within = |i: &usize| (self.points[*i].1 - median) / height > edge;
        let first = (0..=centre).rev().take_while(within).last()?;
        let last = (centre..self.points.len()).take_while(within).last()?;
        let step = (self.points.last()?.0 - self.points[0].0) / BINS as f64;
        let [from, to] = [self.points[first].0 - step, self.points[last].0 + step];
        (to - from < widest * step * BINS as f64).then_some([from, to])
    }
}

/// The strongest line in the spectrum: its frequency and its share of Σr², over all logs.
fn vibration(evidence: &Evidence<'_>, parts: &[&Part]) -> Option<(f64, f64)> {
    let longest = parts.iter().map(|part| part.values.len()).max()?;
    let sample_s = evidence.logs.first()?.sample_s;
    // One grid for all logs: each is padded to the same length.
    let length = longest.next_power_of_two();
    let fft = FftPlanner::new().plan_fft_forward(length);
    let mut power = vec![0.0; length / 2];
    let mut total = 0.0;
    for part in parts {
        total += part.values.iter().map(|r| r * r).sum::<f64>();
        for (sum, value) in power.iter_mut().zip(spectrum(fft.as_ref(), &part.values, length)) {
            *sum += value;
        }
    }
    let hertz = 1.0 / (length as f64 * sample_s);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a bin number")]
    let first = (LEAST_FREQUENCY_HZ / hertz).ceil() as usize;
    let (peak, _) = power.iter().enumerate().skip(first).max_by(|a, b| a.1.total_cmp(b.1))?;
    // A line is as wide as the shortest log makes it.
    let shortest = parts.iter().map(|part| part.values.len()).min()?.max(1);
    let half = PEAK_HALF_BINS * length.div_ceil(shortest);
    let around = peak.saturating_sub(half)..(peak + half + 1).min(power.len());
    let line: f64 = power[around.clone()].iter().sum();
    let weighted: f64 = around.map(|bin| bin as f64 * power[bin]).sum();
    // Parseval: two sides of the spectrum, divided by its length, make Σr².
    Some((
        hertz * weighted / line.max(f64::MIN_POSITIVE),
        2.0 * line / length as f64 / total.max(f64::MIN_POSITIVE),
    ))
}

fn spectrum(fft: &dyn Fft<f64>, values: &[f64], length: usize) -> Vec<f64> {
    let mean = numerics::mean(values.iter().copied());
    let mut buffer: Vec<Complex<f64>> = values.iter().map(|r| Complex::new(r - mean, 0.0)).collect();
    buffer.resize(length, Complex::default());
    fft.process(&mut buffer);
    buffer[..length / 2].iter().map(Complex::norm_sqr).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Signals;
    use files::log::{AxisLog, Log, Unit};
    use shared::config::Rates;

    /// 10 s at 1 kHz of an axis that goes to and fro over 100 mm.
    fn signals() -> Signals {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let at = |i: u32| 50.0 * (f64::from(i) * 1e-3 * 0.7).sin();
        axis.table = Some((0..10_000).map(at).collect());
        let log = Log { source: "test".to_owned(), start_s: 0.0, sample_time_s: 1e-3, axes: vec![axis] };
        Signals::new(&log, &["x".to_owned()])
    }

    fn what_follows(residual: impl Fn(u32, f64) -> f64) -> Unexplained {
        let logs = [signals()];
        let names = ["x".to_owned()];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let evidence = Evidence { logs: &logs, names: &names, axis: 0, rates, aside: &[], own: &[] };
        let places = &logs[0].axes[0].table.as_ref().unwrap().position;
        let values = places.iter().zip(0..).map(|(m, i)| residual(i, 1e3 * m)).collect();
        let parts = [Part { stage: Stage::Tool, log: 0, values }];
        unexplained(&evidence, &parts, Stage::Tool, 0.01, "x").unwrap()
    }

    #[test]
    fn a_vibration_is_named_by_its_frequency() {
        let found = what_follows(|i, _| (std::f64::consts::TAU * 61.2e-3 * f64::from(i)).sin());
        assert_eq!(found.variable, Variable::Time);
        assert!((found.frequency_hz.unwrap() - 61.2).abs() < 0.1, "{found:?}");
        assert!(found.share_percent > 90.0 && found.share_percent < 101.0, "{found:?}");
        // A sine of amplitude 1 over all but the settling.
        assert!((found.rms - 0.5f64.sqrt()).abs() < 0.02, "{found:?}");
    }

    #[test]
    fn a_local_defect_is_named_by_its_place() {
        let found = what_follows(|_, mm| (-((mm - 20.0) / 3.0).powi(2)).exp());
        assert_eq!(found.variable, Variable::Position);
        // A bin of a 64th of 100 mm is 1.6 mm wide.
        assert!((found.centre_mm.unwrap() - 20.0).abs() < 1.6, "{found:?}");
    }

    #[test]
    fn what_is_within_its_noise_is_not_told() {
        let logs = [signals()];
        let names = ["x".to_owned()];
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let evidence = Evidence { logs: &logs, names: &names, axis: 0, rates, aside: &[], own: &[] };
        let parts = [Part { stage: Stage::Tool, log: 0, values: vec![0.1; 10_000] }];
        assert_eq!(unexplained(&evidence, &parts, Stage::Tool, 0.1, "x"), None);
    }
}
