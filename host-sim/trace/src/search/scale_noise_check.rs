//! Check that a candidate of the tool explains more than the noise of the scale.
//!
//! The tool is predicted from the measured table, whose noise an effect of the acceleration amplifies: an in-talk of 3 µm per m/s² beside a
//! scale with 20 nm leaves nearly the noise of the probe once more. A mode far above the frequencies of the motion adds to such an
//! in-talk, and cancels a part of its noise near its frequency: the residual falls at all times, in held-out motions as well, and
//! the tool has no such mode. The noise of the predictions is computed, and what a candidate removes of it does not count.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::fit::fit_data::FitData;
use crate::fit::least_squares::Fitted;
use crate::fit::scope::Scope;
use crate::input::signals::{AxisSignals, Signals};
use crate::input::smoothing::Smooth;
use model::effects::Stage;
use numerics::squares_of_difference;

/// Seed of the noise that is added to the tables.
const SEED: u64 = 1;

/// Whether a fit with a candidate leaves less of the tool than the fit without it only because its prediction has less noise: without this
/// part, it removes less than a candidate has to.
#[must_use]
pub fn removes_only_noise(data: &FitData<'_>, without: &Fitted, with: &Fitted, scope: &Scope) -> bool {
    if scope.stages != [Stage::Tool] {
        return false;
    }
    let noisy = with_noise(data.logs);
    let noisy = FitData { logs: &noisy, ..*data };
    let of_noise = |fit: &Fitted| {
        let [plain, noisy] = [data, &noisy].map(|data| data.residuals(&fit.model, scope));
        let pairs = plain.iter().zip(&noisy);
        pairs.map(|(plain, noisy)| squares_of_difference(&plain.values, &noisy.values)).collect::<Vec<_>>()
    };
    let noise = [without, with].map(of_noise);
    let residuals = without.residuals.iter().zip(&with.residuals).enumerate();
    let logs = residuals.map(|(log, (without, with))| {
        let [before, after] = [without, with].map(|series| squares(&series.values));
        let removed = before - after - (noise[0][log] - noise[1][log]).max(0.0);
        (without.values.len() as f64, removed / before.max(f64::MIN_POSITIVE))
    });
    let (samples, removed) =
        logs.fold((0.0, 0.0), |(samples, sum), (of_log, removed)| (samples + of_log, sum + of_log * removed));
    removed < data.options.search.min_reduction * samples
}

/// Logs whose tables have their noise once more: any white noise, here of either sign and one size, has the same effect on a sum of squares.
fn with_noise(logs: &[Signals]) -> Vec<Signals> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut noisy = |channel: &Smooth, sample_s: f64| {
        let mut reading =
            |m: &f64| if random.random::<bool>() { m + channel.noise } else { m - channel.noise };
        channel.of_other(channel.raw.iter().map(&mut reading).collect(), sample_s)
    };
    let mut of_axis = |axis: &AxisSignals, sample_s: f64| match (&axis.table, &axis.motor) {
        (Some(table), _) => AxisSignals { table: Some(noisy(table, sample_s)), ..axis.clone() },
        (None, Some(motor)) => AxisSignals { motor: Some(noisy(motor, sample_s)), ..axis.clone() },
        (None, None) => axis.clone(),
    };
    let mut of_log = |log: &Signals| {
        let axes = log.axes.iter().map(|axis| of_axis(axis, log.sample_s)).collect();
        Signals { axes, ..log.clone() }
    };
    logs.iter().map(&mut of_log).collect()
}

fn squares(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}
