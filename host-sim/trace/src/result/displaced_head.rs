//! A reading head of the linear scale that acceleration displaces, as a rival of what was found.
//!
//! A head displaced by h per acceleration leaves −h in tool − table, like an in-talk, and h in table − motor, like another mass of
//! the table: the motor is ahead of the table by table mass / stiffness per acceleration.

use std::ops::RangeInclusive;

use crate::judge::axis_findings::AxisFindings;
use crate::options::VerdictOptions;
use model::axis::Settings;
use model::effects::Stage;

/// Displacements of the tool per acceleration, m per m/s², that a displaced head leaves as well: the stretch of the drive would then be
/// within the tolerance of what is declared. `None`: any, as table − motor was not evaluated, or keeps more than the noise.
#[must_use]
pub fn allowed_s2(
    axis: &AxisFindings,
    declared: &Settings,
    options: &VerdictOptions,
) -> Option<RangeInclusive<f64>> {
    let table = axis.residual(Stage::Table)?;
    if table.ratio_to_noise(options.min_noise) > options.max_certain_ratio {
        return None;
    }
    let nominal_s2 = stretch_s2(declared);
    // Table mass and stiffness vary independently; their tolerance is two standard deviations, three are allowed.
    let tolerance = axis.declared_values.first().map_or(0.0, |value| value.tolerance);
    let half_width_s2 = 1.5 * 2.0_f64.sqrt() * tolerance * nominal_s2;
    let excess_s2 = stretch_s2(&axis.model.axis.settings) - nominal_s2;
    Some(excess_s2 - half_width_s2..=excess_s2 + half_width_s2)
}

/// Stretch of the drive per acceleration of the table, m per m/s².
fn stretch_s2(settings: &Settings) -> f64 {
    let mechanics = &settings.mechanics;
    let stretch = |stiffness_n_per_um| Some(1e-6 * mechanics.table_mass_kg? / stiffness_n_per_um);
    mechanics.stiffness_n_per_um.and_then(stretch).unwrap_or(0.0)
}
