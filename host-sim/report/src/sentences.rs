//! What was found and what was not, in the words of somebody who builds machines.

use super::caveats;
use files::format::{percent, significant};
use files::log::Unit;
use trace::Trace;
use trace::analysis::empirical::Empirical;
use trace::analysis::free_run::FreeRun;
use trace::analysis::repeatability::Repeatability;
use trace::analysis::residual_analysis::Unexplained;
use trace::analysis::variable::Variable;
use trace::fit::scope::NotTestable;
use trace::outcome::AxisTrace;
use trace::search::ambiguity::Ambiguity;
use trace::stages::{residual_unit, stage_names};
use trace::validation::found::Found;
use trace::verdict::{self, Verdict};

/// What a table over a variable takes away.
#[must_use]
pub fn table(axis: &AxisTrace, table: &Empirical) -> String {
    let (unit, _) = residual_unit(axis.unit, table.channel);
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
    // As much as it had to be worth where it was found, in rms.
    let helps = table.after.validate < 0.98 * table.before.validate;
    let [before, after] = [table.before.validate, table.after.validate].map(|rms| significant(rms, 3));
    format!(
        "{}, {}: a table over {over} ({} points) takes what stays from {before} to {after} {unit} rms on motions not \
         used to find it{}.",
        table.axis,
        stage_names(&[table.channel]),
        table.table.len(),
        if helps { "" } else { ": it is of no use there" }
    )
}

/// That two effects cannot be told apart, and what would tell.
#[must_use]
pub fn look_alike(axis: &AxisTrace, alike: &Ambiguity) -> String {
    let how = alike.proposal.as_ref().map_or_else(
        || "a log of another kind of motion would tell".to_owned(),
        |proposal| {
            format!(
                "{} would tell, where they differ by {} times the noise (--propose writes the motion file)",
                proposal.name,
                significant(proposal.difference, 2)
            )
        },
    );
    let [added, rival] = [&alike.added, &alike.rival].map(|effect| effect.name().replace('_', " "));
    format!("{}: these logs do not tell {added} from {rival}; {how}.", axis.axis)
}

/// The sentence for an effect that was found.
#[must_use]
pub fn sentence(axis: &str, unit: Unit, found: &Found) -> String {
    let what = found.effect.sentence(&found.half_widths, unit == Unit::Degree);
    let stage = stage_names(&[found.stage]);
    let unseen = "on motions not used to find it";
    let gain = found.validate_reduction_percent();
    if gain >= 0.0 {
        format!("{axis}: {what}; takes away {} of the {stage} residual {unseen}.", percent(gain))
    } else {
        format!("{axis}: {what}; the {stage} residual is {} larger with it {unseen}.", percent(-gain))
    }
}

/// What was found on an axis: that the model does not describe the logs, where it does not; one sentence for each effect,
/// or one that says that there is none; what was refuted, and what ended at a limit.
#[must_use]
pub fn of_axis(axis: &AxisTrace) -> Vec<String> {
    if axis.errors.is_empty() {
        return vec![format!(
            "{}: nothing could be tested with these logs and this machine file.",
            axis.axis
        )];
    }
    let none = axis.found.is_empty().then(|| {
        let what = match verdict::of_axis(axis) {
            Verdict::Explained => "nothing found that the declared model lacks",
            Verdict::Unexplained => "nothing found in the catalogue, though more than noise stays: see below",
            Verdict::ModelDoesNotFit => "no effect found",
        };
        format!("{}: {what}.", axis.axis)
    });
    let found = axis.found.iter().map(|found| sentence(&axis.axis, axis.unit, found));
    let refuted = axis.refuted.iter().map(|found| caveats::refuted(&axis.axis, axis.unit, found));
    let at_limit = axis.refused.iter().map(|limit| caveats::at_limit(&axis.axis, axis.unit, limit));
    let misfit = caveats::misfit(axis).into_iter().chain(caveats::misfit_held_out(axis));
    misfit.chain(none).chain(found).chain(refuted).chain(at_limit).collect()
}

/// The sentences of all axes.
#[must_use]
pub fn summary(trace: &Trace) -> Vec<String> {
    trace.axes.iter().flat_map(of_axis).collect()
}

/// What stays of one stage.
#[must_use]
pub fn remainder(axis: &AxisTrace, rest: &Unexplained) -> String {
    let (unit, _) = residual_unit(axis.unit, rest.channel);
    let noise = axis.errors.iter().find(|error| error.stage == rest.channel).map_or(0.0, |error| error.noise);
    let share = percent(rest.share_percent);
    let follows = match rest.variable {
        Variable::None => "it follows none of the variables tried".to_owned(),
        Variable::Time => {
            let hertz = significant(rest.frequency_hz.unwrap_or(0.0), 3);
            format!("{share} of its power swings at {hertz} Hz")
        }
        Variable::Position => {
            let at = significant(rest.centre_mm.unwrap_or(0.0), 3);
            format!(
                "{share} of its power follows the position, most of all near {at}{}",
                if axis.unit == Unit::Degree { "°" } else { " mm" }
            )
        }
        Variable::Velocity => format!("{share} of its power follows the velocity"),
        Variable::Acceleration => format!("{share} of its power follows the acceleration"),
        Variable::Direction => format!("{share} of its power follows the direction of travel"),
        Variable::Force => format!("{share} of its power follows the drive force"),
        Variable::OtherPosition => format!("{share} of its power follows the other axis's position"),
        Variable::OtherAcceleration => format!("{share} of its power follows the other axis's acceleration"),
    };
    format!(
        "{}, {}: {} {unit} rms stay on the logs that were fitted, where the sensors' noise is {} {unit}; {follows}.",
        axis.axis,
        stage_names(&[rest.channel]),
        significant(rest.rms, 3),
        significant(noise, 3),
    )
}

/// What of a stage's rest comes again with the motion.
#[must_use]
pub fn repeats(axis: &AxisTrace, part: &Repeatability) -> String {
    let (unit, _) = residual_unit(axis.unit, part.channel);
    format!(
        "{}, {}: the motion comes again every {} s; of what stays {} {unit} rms come again with it, and {} {unit} do not, \
         which no model takes away.",
        axis.axis,
        stage_names(&[part.channel]),
        significant(part.period_s, 4),
        significant(part.repeatable, 3),
        significant(part.non_repeatable, 3),
    )
}

/// What the fitted logs did not tell: values that they leave open, and stages in which more stays on other logs.
#[must_use]
pub fn open_ends(axis: &AxisTrace) -> Vec<String> {
    /// So many times as much is more than another motion's share of noise.
    const MORE: f64 = 2.0;
    let keys = axis.model.at_bounds();
    let bounds = (!keys.is_empty()).then(|| {
        format!(
            "{}: {} ended at a bound of the declared tolerance: the logs that were fitted do not tell it, or it lies beyond.",
            axis.axis,
            keys.join(", ")
        )
    });
    let more = axis.errors.iter().filter(|e| e.after.validate > MORE * e.after.fit.max(e.noise)).map(|error| {
        let (unit, _) = residual_unit(axis.unit, error.stage);
        format!(
            "{}, {}: {} {unit} rms stay on motions not used, {} times what stays on those that were: these ask more of the \
             model.",
            axis.axis,
            stage_names(&[error.stage]),
            significant(error.after.validate, 3),
            significant(error.after.validate / error.after.fit, 2),
        )
    });
    bounds
        .into_iter()
        .chain(more)
        .chain(axis.errors.iter().filter_map(|error| caveats::worse(axis, error)))
        .collect()
}

/// What the models are worth without feedback.
#[must_use]
pub fn free_run(run: &FreeRun) -> String {
    format!(
        "{}: under the measured force alone the declared model is {} µm rms astray within {} s, with the effects found \
         {} µm ({} {}, held out).",
        run.axis,
        significant(run.declared_um, 3),
        significant(run.seconds, 2),
        significant(run.after_um, 3),
        run.runs,
        if run.runs == 1 { "run" } else { "runs" },
    )
}

/// Why a stage was not looked at.
#[must_use]
pub fn not_testable(axis: &str, stage: &NotTestable) -> String {
    format!("{axis}, {}: could not be tested; it needs {}.", stage_names(&[stage.stage]), stage.needs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::format::with_spread;
    use model::axis::{Mechanics, Sensors, Settings};
    use model::effects::{Effect, EffectContext, Stage, initial_guesses, names};
    use trace::fit::fit_data::Pair;

    /// One effect of each kind, all its coordinates at 7.25 where their bounds allow.
    fn one_of_each() -> Vec<Effect> {
        let axis = Settings {
            mechanics: Mechanics {
                table_mass_kg: Some(100.0),
                stiffness_n_per_um: Some(200.0),
                coulomb_n: Some(20.0),
                lead_mm: Some(10.0),
                ..Mechanics::default()
            },
            sensors: Sensors { resolver_pole_pairs: Some(5), ..Sensors::default() },
            ..Settings::default()
        };
        let context = EffectContext {
            axis: &axis,
            first: true,
            others: &["q".to_owned()],
            stages: &[Stage::Motor, Stage::Table, Stage::Tool, Stage::Force],
            travel_mm: [0.0, 100.0],
        };
        let alone = EffectContext { stages: &[Stage::Force], ..context };
        let all = [initial_guesses(&context), initial_guesses(&alone)].concat();
        let first = |name: &&str| all.iter().find(|effect| effect.name() == *name).unwrap().clone();
        let moved = |effect: Effect| {
            let values: Vec<f64> =
                effect.coordinates().iter().map(|c| 7.25_f64.clamp(c.lower, c.upper)).collect();
            effect.at(&values)
        };
        names().iter().map(first).map(moved).collect()
    }

    #[test]
    fn every_effect_of_the_catalogue_has_a_sentence_with_its_axis_and_values() {
        for effect in one_of_each() {
            let parameters = effect.parameters();
            let half_widths = vec![0.01; parameters.len()];
            let stage = effect.stages()[0];
            let [before, after] = [100.0, 9.4].map(|validate| Pair { fit: 1.0, validate });
            let found = Found { effect, half_widths, stage, before, after };
            let said = sentence("ax", Unit::Millimetre, &found);
            assert!(said.starts_with("ax: "), "{said}");
            assert!(said.ends_with("residual on motions not used to find it."), "{said}");
            assert!(said.contains("91 %"), "{said}");
            for (name, value) in parameters.iter().filter(|(name, _)| !name.starts_with("phase")) {
                let value = with_spread(*value, 0.01);
                assert!(said.contains(&value), "{name} {value} in: {said}");
            }
            if let Some(source) = found.effect.distinction().source() {
                assert!(said.contains(&format!("axis {source}")), "{said}");
            }
        }
    }

    #[test]
    fn an_effect_that_does_not_help_is_not_praised() {
        let effect: Effect = toml::from_str("name = 'backlash'\nwidth_um = 9.8").unwrap();
        let [before, after] = [100.0, 103.2].map(|validate| Pair { fit: 1.0, validate });
        let found = Found { effect, half_widths: vec![0.1], stage: Stage::Table, before, after };
        assert_eq!(
            sentence("x", Unit::Millimetre, &found),
            "x: 9.8 ± 0.1 µm backlash between screw and table; the table residual is 3 % larger with it on motions \
             not used to find it."
        );
    }
}
