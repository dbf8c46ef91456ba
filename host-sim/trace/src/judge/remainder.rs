//! What the declared model and the model with effects leave of each stage.

use super::axis_findings::StageResidual;
use super::laws::{law_of, with_laws};
use crate::analysis::empirical::{Empirical, empirical};
use crate::analysis::law::FoundLaw;
use crate::analysis::repeatability::{Repeatability, repeatability};
use crate::analysis::residual_analysis::{UnexplainedResidual, unexplained};
use crate::fit::axis_data::AxisData;
use crate::fit::axis_model::AxisModel;
use crate::fit::exclusion::Exclusion;
use crate::fit::fit_data::{FitAndValidationRms, FitData};
use crate::fit::scope::Scope;
use model::residual_table::ResidualTable;

/// Residuals after the fit, and their analysis.
#[derive(Default)]
pub struct Remainder {
    /// Residuals by stage.
    pub residuals: Vec<StageResidual>,
    /// Residuals above the noise.
    pub unexplained: Vec<UnexplainedResidual>,
    /// Their repeatable parts.
    pub repeats: Vec<Repeatability>,
    /// Them as tables over the variables that explain most of them.
    pub tables: Vec<Empirical>,
    /// Them as laws, without the vibrations and local defects that are reported apart.
    pub laws: Vec<FoundLaw>,
}

impl Remainder {
    /// The residuals of each stage under the declared model and under the model with effects.
    #[must_use]
    pub fn of(
        axis: &AxisData<'_>,
        [before, model]: [&AxisModel; 2],
        scopes: &[Scope],
        exclusions: &[Exclusion],
    ) -> Self {
        let AxisData { fit: fit_data, validate, .. } = axis;
        let mut remainder = Self::default();
        for scope in scopes {
            let [fit_before, fit_after] = [before, model].map(|model| fit_data.residuals(model, scope));
            let [held_out_before, held_out_after] =
                [before, model].map(|model| validate.residuals(model, scope));
            let has_exclusion = exclusions.iter().any(|exclusion| scope.stages.contains(&exclusion.stage));
            let beside = has_exclusion.then(|| {
                [fit_data, validate].map(|data| FitData { exclusions, ..*data }.residuals(model, scope))
            });
            let [fit_beside, held_out_beside] =
                beside.as_ref().map_or([&fit_after, &held_out_after], |[fit, held_out]| [fit, held_out]);
            for &stage in &scope.stages {
                let noise = fit_data.noise(model, stage);
                let pair = |fitted, held_out| FitAndValidationRms {
                    fit: fit_data.rms(fitted, stage),
                    validate: validate.rms(held_out, stage),
                };
                let residual = StageResidual {
                    stage,
                    before: pair(&fit_before, &held_out_before),
                    after: pair(&fit_after, &held_out_after),
                    beside_exclusions: pair(fit_beside, held_out_beside),
                    noise,
                    max_described: fit_data.max_described(model, stage),
                };
                let verdict = &fit_data.options.verdict;
                let is_left = residual.ratio_to_noise(verdict.min_noise) > verdict.max_certain_ratio;
                remainder.residuals.push(residual);
                remainder.repeats.extend(repeatability(fit_data, &fit_after, stage));
                if let Some(found) = unexplained(fit_data, &fit_after, stage, noise) {
                    let residuals = [&fit_after[..], &held_out_after];
                    let table = empirical([fit_data, validate], residuals, stage, found.variable);
                    remainder.tables.extend(table);
                    if is_left {
                        remainder.laws.extend(law_of(axis, (model, scope), exclusions, stage));
                    }
                    remainder.unexplained.push(found);
                }
            }
        }
        remainder
    }

    /// The model with what the logs confirm of its residuals, as laws, otherwise as tables, and what remains beside these; `None` if
    /// they confirm none.
    #[must_use]
    pub fn with_residuals(
        &self,
        axis: &AxisData<'_>,
        [before, model]: [&AxisModel; 2],
        scopes: &[Scope],
        exclusions: &[Exclusion],
    ) -> Option<(AxisModel, Self)> {
        let has_law = |table: &&Empirical| self.laws.iter().any(|law| law.stage == table.stage);
        let tables = self.tables.iter().filter(|table| !has_law(table));
        let confirmed: Vec<ResidualTable> = tables.filter_map(Empirical::confirmed).collect();
        if confirmed.is_empty() && self.laws.is_empty() {
            return None;
        }
        let model = with_laws(&axis.fit, model, scopes, &self.laws).with_further_tables(&confirmed);
        let beside = Self::of(axis, [before, &model], scopes, exclusions);
        Some((model, Self { tables: self.tables.clone(), laws: self.laws.clone(), ..beside }))
    }
}
