//! What speaks against the effects that were found: without any of it, an effect is certain.
//!
//! Three things do: another effect of the catalogue that explains the logs as well ([`crate::search::ambiguity`]), something that
//! the logged channels cannot tell apart from it ([`Imitation`]), and a residual that stands out in its
//! stage: it has a cause of which the effect may describe a part.

use crate::analysis::variable::Variable;
use crate::fit::declared_machine::DeclaredMachine;
use crate::input::signals::Signals;
use crate::input::signals::logged_channels;
use crate::judge::axis_findings::{AxisFindings, StageResidual};
use crate::judge::common_noise;
use crate::judge::declared_value::{self, DeclaredValue};
use crate::judge::found_effect::{FoundEffect, Remaining};
use crate::options::VerdictOptions;
use crate::result::displaced_head;
use crate::result::force_scale::with_both_values;
use model::effects::{Imitation, ImitationContext, LoggedChannels, SlopeOf, Stage};
use model::machine::Machine;

/// Largest residual of the motor stage, in multiples of its noise, beside which declared values are told from errors of the loop. A
/// delay of the loop that no effect describes leaves 20 to 200.
const MAX_LOOP_RATIO: f64 = 10.0;

/// Largest residual beside which a special form of an effect is told from its ordinary form, in multiples of the noise. True effects leave up
/// to this; what is left beyond it may have made the difference between the forms.
const MAX_SPECIAL_RATIO: f64 = 1.5;

/// Whether no other effect explains the logs as well, nothing imitates it, and the model with it describes its axis.
#[must_use]
pub fn is_certain(axis: &AxisFindings, found: &FoundEffect) -> bool {
    found.is_certain() && !axis.is_undescribed()
}

/// Findings with what speaks against them.
pub struct Doubted {
    /// The findings.
    pub findings: AxisFindings,
    /// Whether the scale of the logged force may be wrong, instead of masses, stiffness, friction and the gain of the loop.
    pub has_force_scale: bool,
}

/// The findings with what imitates the effects, and what remains in their stages.
#[must_use]
pub fn doubted(axes: Vec<AxisFindings>, declared: &DeclaredMachine, fit_logs: &[Signals]) -> Vec<Doubted> {
    let ends_s = fit_logs.iter().map(|log| [log.start_s, log.start_s + log.len() as f64 * log.sample_s]);
    let (starts_s, ends_s): (Vec<f64>, Vec<f64>) = ends_s.map(|[start_s, end_s]| (start_s, end_s)).unzip();
    let session_s = numerics::max(ends_s) - numerics::min(starts_s);
    let jitters = axes.iter().any(has_common_noise);
    let turned_s2 = turned_s2(&axes);
    let tools = axes.iter().filter_map(|axis| axis.residual(Stage::Tool));
    let of_tools = largest(tools, &declared.options.verdict);
    let doubted = |(number, axis)| {
        let channels = logged_channels(fit_logs, number, &declared.options.samples);
        let logged = Logged { channels, session_s, jitters, turned_s2, of_tools };
        let axis = with_imitations(axis, &declared.machine, &logged, &declared.options.verdict);
        of_declared_values(axis, jitters, &declared.options.verdict)
    };
    axes.into_iter().enumerate().map(doubted).collect()
}

/// Whether the channels of an axis share their noise: see [`common_noise`].
fn has_common_noise(axis: &AxisFindings) -> bool {
    axis.residuals.iter().any(|error| common_noise::is_common(error.stage, error.after.fit, error.noise))
}

/// See [`ImitationContext::turned_s2`]: of all axes, the largest angle and the largest displacement.
fn turned_s2(axes: &[AxisFindings]) -> f64 {
    let tools = || axes.iter().map(|axis| axis.model.parameters().tool);
    let angle = numerics::max(tools().map(|tool| 1e-6 * tool.probe.rotation.um_per_m.abs()));
    angle * numerics::max(tools().map(|tool| tool.max_displacement_s2()))
}

/// Whether instants that jitter may explain an effect: what is found in the stages of force and motor, which are no differences of
/// readings, and what is smaller than the common noise.
fn is_within_jitter(found: &FoundEffect, errors: &[StageResidual]) -> bool {
    let is_within = |error: &StageResidual| error.stage == found.stage && found.before.fit < error.noise;
    matches!(found.stage, Stage::Force | Stage::Motor) || errors.iter().any(is_within)
}

/// What is known of the logs of an axis.
struct Logged {
    /// Channels of the axis. The tool of a log without the table is not used if another log has the table.
    channels: LoggedChannels,
    /// Time from the start of the first log to the end of the last one, s.
    session_s: f64,
    /// Whether the rows were read at instants that jitter.
    jitters: bool,
    /// See [`ImitationContext::turned_s2`].
    turned_s2: f64,
    /// What remains of the tool of the axis that leaves most of it.
    of_tools: Option<Remaining>,
}

/// The findings with what imitates the effects, and what remains in their stages.
fn with_imitations(
    mut axis: AxisFindings,
    machine: &Machine,
    &Logged { channels, session_s, jitters, turned_s2, of_tools }: &Logged,
    options: &VerdictOptions,
) -> AxisFindings {
    let stages: Vec<Stage> = axis.residuals.iter().map(|error| error.stage).collect();
    let Some(declared) = machine.axis.get(&axis.axis) else { return axis };
    let determined = axis.declared_values.iter().filter(|value| value.is_determined());
    let fitted_to_declared: Vec<f64> = determined.map(|value| value.fitted / value.declared).collect();
    let tolerance = axis.declared_values.first().map_or(0.0, |value| value.tolerance);
    let tool_follows_scale = follows_scale(&axis, options);
    let head_displacement_s2 = displaced_head::allowed_s2(&axis, &declared.settings, options);
    let varies =
        |found: &FoundEffect| found.effect.depends_on_direction() && found.effect.over_position().is_some();
    let has_varying_gap = axis.found.iter().any(varies);
    let is_turned = axis.found.iter().any(|found| found.effect.slope() == Some(SlopeOf::ProbeAngle));
    for found in &mut axis.found {
        let context = ImitationContext {
            axis: &declared.settings,
            stages: &stages,
            logged: channels,
            rates: machine.rates(),
            half_widths: &found.half_widths,
            fitted_to_declared: &fitted_to_declared,
            tolerance,
            session_s,
            tool_follows_scale,
            head_displacement_s2: head_displacement_s2.clone(),
            turned_s2,
            jitters,
            has_varying_gap,
        };
        found.imitations = found.effect.imitations(&context);
        if jitters && is_within_jitter(found, &axis.residuals) {
            found.imitations.push(Imitation::CLOCK);
        }
        let shown = axis.residuals.iter().filter(|error| is_shown(found, error.stage));
        // Angle and squareness were separated by the tools of both axes.
        let of_others = of_tools.filter(|_| is_turned && found.effect.slope().is_some());
        let largest = larger(largest(shown, options), of_others);
        let is_special = found.effect.kind().special_form_of.is_some();
        let most = if is_special { MAX_SPECIAL_RATIO } else { options.max_certain_ratio };
        found.remaining = largest.filter(|remaining| remaining.to_noise > most);
    }
    with_rivals_of_neighbours(axis)
}

/// What remains of the stage that leaves most of its noise.
fn largest<'a>(
    errors: impl Iterator<Item = &'a StageResidual>,
    options: &VerdictOptions,
) -> Option<Remaining> {
    let of = |error: &StageResidual| Remaining {
        stage: error.stage,
        to_noise: error.ratio_to_noise(options.min_noise),
    };
    errors.fold(None, |largest, error| larger(largest, Some(of(error))))
}

/// The larger of two remainders.
fn larger(a: Option<Remaining>, b: Option<Remaining>) -> Option<Remaining> {
    a.into_iter().chain(b).max_by(|a, b| a.to_noise.total_cmp(&b.to_noise))
}

/// The findings in which an effect that is barely determined has also the rivals of an ambiguous one of its stage: what one of these explains
/// instead may be what the effect was added for.
fn with_rivals_of_neighbours(mut axis: AxisFindings) -> AxisFindings {
    let all = axis.found.clone();
    for found in axis.found.iter_mut().filter(|found| is_barely_determined(found)) {
        let others =
            all.iter().filter(|other| other.stage == found.stage && !other.effect.is_same(&found.effect));
        for rival in others.flat_map(|other| &other.rivals) {
            if !found.rivals.iter().any(|known| known.is_same(rival)) && !rival.is_same(&found.effect) {
                found.rivals.push(rival.clone());
            }
        }
    }
    axis
}

/// Whether half of the interval of an effect's size exceeds half of the size.
fn is_barely_determined(found: &FoundEffect) -> bool {
    let size = found.effect.values().first().copied().unwrap_or(0.0);
    found.half_widths.first().is_some_and(|half_width| *half_width > 0.5 * size.abs())
}

/// See [`ImitationContext::tool_follows_scale`].
fn follows_scale(axis: &AxisFindings, options: &VerdictOptions) -> bool {
    let depends_on_position = axis
        .unexplained
        .iter()
        .any(|residual| residual.stage == Stage::Tool && residual.variable == Variable::Position);
    let is_left = |tool: &StageResidual| tool.ratio_to_noise(options.min_noise) >= options.max_certain_ratio;
    axis.residual(Stage::Tool).is_some_and(|tool| !(is_left(tool) && depends_on_position))
}

/// The findings without the statement that declared values are outside their tolerance
///
/// - where rows were read at instants that jitter;
/// - where the model does not describe the axis or its loop;
/// - where the search for another value ended at a bound: they balance what that one lacks;
/// - of the masses, the stiffness and the friction of the motor, where a displaced reading head of the linear scale explains them, or no
///   tool was logged that shows it;
/// - where no force was logged: the loop shows the values relative to its gain only;
/// - where the scale of the logged force explains all of them: together with the gain of the loop, which contradicts the masses by
///   the same factor, or where no loop could be evaluated or described.
fn of_declared_values(mut findings: AxisFindings, jitters: bool, options: &VerdictOptions) -> Doubted {
    let axis = &findings;
    let (motor, has_force) = (axis.residual(Stage::Motor), axis.residual(Stage::Force).is_some());
    let has_loop = !axis.is_of_another_machine && motor.is_some();
    let is_loop_unknown = motor.is_some_and(|motor| motor.ratio_to_noise(options.min_noise) > MAX_LOOP_RATIO);
    let is_imitated_by =
        |rival| axis.found.iter().flat_map(|found| &found.imitations).any(|imitation| *imitation == rival);
    let is_explained = is_imitated_by(Imitation::FORCE_GAIN);
    let has_force_scale =
        is_explained || !has_loop && declared_value::are_off_by_one_factor(&axis.declared_values);
    let is_undescribed = !axis.is_of_another_machine && (is_loop_unknown || axis.is_undescribed());
    let is_any_undetermined = axis.declared_values.iter().any(DeclaredValue::is_undetermined);
    let is_head_known = axis.residual(Stage::Tool).is_some() && !is_imitated_by(Imitation::HEAD);
    let is_none_known = jitters || !has_force || has_force_scale || is_undescribed || is_any_undetermined;
    let is_unknown = |value: &DeclaredValue| is_none_known || !is_head_known && value.is_of_division();
    let unknown = findings.declared_values.iter_mut().filter(|value| is_unknown(value));
    unknown.for_each(|value| value.is_beyond_tolerance = false);
    let findings = if has_force_scale { with_both_values(findings) } else { findings };
    Doubted { findings, has_force_scale }
}

/// Whether an effect is searched for in a stage, or reduces its residual most.
fn is_shown(found: &FoundEffect, stage: Stage) -> bool {
    let is_searched = found.effect.stages().contains(&stage) && found.effect.kind().shown_in.contains(&stage);
    stage == found.stage || is_searched
}
