//! The intervals of forces, where the scale of the logged force may be wrong.

use crate::judge::axis_findings::AxisFindings;
use crate::judge::declared_value::mean_factor;
use model::effects::{Imitation, Unit};

/// The findings with intervals of forces that contain both values: the one by the logged force, and the one if its scale is wrong by the
/// factor that explains what was found.
#[must_use]
pub fn with_both_values(mut axis: AxisFindings) -> AxisFindings {
    let factor = factor(&axis);
    if !(factor.is_finite() && factor > 0.0) {
        return axis;
    }
    for found in &mut axis.found {
        let parameters = found.effect.declared_parameters();
        let values = parameters.iter().zip(found.effect.values());
        for ((parameter, value), half_width) in values.zip(&mut found.half_widths) {
            if parameter.unit.is_of_force() {
                *half_width += (value - value / factor).abs();
            }
        }
    }
    axis
}

/// Logged over true force, if the scale is wrong: by the effect that it imitates, otherwise by the declared values.
fn factor(axis: &AxisFindings) -> f64 {
    let imitated = axis.found.iter().find(|found| found.imitations.contains(&Imitation::FORCE_GAIN));
    let of_effect = imitated.and_then(|found| {
        let parameters = found.effect.declared_parameters();
        let percent = parameters.iter().position(|parameter| parameter.unit == Unit::Percent)?;
        Some(1.0 + 1e-2 * found.effect.values().get(percent)?)
    });
    of_effect.unwrap_or_else(|| mean_factor(&axis.declared_values))
}
