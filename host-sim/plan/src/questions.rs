//! What the model of a trace leaves open.

use model::effects::Effect;
use model::machine::evidence::{Certainty, Evidence};
use model::machine::{Axis, Machine};

/// An effect and its rivals: which of them does the machine have? Without rivals: does it have the effect, where more than the noise
/// remained?
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Name of the axis.
    pub axis: String,
    /// Index of the effect in the model of the axis.
    pub index: usize,
    /// The effect of the model, then its rivals, as the trace fitted them.
    pub candidates: Vec<Effect>,
}

/// An ambiguous effect that no motion decides.
#[derive(Clone, Debug, PartialEq)]
pub struct Undecidable {
    /// Name of the axis.
    pub axis: String,
    /// Name of the effect.
    pub effect: String,
    /// Names of its rivals.
    pub rivals: Vec<String>,
    /// What decides.
    pub decided_by: Vec<String>,
}

/// An axis of which the trace left more than noise unexplained.
#[derive(Clone, Debug, PartialEq)]
pub struct Unexplained {
    /// Name of the axis.
    pub axis: String,
    /// The residual, µm rms; on a rotary axis thousandths of a degree.
    pub um: f64,
}

/// Residual above which an axis is not described, µm rms: a trace does not say of less that the model does not fit.
const DESCRIBED_UM: f64 = 0.05;

/// The axes that the model does not describe.
#[must_use]
pub fn unexplained(model: &Machine) -> Vec<Unexplained> {
    let left = model.axis.iter().filter_map(|(name, axis)| Some((name, axis.log_offsets?.unexplained_um?)));
    left.filter(|(_, um)| *um > DESCRIBED_UM)
        .map(|(name, um)| Unexplained { axis: name.clone(), um })
        .collect()
}

/// The questions of a model.
#[must_use]
pub fn questions(model: &Machine) -> Vec<Question> {
    let of_axis = |(name, axis): (&String, &Axis)| {
        let of_effect = |(index, (effect, evidence)): (usize, (&Effect, &Evidence))| {
            let candidates: Vec<Effect> =
                std::iter::once(effect).chain(&evidence.alternatives).cloned().collect();
            // What the channels do not tell apart stays ambiguous in every motion.
            let is_open = evidence.certainty == Certainty::Ambiguous && evidence.decided_by.is_empty();
            is_open.then(|| Question { axis: name.clone(), index, candidates })
        };
        axis.effect.iter().zip(&axis.evidence).enumerate().filter_map(of_effect).collect::<Vec<_>>()
    };
    model.axis.iter().flat_map(of_axis).collect()
}

/// The ambiguous effects of a model whose rivals differ from them in no motion, as far as the trace knows.
#[must_use]
pub fn undecidable(model: &Machine) -> Vec<Undecidable> {
    let of_axis = |(name, axis): (&String, &Axis)| {
        let open = axis.evidence.iter().filter(|one| one.certainty == Certainty::Ambiguous);
        let alone = open.filter(|one| !one.decided_by.is_empty());
        let of = |one: &Evidence| Undecidable {
            axis: name.clone(),
            effect: one.effect.clone(),
            rivals: one.rivals.clone(),
            decided_by: one.decided_by.clone(),
        };
        alone.map(of).collect::<Vec<_>>()
    };
    model.axis.iter().flat_map(of_axis).collect()
}

/// The machine as it was declared: values before their fit, without the effects that the trace found.
#[must_use]
pub fn declared(model: &Machine) -> Machine {
    let mut machine = model.clone();
    for axis in machine.axis.values_mut() {
        let found: Vec<bool> = axis.evidence.iter().map(|one| one.certainty != Certainty::Declared).collect();
        *axis = axis.at_nominal();
        let mut found = found.into_iter();
        axis.effect.retain(|_| !found.next().unwrap_or(false));
    }
    machine
}

impl Question {
    /// The names of the candidates.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        self.candidates.iter().map(Effect::name).collect()
    }

    /// The model with one of the candidates.
    #[must_use]
    pub fn answered(&self, model: &Machine, candidate: usize) -> Machine {
        let mut machine = model.clone();
        if let (Some(axis), Some(effect)) = (machine.axis.get_mut(&self.axis), self.candidates.get(candidate))
            && let Some(place) = axis.effect.get_mut(self.index)
        {
            *place = effect.clone();
            // What is known of the effect of the model is not known of its rival.
            axis.evidence.clear();
        }
        machine
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: &str = r#"
        name = "m"
        sample_rate_hz = 1000.0
        [axis.x]
        table_mass_kg = 110.0
        coulomb_n = 20.0
        plant_tolerance_percent = 20.0
        [axis.x.nominal]
        table_mass_kg = 100.0
        [[axis.x.effect]]
        name = "backlash"
        width_um = 4.0
        [[axis.x.effect]]
        name = "intalk"
        um_s2_per_m = 3.0
        [[axis.x.effect]]
        name = "thermal_drift"
        amplitude_um = 4.0
        time_constant_s = 30.0
        [[axis.x.evidence]]
        effect = "backlash"
        certainty = "declared"
        [[axis.x.evidence]]
        effect = "intalk"
        certainty = "ambiguous"
        half_widths = [0.5]
        rivals = ["latency"]
        [[axis.x.evidence.alternative]]
        name = "latency"
        channel = "tool"
        ms = 0.4
        [[axis.x.evidence]]
        effect = "thermal_drift"
        certainty = "ambiguous"
        rivals = ["scale_growth"]
        decided_by = ["a probe"]
    "#;

    #[test]
    fn a_model_asks_what_a_motion_may_decide_and_says_what_none_does() {
        let model = Machine::parse(MODEL, "m.toml").unwrap();
        let [question] = &questions(&model)[..] else { panic!("one question") };
        let names: Vec<&str> = question.candidates.iter().map(Effect::name).collect();
        assert_eq!((question.axis.as_str(), names), ("x", vec!["intalk", "latency"]));
        let [open] = &undecidable(&model)[..] else { panic!("one imitation") };
        assert_eq!(
            (open.effect.as_str(), &open.decided_by[..]),
            ("thermal_drift", &["a probe".to_owned()][..])
        );
        let rival = question.answered(&model, 1);
        let names: Vec<&str> = rival.axis["x"].effect.iter().map(Effect::name).collect();
        assert_eq!(names, ["backlash", "latency", "thermal_drift"]);
        assert_eq!(rival.axis["x"].settings.mechanics.table_mass_kg, Some(110.0));
        // The file that is written is read again with the alternative.
        assert_eq!(Machine::parse(&model.to_toml(), "again.toml").unwrap(), model);
    }

    #[test]
    fn an_axis_that_the_trace_did_not_describe_is_told() {
        let left = |um: &str| {
            let offsets = format!("[axis.x.log_offsets]\nunexplained_um = {um}\n");
            unexplained(&Machine::parse(&format!("{MODEL}{offsets}"), "m.toml").unwrap())
        };
        assert_eq!(left("0.06"), [Unexplained { axis: "x".to_owned(), um: 0.06 }]);
        assert_eq!(left("0.04"), []);
        assert_eq!(unexplained(&Machine::parse(MODEL, "m.toml").unwrap()), []);
    }

    #[test]
    fn the_declared_machine_has_its_nominal_values_and_only_declared_effects() {
        let declared = declared(&Machine::parse(MODEL, "m.toml").unwrap());
        let axis = &declared.axis["x"];
        let names: Vec<&str> = axis.effect.iter().map(Effect::name).collect();
        assert_eq!((axis.settings.mechanics.table_mass_kg, names), (Some(100.0), vec!["backlash"]));
        assert!(axis.evidence.is_empty() && axis.nominal.is_none());
    }

    #[test]
    fn an_alternative_that_is_no_effect_is_refused_with_its_key() {
        let refused = |from: &str, to: &str| {
            Machine::parse(&MODEL.replace(from, to), "m.toml").unwrap_err().to_string()
        };
        let error = refused("ms = 0.4", "ms = \"late\"");
        assert!(error.contains("axis.x.evidence[1].alternative[0].ms"), "{error}");
        let error = refused("name = \"latency\"", "name = \"lateness\"");
        assert!(error.contains("axis.x.evidence[1].alternative[0].name"), "{error}");
    }
}
