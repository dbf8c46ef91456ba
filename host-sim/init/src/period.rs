//! Errors that repeat over the position: the only trace that the lead of a screw leaves in a log.

use model::effects::{Stage, WaveOf};
use trace::Identification;
use trace::search::position_spectrum::waves;
use trace::search::residual_samples::samples;

/// Part of the squares of a residual that a wave must be.
const MIN_SHARE: f64 = 0.2;

/// Times the noise from which a residual is looked at: below, a wave is one of the noise.
const MIN_OVER_NOISE: f64 = 1.5;

/// Period, mm, and amplitude, µm, of the strongest error that repeats over the position; `None` if none stands out.
#[must_use]
pub fn strongest(trace: &Identification, axis: usize) -> Option<[f64; 2]> {
    let of_axis = trace.axes().get(axis)?;
    let residual = of_axis.residual(Stage::Table)?;
    if residual.after.fit < MIN_OVER_NOISE * residual.noise {
        return None;
    }
    let scope = of_axis.scopes.iter().find(|scope| scope.stages.contains(&Stage::Table))?;
    let data = trace.data(trace.fit_logs(), axis);
    let samples = samples(&data, &data.residuals(&of_axis.model, scope), Stage::Table);
    let travel_mm = numerics::min_max(samples.iter().map(|sample| sample.position_mm));
    let found = waves(WaveOf::Table, &samples, travel_mm, MIN_SHARE);
    found.first().map(|wave| [wave.period_mm, wave.amplitude])
}
