//! The results of a trace in sentences, for engineers who build or commission machines.

use super::{caveats, data_faults};
use budget::Budget;
use files::format::{percent, significant, with_spread};
use files::log::Unit;
use model::effects::Stage;
use trace::AxisIdentification;
use trace::analysis::empirical::Empirical;
use trace::analysis::free_run::FreeRun;
use trace::analysis::repeatability::Repeatability;
use trace::analysis::residual_analysis::UnexplainedResidual;
use trace::analysis::variable::Variable;
use trace::certainty::is_certain;
use trace::fit::scope::NotTestable;
use trace::judge::declared_value::{DeclaredValue, mean_factor};
use trace::judge::found_effect::FoundEffect;
use trace::result::distinguishing_motion::Proposal;
use trace::search::ambiguity::Ambiguity;
use trace::stages::{residual_unit, stage_names};
use trace::verdict::{self, Verdict};
use trace::{Identification, Task};

/// What costs less than this at the tool is not told more closely, µm rms.
const LEAST_AT_TOOL_UM: f64 = 0.01;

/// The reduction of the residual by a table over a variable.
#[must_use]
pub fn table(axis: &AxisIdentification, table: &Empirical) -> String {
    let (unit, _) = residual_unit(axis.unit, table.stage);
    let over = match table.variable {
        Variable::Time | Variable::None => "time",
        Variable::Position => "the position",
        Variable::Velocity => "the velocity",
        Variable::Acceleration => "the acceleration",
        Variable::Direction => "the direction of travel",
        Variable::Force => "the drive force",
        Variable::OtherPosition => "the other axis's position",
        Variable::OtherAcceleration => "the other axis's acceleration",
    };
    // The same reduction that is required on the fit logs, in rms.
    let helps = table.after.validate < 0.98 * table.before.validate;
    let [before, after] = [table.before.validate, table.after.validate].map(|rms| significant(rms, 3));
    format!(
        "{}, {}: a table over {over} ({} points) changes the remaining residual on held-out motions from {before} \
         to {after} {unit} rms{}.",
        table.axis,
        stage_names(&[table.stage]),
        table.table.len(),
        if helps { "" } else { ", which is no significant improvement" }
    )
}

/// Two effects that the logs cannot distinguish, and the motion that may distinguish them.
#[must_use]
pub fn ambiguity(axis: &AxisIdentification, alike: &Ambiguity, proposal: Option<&Proposal>) -> String {
    let how = proposal.map_or_else(
        || "a log of a different motion is needed to distinguish them".to_owned(),
        |proposal| {
            format!(
                "{} may distinguish them: there they differ by {} times the noise (--propose writes the motion file, \
                 and `plan` tries motions first)",
                proposal.name,
                significant(proposal.difference, 2)
            )
        },
    );
    let [added, rival] = [&alike.added, &alike.rival].map(|effect| effect.name().replace('_', " "));
    let which =
        if added == rival { format!("two forms of {added}") } else { format!("{added} from {rival}") };
    format!("{}: these logs do not distinguish {which}; {how}.", axis.axis)
}

/// The sentence for an effect that was found: what it is, whether that is certain, what it costs at the tool, or how much of the residual
/// it explains if no budget has it, and what to do; with its rivals, if the logs do not distinguish it from these.
#[must_use]
pub fn sentence(axis: &AxisIdentification, found: &FoundEffect, budget: Option<&Budget>) -> String {
    let at_tool = budget.and_then(|budget| at_tool(budget, &axis.axis, found));
    worded(&axis.axis, axis.unit, found, is_certain(axis, found), at_tool)
}

/// The sentence with what the effect costs at the tool.
fn worded(axis: &str, unit: Unit, found: &FoundEffect, is_certain: bool, at_tool: Option<String>) -> String {
    let is_rotary = unit == Unit::Degree;
    let mut what = found.effect.sentence(&found.half_widths, is_rotary);
    let mut others: Vec<String> = found.rivals.iter().map(|rival| rival.sentence(&[], is_rotary)).collect();
    others.extend(found.imitations.iter().map(|imitation| imitation.clause.to_owned()));
    if !others.is_empty() {
        let mut decided_by: Vec<&str> =
            found.imitations.iter().map(|imitation| imitation.decided_by).collect();
        decided_by.dedup();
        let decided_by = match &decided_by[..] {
            [] => String::new(),
            all => format!("; to tell: {}", all.join("; ")),
        };
        what =
            format!("either {what}, or {} (these logs do not tell which{decided_by})", others.join(", or "));
    }
    if let Some(remaining) = found.remaining {
        let (to_noise, stage) = (significant(remaining.to_noise, 2), stage_names(&[remaining.stage]));
        what += &format!(" (not certain: {to_noise} times the noise remains in the {stage} residual)");
    }
    let certain = if is_certain { ", certain" } else { "" };
    let remedy =
        if is_certain { format!(" To do: {}.", found.effect.compensation().remedy()) } else { String::new() };
    let shown = at_tool.unwrap_or_else(|| on_held_out(found));
    format!("{axis}: {what}{certain}; {shown}.{remedy}")
}

/// What an effect costs at the tool; `None` if the motions held out do not show it, which is said in its place.
fn at_tool(budget: &Budget, axis: &str, found: &FoundEffect) -> Option<String> {
    let (motion, cause) = budget.of_effect(axis, found.effect.name())?;
    let of = |um: f64| significant(um, 3);
    // Without a motion of several axes there is no path that the tool could miss.
    let is_shown = found.validate_reduction_percent() >= 0.0 && motion.whole.rms >= LEAST_AT_TOOL_UM;
    let share_um = cause.share.rms;
    is_shown.then(|| {
        if share_um < LEAST_AT_TOOL_UM {
            return format!(
                "it makes no more than {LEAST_AT_TOOL_UM} µm rms at the tool on any standard motion"
            );
        }
        let (whole, name) = (of(motion.whole.rms), &motion.name);
        format!("it makes {} of the {whole} µm rms at the tool on the standard motion {name}", of(share_um))
    })
}

/// What motions that took no part in the fit say of an effect.
fn on_held_out(found: &FoundEffect) -> String {
    let stage = stage_names(&[found.stage]);
    let gain = found.validate_reduction_percent();
    if gain.is_nan() {
        format!("no held-out motion has a {stage} residual to show it")
    } else if gain >= 0.0 {
        format!(
            "it explains the {stage} residual of held-out motions, which is {} smaller with it",
            percent(gain)
        )
    } else {
        format!(
            "the held-out motions neither show nor refute it: their {stage} residual is {} larger",
            percent(-gain)
        )
    }
}

/// A declared value that the logs put outside its tolerance.
#[must_use]
pub fn beyond_tolerance(axis: &str, value: &DeclaredValue) -> String {
    let DeclaredValue { key, declared, half_width, tolerance, .. } = *value;
    let deviation = value.deviation();
    let how = if deviation > 0.0 { "above" } else { "below" };
    format!(
        "{axis}: {key} is {} % {how} the declared {}, beyond its tolerance of {} %.",
        with_spread(100.0 * deviation.abs(), 100.0 * half_width / declared),
        significant(declared, 4),
        significant(100.0 * tolerance, 3)
    )
}

/// That the scale of the logged force may be wrong.
fn of_force_scale(axis: &AxisIdentification) -> Option<String> {
    let percent = 100.0 * (mean_factor(&axis.declared_values) - 1.0);
    let how = if percent > 0.0 { "above" } else { "below" };
    axis.has_force_scale.then(|| {
        format!(
            "{}: masses, stiffness and friction are together {} % {how} the declared ones. One cause is enough: the logged force \
             is wrong by a factor (its scale, the torque constant of the motor), or all of these values are.",
            axis.axis,
            significant(percent.abs(), 2)
        )
    })
}

/// The results for an axis: whether the model fails to describe the logs; one sentence for each effect, or one sentence
/// that no effect was found.
#[must_use]
pub fn of_axis(axis: &AxisIdentification, budget: Option<&Budget>) -> Vec<String> {
    if axis.residuals.is_empty() {
        return vec![format!(
            "{}: no stage could be evaluated with these logs and this machine file.",
            axis.axis
        )];
    }
    let none = axis.found.is_empty().then(|| format!("{}: {}.", axis.axis, without_effects(axis)));
    let found = axis.found.iter().map(|found| sentence(axis, found, budget));
    let misfit = caveats::misfit(axis).into_iter().chain(caveats::misfit_held_out(axis));
    let beyond = axis.written_values().filter(|value| value.is_beyond_tolerance);
    let beyond = beyond.map(|value| beyond_tolerance(&axis.axis, &value));
    misfit.chain(of_force_scale(axis)).chain(beyond).chain(none).chain(found).collect()
}

/// What was found on an axis and refused: refuted effects, and effects with a parameter at a limit.
#[must_use]
pub fn refused_of_axis(axis: &AxisIdentification) -> Vec<String> {
    let refuted = axis.refuted.iter().map(|found| caveats::refuted(&axis.axis, axis.unit, found));
    let at_limit = axis.refused.iter().map(|limit| caveats::at_limit(&axis.axis, axis.unit, limit));
    refuted.chain(at_limit).collect()
}

/// The result for an axis on which no effect was found.
fn without_effects(axis: &AxisIdentification) -> &'static str {
    let has_faults = !axis.data_faults.is_empty();
    match (axis.task, verdict::of_axis(axis)) {
        (Task::Search, Verdict::Explained) if has_faults => {
            "apart from the data faults, no undeclared effect found"
        }
        (Task::Search, Verdict::Unexplained) if has_faults && axis.unexplained.is_empty() => {
            "apart from the data faults, no undeclared effect found in the channels that can be used"
        }
        (Task::Search, Verdict::Unexplained) if has_faults => {
            "apart from the data faults, no undeclared effect found, but the residual exceeds the sensor noise: see below"
        }
        (Task::Search, Verdict::Explained) => "no undeclared effect found",
        (Task::Search, Verdict::Unexplained) => {
            "no undeclared effect found, but the residual exceeds the sensor noise: see below"
        }
        (Task::Search, Verdict::ModelDoesNotFit) => "no effect found",
        (Task::Evaluate, Verdict::Explained) => "the machine file describes these logs to the sensors' noise",
        (Task::Evaluate, Verdict::Unexplained) => {
            "the machine file does not describe these logs completely: the residual exceeds the sensor noise, see below"
        }
        (Task::Evaluate, Verdict::ModelDoesNotFit) => "the machine file does not describe this machine",
    }
}

/// One sentence for each fault of the data.
#[must_use]
pub fn data_faults(trace: &Identification) -> Vec<String> {
    trace.axes().iter().flat_map(data_faults::of_axis).collect()
}

/// The faults of the data, then the sentences of all axes, with what each effect costs at the tool, as far as a budget has it.
#[must_use]
pub fn summary(trace: &Identification, budget: Option<&Budget>) -> Vec<String> {
    let of_axes =
        trace.axes().iter().flat_map(|axis| [of_axis(axis, budget), refused_of_axis(axis)].concat());
    data_faults(trace).into_iter().chain(of_axes).collect()
}

/// The remaining residual of a stage.
#[must_use]
pub fn remainder(axis: &AxisIdentification, rest: &UnexplainedResidual) -> String {
    let (unit, _) = residual_unit(axis.unit, rest.stage);
    let noise = axis.residual(rest.stage).map_or(0.0, |error| error.noise);
    let share = percent(rest.share_percent);
    let dependence = match rest.variable {
        Variable::None => "no position, speed, acceleration, force or time explains it".to_owned(),
        Variable::Time => {
            let hertz = significant(rest.frequency_hz.unwrap_or(0.0), 3);
            format!("{share} of its power is at {hertz} Hz")
        }
        Variable::Position => {
            let at = significant(rest.centre_mm.unwrap_or(0.0), 3);
            format!(
                "{share} of its power depends on the position, with the maximum near {at}{}",
                if axis.unit == Unit::Degree { "°" } else { " mm" }
            )
        }
        Variable::Velocity => format!("{share} of its power depends on the velocity"),
        Variable::Acceleration => format!("{share} of its power depends on the acceleration"),
        Variable::Direction => format!("{share} of its power depends on the direction of travel"),
        Variable::Force => format!("{share} of its power depends on the drive force"),
        Variable::OtherPosition => format!("{share} of its power depends on the other axis's position"),
        Variable::OtherAcceleration => {
            format!("{share} of its power depends on the other axis's acceleration")
        }
    };
    format!(
        "{}, {}: residual on the fitted logs {} {unit} rms, sensor noise {} {unit}; {dependence}.",
        axis.axis,
        stage_names(&[rest.stage]),
        significant(rest.rms, 3),
        significant(noise, 3),
    )
}

/// The repeatable and the non-repeatable part of the residual of a stage.
#[must_use]
pub fn repeats(axis: &AxisIdentification, part: &Repeatability) -> String {
    let (unit, _) = residual_unit(axis.unit, part.stage);
    format!(
        "{}, {}: the motion repeats every {} s; {} {unit} rms of the remaining residual are repeatable, {} {unit} \
         are not and cannot be removed by any model.",
        axis.axis,
        stage_names(&[part.stage]),
        significant(part.period_s, 4),
        significant(part.repeatable, 3),
        significant(part.non_repeatable, 3),
    )
}

/// Limitations of the fit: values that the fitted logs do not determine, and stages with a larger residual on other logs.
#[must_use]
pub fn open_ends(axis: &AxisIdentification) -> Vec<String> {
    /// Ratio of the held-out to the fitted residual from which it is reported: a smaller one may be due to the motion.
    const MIN_RATIO: f64 = 2.0;
    let at_bounds = axis.written_values().filter(DeclaredValue::is_undetermined);
    let keys: Vec<&str> = at_bounds.map(|value| value.key).collect();
    let bounds = (!keys.is_empty()).then(|| {
        format!(
            "{}: the fitted logs do not determine {}, or the machine file is that of another machine: the fit stopped at the end of \
             its range, several tolerances from the declared value.",
            axis.axis,
            keys.join(", ")
        )
    });
    let more = axis.residuals.iter().filter(|e| e.after.validate > MIN_RATIO * e.after.fit.max(e.noise)).map(|error| {
        let (unit, _) = residual_unit(axis.unit, error.stage);
        format!(
            "{}, {}: residual on held-out motions {} {unit} rms, {} times that on the fitted ones: the held-out \
             motions excite behaviour that the model does not describe.",
            axis.axis,
            stage_names(&[error.stage]),
            significant(error.after.validate, 3),
            significant(error.after.validate / error.after.fit, 2),
        )
    });
    bounds
        .into_iter()
        .chain(more)
        .chain(axis.residuals.iter().filter_map(|error| caveats::worse(axis, error)))
        .collect()
}

/// The error of the models without feedback.
#[must_use]
pub fn free_run(unit: Unit, run: &FreeRun) -> String {
    let (symbol, _) = residual_unit(unit, Stage::Motor);
    let (force_unit, _) = residual_unit(unit, Stage::Force);
    let force = if unit == Unit::Degree { "torque" } else { "force" };
    format!(
        "{}: simulated with the measured {force} alone, the declared model has an error of {} {symbol} rms within {} s, \
         the model with the effects found {} {symbol} ({} {}, held out), as much as a constant error of the {force} of {} {force_unit} makes.",
        run.axis,
        significant(run.declared, 3),
        significant(run.seconds, 2),
        significant(run.after, 3),
        run.runs,
        if run.runs == 1 { "run" } else { "runs" },
        significant(run.force_error, 2),
    )
}

/// The reason why a stage was not evaluated, and what to do about it.
#[must_use]
pub fn not_testable(axis: &str, stage: &NotTestable) -> String {
    let estimated = if stage.lacks_keys() { "; `init` estimates such values from logs" } else { "" };
    format!(
        "{axis}, {}: could not be evaluated; required: {}{estimated}.",
        stage_names(&[stage.stage]),
        stage.needs
    )
}

#[cfg(test)]
mod tests;
