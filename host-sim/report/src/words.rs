//! What was found and what was not, in the words of somebody who builds machines.

use super::doubts;
use super::number::{percent, significant, with_spread};
use files::log::Unit;
use model::effects::{Channel, Effect};
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

/// What an effect does, with its parameters. The half widths of their intervals are in the order of
/// [`Effect::parameters`]; those that are missing are not told.
#[must_use]
#[expect(clippy::too_many_lines, reason = "one sentence an effect")]
pub fn effect(effect: &Effect, half_widths: &[f64]) -> String {
    let parameters = effect.parameters();
    let half = |i: usize| half_widths.get(i).copied().unwrap_or(0.0);
    let of = |i: usize, unit: &str| format!("{} {unit}", with_spread(parameters[i].1, half(i)));
    let size = |i: usize, unit: &str| format!("{} {unit}", with_spread(parameters[i].1.abs(), half(i)));
    let is_positive = parameters[0].1 >= 0.0;
    match effect {
        Effect::Backlash(_) => format!("{} backlash between screw and table", of(0, "µm")),
        Effect::PitchProgressive(_) => {
            let how = if is_positive { "further" } else { "less far" };
            format!("the screw carries the table {} {how} than its nominal lead", size(0, "µm/m"))
        }
        Effect::PitchCyclic(_) => {
            format!("the screw's pitch wobbles by {} every {}", of(0, "µm (amplitude)"), of(1, "mm"))
        }
        Effect::ResolverDividing(_) => {
            format!("the motor reading wobbles by {} every {}", of(0, "µm (amplitude)"), of(1, "mm"))
        }
        Effect::Windup(windup) if windup.friction_n.is_some() => {
            let turn = windup
                .presliding_mm
                .map_or_else(String::new, |_| format!(", which turns round over {}", of(2, "mm")));
            format!(
                "the drive force winds up the drive train, with {} between motor and table; friction before it takes \
                 {}{turn}",
                of(0, "N/µm"),
                of(1, "N")
            )
        }
        Effect::Windup(_) => {
            format!("the drive train has {} between motor and table, outside what is declared", of(0, "N/µm"))
        }
        Effect::Stribeck(_) => {
            format!("friction rises by {} towards standstill, below {}", of(0, "N"), of(1, "mm/s"))
        }
        Effect::FrictionAsymmetry(_) => {
            let [more, less] = if is_positive { ["+", "−"] } else { ["−", "+"] };
            let size = size(0, "N·s/m");
            format!(
                "viscous friction is {size} higher in {more} direction and as much lower in {less} direction"
            )
        }
        Effect::TorqueRipple(_) => {
            format!("the drive force ripples by {} every {}", of(0, "N (amplitude)"), of(1, "mm"))
        }
        Effect::ConstantLoad(_) => {
            let direction = if is_positive { "+" } else { "−" };
            format!("a constant load of {} against motion in {direction} direction", size(0, "N"))
        }
        Effect::Presliding(_) => format!(
            "friction builds up against a stiffness of {}, damped by {}, before the axis slides",
            of(0, "N/µm"),
            of(1, "N·s/m")
        ),
        Effect::ShearThinning(_) => format!(
            "sliding friction lacks {} at standstill and comes up to its level within {}",
            of(0, "N"),
            of(1, "mm/s")
        ),
        Effect::FrictionMemory(_) => {
            let how = if is_positive { "behind" } else { "ahead of" };
            format!("{} of viscous friction are {how} the speed, by {}", size(0, "N·s/m"), of(1, "s"))
        }
        Effect::PreloadVariation(_) => format!(
            "friction changes along the travel, from the middle at {} by {} and {}",
            of(0, "mm"),
            of(1, "N/m"),
            of(2, "N/m²")
        ),
        Effect::FrictionRipple(_) => {
            format!("friction goes up and down by {} every {}", of(0, "N (amplitude)"), of(1, "mm"))
        }
        Effect::ServoMismatch(_) => {
            let how = if is_positive { "above" } else { "below" };
            format!("the position gain lies {} {how} the declared one", size(0, "%"))
        }
        Effect::VelocityLag(_) => format!("the velocity loop acts on a speed that is {} old", of(0, "ms")),
        Effect::Intalk(_) => {
            format!("the tool leans by {} of the axis's own acceleration", of(0, "µm per m/s²"))
        }
        Effect::Crosstalk(e) => {
            format!("the tool leans by {} of acceleration of axis {}", of(0, "µm per m/s²"), e.source)
        }
        Effect::Squareness(_) => {
            format!("out of square, the tool goes astray by {} of the other axis's travel", of(0, "µm per m"))
        }
        Effect::Straightness(e) => {
            let near = significant(0.01 * e.um_per_m2.abs(), 2);
            format!(
                "the guide of axis {} is bent, which moves the tool by {} ({near} µm at 100 mm)",
                e.source,
                of(0, "µm/m²")
            )
        }
        Effect::ThermalDrift(_) => format!(
            "the tool drifts by {} while the machine warms up, with a time constant of {}",
            of(0, "µm"),
            of(1, "s")
        ),
        Effect::Latency(e) => {
            let channel = match e.channel {
                Channel::Table => "table reading",
                Channel::Tool => "tool reading",
                Channel::Force => "force",
            };
            let how = if is_positive { "late" } else { "early" };
            format!("the {channel} is logged {} {how}", size(0, "ms"))
        }
        Effect::Resonance(_) => format!(
            "the tool swings behind the table at {}, with a damping ratio of {}",
            of(0, "Hz"),
            of(1, "").trim_end()
        ),
    }
}

/// The same of a rotary axis, where mm stand for degrees and N for N·m: 1 m is 1000°.
#[must_use]
pub fn rotary(linear: &str) -> String {
    const WORDS: [(&str, &str); 18] = [
        ("screw's pitch", "gear's ratio"),
        ("screw", "gear"),
        ("nominal lead", "nominal ratio"),
        ("drive force", "drive torque"),
        ("of the force", "of the torque"),
        ("a force", "a torque"),
        ("µm per m/s²", "mdeg per 1000°/s²"),
        ("µm/m²", "mdeg per (1000°)²"),
        ("µm/m", "mdeg per 1000°"),
        ("µm per m", "mdeg per 1000°"),
        ("N/µm", "N·m/mdeg"),
        ("N·s/m", "N·m·s per 1000°"),
        ("µm at 100 mm", "mdeg at 100°"),
        ("µm", "mdeg"),
        (" mm/s", "°/s"),
        (" mm", "°"),
        (" N ", " N·m "),
        (" N,", " N·m,"),
    ];
    let said = WORDS.iter().fold(linear.to_owned(), |said, (linear, rotary)| said.replace(linear, rotary));
    said.strip_suffix(" N").map_or(said.clone(), |start| format!("{start} N·m"))
}

/// The sentence for an effect that was found.
#[must_use]
pub fn sentence(axis: &str, unit: Unit, found: &Found) -> String {
    let what = effect(&found.effect, &found.half_widths);
    let what = if unit == Unit::Degree { rotary(&what) } else { what };
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
    let refuted = axis.refuted.iter().map(|found| doubts::refuted(&axis.axis, axis.unit, found));
    let at_limit = axis.refused.iter().map(|limit| doubts::at_limit(&axis.axis, axis.unit, limit));
    let misfit = doubts::misfit(axis).into_iter().chain(doubts::misfit_held_out(axis));
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
        .chain(axis.errors.iter().filter_map(|error| doubts::worse(axis, error)))
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
pub(super) mod tests {
    use super::*;
    use model::effects::{NAMES, Stage, Surroundings, candidates};
    use model::machine::Axis;
    use trace::fit::fit_data::Pair;

    /// One effect of each kind, all its coordinates at 7.25 where their bounds allow.
    pub(crate) fn one_of_each() -> Vec<Effect> {
        let axis = Axis {
            table_mass_kg: Some(100.0),
            stiffness_n_per_um: Some(200.0),
            coulomb_n: Some(20.0),
            lead_mm: Some(10.0),
            resolver_pole_pairs: Some(2),
            ..Axis::default()
        };
        let around = Surroundings {
            axis: &axis,
            first: true,
            others: &["q".to_owned()],
            stages: &[Stage::Motor, Stage::Table, Stage::Tool, Stage::Force],
            travel_mm: [0.0, 100.0],
        };
        let all =
            [candidates(&around), candidates(&Surroundings { stages: &[Stage::Force], ..around })].concat();
        let first = |name: &&str| all.iter().find(|effect| effect.name() == *name).unwrap().clone();
        let moved = |effect: Effect| {
            let values: Vec<f64> =
                effect.coordinates().iter().map(|c| 7.25_f64.clamp(c.lower, c.upper)).collect();
            effect.at(&values)
        };
        NAMES.iter().map(first).map(moved).collect()
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
            if let Some(source) = trace::json::source(&found.effect) {
                assert!(said.contains(&format!("axis {source}")), "{said}");
            }
        }
    }

    #[test]
    fn a_sign_is_told_in_words() {
        let said = |text: &str| {
            let effect: Effect = toml::from_str(text).unwrap();
            super::effect(&effect, &[])
        };
        assert_eq!(
            said("name = 'constant_load'\nforce_n = -3.5"),
            "a constant load of 3.500 N against motion in − direction"
        );
        assert!(said("name = 'servo_mismatch'\npercent = -4").contains("4.000 % below"));
        assert!(
            said("name = 'latency'\nchannel = 'tool'\nms = 2")
                .contains("tool reading is logged 2.000 ms late")
        );
        assert!(said("name = 'pitch_progressive'\nslope_um_per_m = -40").contains("40.00 µm/m less far"));
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
