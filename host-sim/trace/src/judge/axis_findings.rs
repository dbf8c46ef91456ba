//! What a trace found of one axis.

use crate::analysis::empirical::Empirical;
use crate::analysis::free_run::FreeRun;
use crate::analysis::law::FoundLaw;
use crate::analysis::repeatability::Repeatability;
use crate::analysis::residual_analysis::UnexplainedResidual;
use crate::dropped::Dropped;
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::{FitAndValidationRms, ResidualSeries};
use crate::fit::fitted_scope::FittedScope;
use crate::fit::limits::ParameterAtLimit;
use crate::fit::scope::{NotTestable, Scope};
use crate::judge::declared_value::DeclaredValue;
use crate::judge::found_effect::FoundEffect;
use crate::judge::not_testable::EffectNotTestable;
use crate::judge::tool_slopes::ToolSlopes;
use crate::search::ambiguity::Ambiguity;
use crate::search::round::Round;
use crate::task::Task;
use files::log::Unit;
use model::effects::Stage;

/// What a trace found of one axis.
#[derive(Clone, Debug)]
pub struct AxisFindings {
    /// What was done.
    pub task: Task,
    /// Name of the axis.
    pub axis: String,
    /// Unit of its channels.
    pub unit: Unit,
    /// The declared model, fitted.
    pub baseline: AxisModel,
    /// The declared mechanical values, as fitted with the effects found.
    pub declared_values: Vec<DeclaredValue>,
    /// Whether the machine file is that of another machine, so that no effect is reported.
    pub is_of_another_machine: bool,
    /// The model with the effects found.
    pub model: AxisModel,
    /// Stages that could be evaluated, by scope.
    pub scopes: Vec<Scope>,
    /// The scopes as they were fitted.
    pub fitted_scopes: Vec<FittedScope>,
    /// Whether the error of the tracer's own simulation is subtracted from the residuals.
    pub subtracts_bias: bool,
    /// Stages that could not be evaluated, with the reasons.
    pub not_testable: Vec<NotTestable>,
    /// Effects that could not be searched for, with the reasons.
    pub effects_not_testable: Vec<EffectNotTestable>,
    /// Effects found, in the order in which they were added.
    pub found: Vec<FoundEffect>,
    /// Effects that were not added because a parameter ended at a limit of its range.
    pub refused: Vec<ParameterAtLimit>,
    /// Effects that the fit logs support and the validation logs refute. They are not in the model; `before` is the
    /// residual without the effect.
    pub refuted: Vec<FoundEffect>,
    /// Effects that were added and dropped again, with the reasons, in this order.
    pub dropped: Vec<Dropped>,
    /// Slopes of the tool over the tables, whether or not an effect was found.
    pub tool_slopes: ToolSlopes,
    /// Residuals by stage.
    pub residuals: Vec<StageResidual>,
    /// Error of the tracer's own simulation on the validation logs.
    pub bias: Vec<ResidualSeries>,
    /// Residuals above the noise.
    pub unexplained: Vec<UnexplainedResidual>,
    /// The repeatable parts of the residuals.
    pub repeats: Vec<Repeatability>,
    /// Errors of the models driven by the measured force alone, on the validation logs.
    pub free_runs: Vec<FreeRun>,
    /// Residuals as tables over the variables that explain most of them.
    pub tables: Vec<Empirical>,
    /// Residuals as laws.
    pub laws: Vec<FoundLaw>,
    /// Pairs of effects that the logs do not distinguish.
    pub ambiguities: Vec<Ambiguity>,
    /// The rounds of the search.
    pub rounds: Vec<Round>,
}

/// The residual of one stage, µm or N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageResidual {
    /// Stage.
    pub stage: Stage,
    /// Residual of the declared model, fitted within its tolerance.
    pub before: FitAndValidationRms,
    /// Residual of the model with the effects found.
    pub after: FitAndValidationRms,
    /// Residual of the model with the effects found, without the vibrations and local defects that are reported apart.
    pub beside_exclusions: FitAndValidationRms,
    /// Noise of the sensors, which no model can remove.
    pub noise: f64,
    /// Largest residual of a model that describes its logs.
    pub max_described: f64,
}

impl StageResidual {
    /// What remains on the fitted logs, without the vibrations and local defects that are reported apart, as a multiple of the
    /// noise, at least `min_noise`.
    #[must_use]
    pub fn ratio_to_noise(&self, min_noise: f64) -> f64 {
        self.beside_exclusions.fit / self.noise.max(min_noise)
    }

    /// Whether the model does not describe the stage of the fitted logs.
    #[must_use]
    pub fn is_gross(&self) -> bool {
        self.beside_exclusions.fit > self.max_described
    }

    /// Whether the model does not describe the stage of the validation logs. As their motion may differ from that of the fitted
    /// logs, this does not show that the model describes another machine.
    #[must_use]
    pub fn is_gross_held_out(&self) -> bool {
        self.beside_exclusions.validate > self.max_described
    }
}

impl AxisFindings {
    /// The declared values under the keys and in the units of the machine file.
    pub fn written_values(&self) -> impl Iterator<Item = DeclaredValue> {
        let names = self.model.axis.settings.names;
        self.declared_values.iter().map(move |value| value.as_written(names))
    }

    /// The residual of a stage, if it was evaluated.
    #[must_use]
    pub fn residual(&self, stage: Stage) -> Option<&StageResidual> {
        self.residuals.iter().find(|residual| residual.stage == stage)
    }

    /// Whether the model does not describe the axis: it is that of another machine, or leaves a gross residual.
    #[must_use]
    pub fn is_undescribed(&self) -> bool {
        self.is_of_another_machine || self.residuals.iter().any(StageResidual::is_gross)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::VerdictOptions;

    fn error(fit: f64, validate: f64, noise: f64) -> StageResidual {
        let [before, after] = [FitAndValidationRms { fit, validate }; 2];
        let max_described = VerdictOptions::default().max_described(noise);
        StageResidual { stage: Stage::Table, before, after, beside_exclusions: after, noise, max_described }
    }

    #[test]
    fn an_error_is_gross_relative_to_noise_and_to_the_resolution_of_a_log() {
        assert!(error(0.51, 0.0, 0.01).is_gross() && !error(0.49, 9.0, 0.01).is_gross());
        assert!(error(0.0, 0.51, 0.01).is_gross_held_out() && !error(9.0, 0.49, 0.01).is_gross_held_out());
        // Without noise, one nanometre is assumed.
        assert!(error(0.051, 0.0, 0.0).is_gross() && !error(0.049, 0.0, 0.0).is_gross());
    }
}
