//! Noise that the channels of an axis share.
//!
//! Sensors are independent: what they share is a motion, or the instants at which all of them were read, times the velocity. Little of it is
//! left in their differences, the residuals of table and tool.

use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::FitData;
use crate::fit::scope::Scope;
use model::effects::Stage;

/// Share of the noise below which the residual of a difference of two channels shows that they share their noise. Independent channels
/// with filters and encoder steps leave 0.35 and more, instants that jitter by 20 to 40 µs leave 0.1 and less.
const MIN_OWN_NOISE: f64 = 0.2;

/// Whether the residual of a stage, with this noise of its channels, shows that they share it.
#[must_use]
pub fn is_common(stage: Stage, residual: f64, noise: f64) -> bool {
    matches!(stage, Stage::Table | Stage::Tool) && residual < MIN_OWN_NOISE * noise
}

/// Whether a model leaves so little of a difference of two channels that these share their noise.
#[must_use]
pub fn is_left_out(data: &FitData<'_>, model: &AxisModel, scopes: &[Scope]) -> bool {
    scopes.iter().any(|scope| {
        let residuals = data.residuals(model, scope);
        scope
            .stages
            .iter()
            .any(|&stage| is_common(stage, data.rms(&residuals, stage), data.noise(model, stage)))
    })
}
