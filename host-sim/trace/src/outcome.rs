//! The result of a trace.

use crate::analysis::empirical::Empirical;
use crate::analysis::free_run::FreeRun;
use crate::analysis::repeatability::Repeatability;
use crate::analysis::residual_analysis::UnexplainedResidual;
use crate::data_faults::late_command::{self, Late};
use crate::data_faults::{DataFault, FaultHandling};
use crate::fit::axis_model::AxisModel;
use crate::fit::fit_data::{FitAndValidationRms, FitData, ResidualSeries};
use crate::fit::fitted_scope::FittedScope;
use crate::fit::limits::ParameterAtLimit;
use crate::fit::scope::{NotTestable, Scope};
use crate::input::signals::Signals;
use crate::not_testable::EffectNotTestable;
use crate::options::TraceOptions;
use crate::search::ambiguity::Ambiguity;
use crate::search::distinguishing_motion;
use crate::search::round::Round;
use crate::task::Task;
use crate::validation::declared_value::DeclaredValue;
use crate::validation::found_effect::FoundEffect;
use crate::validation::tool_slopes::ToolSlopes;
use files::log::Unit;
use model::effects::Stage;
use model::machine::Machine;

/// The result of a trace.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Results of the axes, in the order of the machine file.
    pub axes: Vec<AxisTrace>,
    /// The logs that were fitted.
    pub fit_logs: Vec<Signals>,
    /// The logs that were held out.
    pub validate_logs: Vec<Signals>,
    /// Names of the axes.
    pub names: Vec<String>,
    /// The declared machine.
    pub machine: Machine,
    /// The declared models of the axes, in the order of the machine file.
    pub declared_axes: Vec<AxisModel>,
    /// The thresholds of the trace.
    pub options: TraceOptions,
    /// Sentences on logs that were shortened or thinned, and on missing or excluded data.
    pub notes: Vec<String>,
}

/// The result for one axis.
#[derive(Clone, Debug)]
pub struct AxisTrace {
    /// What was done.
    pub task: Task,
    /// Name of the axis.
    pub axis: String,
    /// Unit of its channels.
    pub unit: Unit,
    /// Faults of its data, found before any fit.
    pub data_faults: Vec<DataFault>,
    /// The declared model, fitted.
    pub baseline: AxisModel,
    /// The declared mechanical values, as fitted with the effects found.
    pub declared_values: Vec<DeclaredValue>,
    /// Whether the scale of the logged force may be wrong, instead of masses, stiffness, friction and the gain of the loop.
    pub has_force_scale: bool,
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
}

impl AxisTrace {
    /// The residual of a stage, if it was evaluated.
    #[must_use]
    pub fn residual(&self, stage: Stage) -> Option<&StageResidual> {
        self.residuals.iter().find(|residual| residual.stage == stage)
    }
}

impl Trace {
    /// The effects found, as `axis: name`.
    #[must_use]
    pub fn found_names(&self) -> Vec<String> {
        let of = |axis: &AxisTrace| {
            axis.found
                .iter()
                .map(|found| format!("{}: {}", axis.axis, found.effect.name()))
                .collect::<Vec<_>>()
        };
        self.axes.iter().flat_map(of).collect()
    }

    /// The machine with fitted values and with the effects found.
    #[must_use]
    pub fn better_machine(&self) -> Machine {
        // The effects found include the influence of the bodies on an axis. With the structure, it would act twice.
        let mut machine = Machine { structure: None, ..self.machine.clone() };
        for trace in &self.axes {
            if let Some(axis) = machine.axis.get_mut(&trace.axis) {
                *axis = trace.model.written();
            }
        }
        machine
    }

    /// Proposes motions that distinguish the pairs of effects in [`AxisTrace::ambiguities`].
    pub(crate) fn propose_motions(&mut self) {
        let better = self.better_machine();
        let logs = &self.fit_logs;
        let options = &self.options.admission;
        for (number, axis) in self.axes.iter_mut().enumerate() {
            for ambiguity in &mut axis.ambiguities {
                let mut other = better.clone();
                if let Some(of_axis) = other.axis.get_mut(&axis.axis) {
                    *of_axis = ambiguity.with_rival.axis.clone();
                }
                ambiguity.proposal = distinguishing_motion::propose([&better, &other], number, logs, options);
            }
        }
    }

    /// Shifts commands back that are logged late, in all logs, and returns these faults.
    pub(crate) fn correct_late_commands(&mut self) -> (Vec<DataFault>, Vec<Late>) {
        let rates = self.machine.rates();
        let (mut faults, mut all_late) = (Vec::new(), Vec::new());
        for (number, model) in self.declared_axes.iter().enumerate() {
            let data = |logs| FitData::new(logs, &self.names, number, rates, &self.options);
            let found =
                [&self.fit_logs, &self.validate_logs].map(|logs| late_command::lateness(&data(logs), model));
            let of_session = late_command::of_session(&found.concat());
            let sets = [&mut self.fit_logs, &mut self.validate_logs].into_iter().zip(found).enumerate();
            for (set, (logs, found)) in sets {
                for (log, (signals, lateness)) in logs.iter_mut().zip(found).enumerate() {
                    if let Some(samples) = of_session.or(lateness) {
                        faults.push(late_command::shift_back(signals, number, &self.names[number], samples));
                        all_late.push(Late { set, log, axis: number, samples });
                    }
                }
            }
        }
        (faults, all_late)
    }

    /// Assigns the faults to their axes, and adds to the missing channels of each stage why they are not used.
    pub(crate) fn assign(&mut self, faults: Vec<DataFault>) {
        for fault in faults {
            let Some(axis) = self.axes.iter_mut().find(|axis| axis.axis == fault.axis) else { continue };
            if let (FaultHandling::Removed, Some(channel)) = (fault.treatment, fault.channel) {
                let missing = format!("a {} channel", channel.word());
                let stated = format!("{missing} without the fault \"{}\"", fault.kind.name());
                let stages = axis.not_testable.iter_mut().map(|stage| &mut stage.needs);
                let effects = axis.effects_not_testable.iter_mut().map(|effect| &mut effect.needs);
                for needs in stages.chain(effects).filter(|needs| !needs.contains(&stated)) {
                    *needs = needs.replace(&missing, &stated);
                }
            }
            axis.data_faults.push(fault);
        }
    }

    /// The data of one axis in these logs.
    #[must_use]
    pub fn data<'a>(&'a self, logs: &'a [Signals], axis: usize) -> FitData<'a> {
        let data = FitData::new(logs, &self.names, axis, self.machine.rates(), &self.options);
        FitData { declared_axes: &self.declared_axes, ..data }
    }
}
