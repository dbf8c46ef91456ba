//! Machines whose tool follows a law of one to three terms, and nothing else that the machine file does not declare: whether a trace
//! finds the law.
//!
//! The size of a term is the rms of what it adds to the tool over the logs to fit, divided by the noise of the probe.

use rand::RngExt;
use serde_json::{Value, json};

use super::case::{Case, Purpose, block, run_session, stream};
use super::detection::noise_free;
use super::draw::{self, Drawn, Motion};
use super::kind::Kind;
use super::law::{Form, LawTerm};
use super::law_intervals::Intervals;
use super::machine::AXES;
use files::error::InputError;
use files::log::Log;

/// Sizes of a term in units of the noise, log-uniform.
const SIZES: [f64; 2] = [3.0, 100.0];

/// Largest relative error of a period or a distance that was found.
const MAX_LENGTH_ERROR: f64 = 0.25;

/// A machine with a law.
pub struct LawCase {
    /// Index of the axis.
    pub axis: usize,
    /// The true terms with their sizes.
    pub terms: Vec<(LawTerm, f64)>,
    /// The machine with its logs.
    pub case: Case,
}

impl LawCase {
    /// Draws a case, which follows from seed and number.
    ///
    /// # Errors
    /// As [`Case::draw`].
    pub fn draw(seed: u64, number: u64) -> Result<Self, InputError> {
        // One above that of the detection curve.
        let stream = |purpose| stream(block::LAWS, seed, number, purpose);
        let mut random = stream(Purpose::Machine);
        let mut drawn = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
        let session = draw::session(&mut random);
        let axis = random.random_range(0..AXES.len());
        let mut terms: Vec<(LawTerm, f64)> = Vec::new();
        let count = random.random_range(1..=3);
        while terms.len() < count {
            let form = Form::draw(&mut random);
            if terms.iter().any(|(known, _)| known.form.described() == form.described()) {
                continue;
            }
            let size = SIZES[0] * libm::pow(SIZES[1] / SIZES[0], random.random_range(0.0..1.0));
            let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
            let unit = LawTerm { form, factor: 1.0 };
            let noise_m = 1e-3 * drawn.axes[axis].sensors.tool.deviation();
            let factor = sign * size * noise_m / rms_m(unit, axis, &drawn, &session);
            terms.push((LawTerm { form, factor }, size));
        }
        drawn.axes[axis].law = terms.iter().map(|(term, _)| *term).collect();
        let logs = run_session(&drawn, &session, |log| stream(Purpose::Log(log)));
        let case = Case::new((Kind::Textbook, number), &drawn, Vec::new(), logs)?;
        Ok(Self { axis, terms, case })
    }
}

/// Rms of what a term adds to the tool over the logs to fit, m.
fn rms_m(term: LawTerm, axis: usize, bare: &Drawn, session: &[Motion]) -> f64 {
    // Small enough not to overflow the resolution of a log, large enough to be exact in it.
    const SCALE: f64 = 1e-6;
    let tool = |law: Vec<LawTerm>| {
        let mut drawn = bare.clone();
        drawn.axes[axis].law = law;
        let of_log = |log: &Log| log.axes[axis].tool.clone().unwrap_or_default();
        noise_free(&drawn, session).iter().flat_map(of_log).collect::<Vec<f64>>()
    };
    let scaled = LawTerm { factor: SCALE * term.factor, ..term };
    let (with, without) = (tool(vec![scaled]), tool(Vec::new()));
    1e-3 * numerics::rms(with.iter().zip(&without).map(|(a, b)| a - b)) / SCALE
}

/// What a trace finds of a law.
#[derive(Clone, Debug, PartialEq)]
pub struct LawOutcome {
    /// Number of the case.
    pub number: u64,
    /// The true terms: kind, variables and size.
    pub truths: Vec<Value>,
    /// The terms found on the axis of the law.
    pub found: Vec<Value>,
    /// Whether the law has the true terms and no others.
    pub is_right: bool,
    /// Terms that are stated as certain and not true, of all axes, and effects that are stated as certain.
    pub false_terms: Vec<String>,
    /// Rms that remains on the held-out logs over the noise.
    pub left: Option<f64>,
    /// Intervals of the coefficients of true terms.
    pub coefficients: Intervals,
    /// Intervals of their periods and distances.
    pub lengths: Intervals,
}

impl LawOutcome {
    /// Compares the JSON of a trace with the true law.
    #[must_use]
    pub fn of(law: &LawCase, trace: &Value) -> Self {
        let axis = AXES[law.axis];
        let entries = |key: &str| trace[key].as_array().cloned().unwrap_or_default();
        let is_of_law = |entry: &Value| entry["axis"] == axis && entry["channel"] == "tool";
        let mut found = Vec::new();
        let mut false_terms = Vec::new();
        for entry in entries("laws") {
            for term in entry["terms"].as_array().into_iter().flatten() {
                let is_true =
                    is_of_law(&entry) && law.terms.iter().any(|(truth, _)| is_same(&truth.form, term));
                if term["is_certain"] == true && !is_true {
                    false_terms.push(format!("{}: {}", entry["axis"], term["form"]));
                }
                if is_of_law(&entry) {
                    found.push(term.clone());
                }
            }
        }
        for effect in entries("effects").iter().filter(|effect| effect["certainty"] == "certain") {
            false_terms.push(format!("{}: {}", effect["axis"], effect["name"]));
        }
        let is_found = |(truth, _): &(LawTerm, f64)| found.iter().any(|term| is_same(&truth.form, term));
        let [coefficients, lengths] = intervals(law, &found);
        let of_channel = entries("residual").into_iter().find(is_of_law).unwrap_or_default();
        let of_law =
            entries("laws").into_iter().find(is_of_law).map(|entry| entry["after"]["validate"].as_f64());
        let after = of_law.unwrap_or_else(|| of_channel["after_um"]["validate"].as_f64());
        Self {
            number: law.case.number,
            truths: law.terms.iter().map(truth).collect(),
            is_right: law.terms.iter().all(is_found) && found.len() == law.terms.len(),
            found,
            false_terms,
            left: after.zip(of_channel["noise_um"].as_f64()).map(|(after, noise)| after / noise),
            coefficients,
            lengths,
        }
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "case": self.number,
            "truth": self.truths,
            "found": self.found,
            "is_right": self.is_right,
            "false": self.false_terms,
            "left_over_noise": self.left,
            "coefficients_in_ci95": [self.coefficients.right, self.coefficients.all],
            "lengths_in_ci95": [self.lengths.right, self.lengths.all],
        })
    }
}

/// The intervals of coefficients, and those of periods and distances, of the true terms that were found.
fn intervals(law: &LawCase, found: &[Value]) -> [Intervals; 2] {
    let (mut coefficients, mut lengths) = (Intervals::default(), Intervals::default());
    for (truth, _) in &law.terms {
        let Some(term) = found.iter().find(|term| is_same(&truth.form, term)) else { continue };
        let ci95 = term["ci95"].as_array().into_iter().flatten();
        for (um, interval) in truth.coefficients_um().into_iter().zip(ci95) {
            coefficients.add(um, interval);
        }
        if let Some(mm) = truth.form.length_mm() {
            lengths.add(mm, &term["length_ci95_mm"]);
        }
    }
    [coefficients, lengths]
}

fn truth((term, size): &(LawTerm, f64)) -> Value {
    let (kind, of) = term.form.described();
    json!({"kind": kind, "of": of, "length_mm": term.form.length_mm(), "size": size})
}

/// Whether a term that was found has the form of a true one.
fn is_same(form: &Form, term: &Value) -> bool {
    let (kind, of) = form.described();
    let length = ["period_mm", "distance_mm"].iter().find_map(|key| term[*key].as_f64());
    let is_near = match (form.length_mm(), length) {
        (Some(truth), Some(found)) => (found / truth - 1.0).abs() < MAX_LENGTH_ERROR,
        (truth, _) => truth.is_none(),
    };
    let sorted = |mut names: Vec<String>| {
        names.sort_unstable();
        names
    };
    let names = term["of"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let found = sorted(names.map(str::to_owned).collect());
    term["kind"] == kind && is_near && found == sorted(of.iter().map(|name| (*name).to_owned()).collect())
}

/// The summary of the cases: sentences.
#[must_use]
pub fn summary(seed: u64, outcomes: &[LawOutcome]) -> String {
    let n = outcomes.len();
    let count = |is: fn(&LawOutcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
    let right = count(|outcome| outcome.is_right);
    let wrong = count(|outcome| !outcome.false_terms.is_empty());
    let left = count(|outcome| outcome.left.is_some_and(|left| left < 1.3));
    let of = |counts: fn(&LawOutcome) -> Intervals| {
        let Intervals { right, all } = Intervals::sum(outcomes.iter().map(counts));
        format!("{right} of {all}")
    };
    let mut lines = vec![
        format!(
            "Laws of the tool on {n} machines, seed {seed}, one to three terms of 3 to 100 times the noise:"
        ),
        format!(
            "exactly the true terms on {right} of {n}; a false term or effect stated as certain on {wrong};"
        ),
        format!("at most 1.3 times the noise left on held-out motions of {left};"),
        format!(
            "intervals with the true value: {} of coefficients, {} of periods and distances.",
            of(|one| one.coefficients),
            of(|one| one.lengths)
        ),
    ];
    for outcome in outcomes.iter().filter(|outcome| !outcome.is_right || !outcome.false_terms.is_empty()) {
        let of = |terms: &[Value], key: &str| {
            let names = terms.iter().map(|term| term[key].to_string().replace('"', ""));
            names.collect::<Vec<_>>().join("; ")
        };
        lines.push(format!(
            "case {}: true {}; found {}{}",
            outcome.number,
            of(&outcome.truths, "of"),
            of(&outcome.found, "form"),
            if outcome.false_terms.is_empty() {
                String::new()
            } else {
                format!("; false and certain: {}", outcome.false_terms.join(", "))
            }
        ));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Memories;
    use crate::plant::State;

    /// The forms, at one state, against products written out; a memory after 3 mm forwards and 2 mm back over 4 mm.
    #[test]
    fn a_term_is_its_form_times_its_factor() {
        let own = State { table_m: 0.02, table_m_per_s: -0.1, table_m_per_s2: 2.0, ..State::default() };
        let other = State { table_m: -0.05, table_m_per_s: 0.3, ..State::default() };
        let law = |form| [LawTerm { form, factor: 2.0 }];
        let at = |form| crate::law::displacement_m(&law(form), &own, &other, &Memories::default());
        for (form, expected) in [
            (Form::OwnTimesOther, 0.02 * -0.05),
            (Form::Speed, 0.1),
            (Form::VelocitySquared, 0.01),
            (Form::OtherCubed, -0.05 * 0.05 * 0.05),
            (Form::VelocityTimesOther, 0.1 * 0.05),
            (Form::AccelerationTimesOther, -0.1),
            (Form::OtherVelocity, 0.3),
            (Form::OtherWave(0.2, 0.0), -1.0),
        ] {
            assert!((at(form) / (2.0 * expected) - 1.0).abs() < 1e-12, "{form:?}");
        }
        // The direction turns over within 0.05 mm/s: 0.1 of 0.10005.
        assert!((at(Form::OwnTimesDirection) / (-2.0 * 0.02) - 1.0).abs() < 1e-3);
        let hysteresis = law(Form::Hysteresis(4e-3));
        let mut memories = Memories::default();
        for step in 0..5000 {
            let moved_m = if step < 3000 { 1e-6 } else { -1e-6 };
            memories.follow(&hysteresis, 0.0, moved_m);
        }
        let there = 1.0 - libm::exp(-0.75);
        let back = -1.0 + (there + 1.0) * libm::exp(-0.5);
        let found = crate::law::displacement_m(&hysteresis, &own, &other, &memories);
        // Steps of 1 µm over 4 mm: an error of half a step in the exponent.
        assert!((found - 2.0 * back).abs() < 1e-3, "{found} {back}");
    }

    /// 2 m per m² are 2 µm per mm²; a wave of 2 m with a phase of 30° is 1 m of cosine.
    #[test]
    fn a_coefficient_is_in_the_units_of_a_trace() {
        let of = |form| LawTerm { form, factor: 2.0 }.coefficients_um();
        assert!((of(Form::OwnTimesOther)[0] - 2.0).abs() < 1e-12);
        assert!((of(Form::VelocityTimesOther)[0] - 2e3).abs() < 1e-9);
        assert!((of(Form::Hysteresis(0.01))[0] - 2e6).abs() < 1e-6);
        let wave = of(Form::OtherWave(0.02, std::f64::consts::FRAC_PI_6));
        assert!((wave[0] - 1e6).abs() < 1e-6 && (wave[1] - 1e6 * 3f64.sqrt()).abs() < 1e-6, "{wave:?}");
    }

    #[test]
    fn a_case_has_terms_of_the_drawn_sizes() {
        let law = LawCase::draw(5, 2).unwrap();
        assert!((1..=3).contains(&law.terms.len()));
        for (term, size) in &law.terms {
            assert!((SIZES[0]..=SIZES[1]).contains(size) && term.factor != 0.0, "{term:?} {size}");
        }
    }

    #[test]
    fn terms_of_other_forms_or_lengths_are_not_the_true_ones() {
        let wave = Form::OtherWave(0.02, 1.0);
        let found =
            |kind: &str, of: &[&str], period_mm: f64| json!({"kind": kind, "of": of, "period_mm": period_mm});
        assert!(is_same(&wave, &found("wave", &["other_position_mm"], 21.0)));
        assert!(!is_same(&wave, &found("wave", &["other_position_mm"], 40.0)));
        assert!(!is_same(&wave, &found("wave", &["position_mm"], 20.0)));
        let product = json!({"kind": "product", "of": ["other_position_mm", "position_mm"]});
        assert!(is_same(&Form::OwnTimesOther, &product) && !is_same(&Form::Speed, &product));
    }
}
