//! Statistics of all cases of a self-test.

use numerics::distributions::wilson_interval;
use numerics::quantile;
use serde_json::{Map, Value, json};

use super::confusion::Confusion;
use super::kind::Kind;
use super::outside::Answer;
use super::score::{Estimate, Outcome};
use super::truth::{CONTROLLER, NAMES};

/// A count of successes in trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Proportion {
    /// Successes.
    pub hits: usize,
    /// Trials.
    pub trials: usize,
}

impl Proportion {
    pub(super) fn of(each: impl Iterator<Item = bool>) -> Self {
        each.fold(Self::default(), |sum, hit| Self {
            hits: sum.hits + usize::from(hit),
            trials: sum.trials + 1,
        })
    }

    /// Successes over trials, 0 to 1; NaN without trials.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        self.hits as f64 / self.trials as f64
    }

    /// 95 % confidence interval of the probability.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        wilson_interval(self.hits, self.trials)
    }

    pub(super) fn json(self) -> Value {
        let Self { hits, trials } = self;
        json!({"hits": hits, "of": trials, "share": finite(self.fraction()), "interval95": self.interval()})
    }
}

/// Distribution of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Number of values.
    pub count: usize,
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub percentile95: f64,
}

impl Spread {
    fn of(values: &[f64]) -> Self {
        Self { count: values.len(), median: quantile(values, 0.5), percentile95: quantile(values, 0.95) }
    }

    fn json(self) -> Value {
        json!({"count": self.count, "median": finite(self.median), "percentile95": finite(self.percentile95)})
    }
}

/// One parameter of one effect over all cases in which the effect was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the effect.
    pub effect: &'static str,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Relative errors, not negative, by case.
    pub errors: Vec<f64>,
    /// Distribution of the errors.
    pub error: Spread,
    /// How many 95 % confidence intervals contain the true value; `None` for a parameter that the machine file
    /// determines.
    pub coverage: Option<Proportion>,
}

/// All statistics of a self-test.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Cases with exactly the right effects.
    pub exact: Proportion,
    /// Effects of the catalogue that were found.
    pub found: Proportion,
    /// Number of false effects: found but not true.
    pub false_finds: usize,
    /// False effects that the trace does not call ambiguous.
    pub certain_false_finds: usize,
    /// Effects that were found again on the same axis, which the score counts once.
    pub duplicates: usize,
    /// Machines without undeclared effects in which nothing was found.
    pub clean: Proportion,
    /// Effects from outside the catalogue that the trace described.
    pub outside: Proportion,
    /// Things from outside the catalogue, in the other kinds, that were given their name.
    pub named: Proportion,
    /// Things from outside the catalogue, in the other kinds, that were named or at least reported as unexplained.
    pub described: Proportion,
    /// Number of reported faults of the data that are not there.
    pub false_faults: usize,
    /// By effect and parameter, in the order of the catalogue.
    pub parameters: Vec<Parameter>,
    /// Errors of all parameters that the machine file does not determine.
    pub error: Spread,
    /// How many of their 95 % confidence intervals contain the true value.
    pub coverage: Proportion,
    /// Ratio of the rms residual after the search to the noise, on the held-out logs, by channel.
    pub ratios: Vec<(&'static str, Spread)>,
    /// The confusion matrix.
    pub confusion: Confusion,
}

impl Summary {
    /// Statistics of these outcomes.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let missed: usize = outcomes.iter().map(|outcome| outcome.missed().len()).sum();
        let there = outcomes.iter().flat_map(|outcome| &outcome.truths).filter(|t| !t.is_outside()).count();
        let estimates: Vec<&Estimate> = outcomes.iter().flat_map(|outcome| &outcome.estimates).collect();
        let fitted = || estimates.iter().filter(|estimate| !estimate.is_declared());
        let errors: Vec<f64> = fitted().map(|estimate| estimate.error()).collect();
        let clean = outcomes.iter().filter(|outcome| outcome.is_clean());
        let outside = outcomes.iter().flat_map(|outcome| &outcome.described);
        let answers = || outcomes.iter().flat_map(Outcome::counted_answers);
        Self {
            exact: Proportion::of(outcomes.iter().map(Outcome::is_exact)),
            found: Proportion { hits: there - missed, trials: there },
            false_finds: outcomes.iter().map(|outcome| outcome.false_finds().len()).sum(),
            certain_false_finds: outcomes.iter().map(|outcome| outcome.certain_false_finds().len()).sum(),
            duplicates: outcomes.iter().map(Outcome::duplicates).sum(),
            clean: Proportion::of(clean.map(Outcome::is_exact)),
            outside: Proportion::of(outside.copied()),
            named: Proportion::of(answers().map(|answer| answer.is_named)),
            described: Proportion::of(answers().map(Answer::is_described)),
            false_faults: outcomes.iter().map(|outcome| outcome.false_faults().len()).sum(),
            parameters: parameters(&estimates),
            error: Spread::of(&errors),
            coverage: Proportion::of(fitted().map(|estimate| estimate.is_covered())),
            ratios: ["table", "force", "motor", "tool"]
                .map(|channel| (channel, of_channel(outcomes, channel)))
                .to_vec(),
            confusion: Confusion::new(outcomes),
        }
    }

    /// Its entry in the JSON of the self-test.
    #[must_use]
    pub fn json(&self) -> Value {
        let mut parameters = Map::new();
        for p in &self.parameters {
            let mut entry = json!({"error": p.error.json()});
            if let (Some(coverage), Value::Object(entry)) = (p.coverage, &mut entry) {
                entry.insert("coverage".to_owned(), coverage.json());
            }
            parameters.insert(format!("{}.{}", p.effect, p.parameter), entry);
        }
        let ratios: Map<String, Value> =
            self.ratios.iter().map(|(channel, spread)| ((*channel).to_owned(), spread.json())).collect();
        json!({
            "exact": self.exact.json(),
            "found": self.found.json(),
            "missed": self.found.trials - self.found.hits,
            "false": self.false_finds,
            "false_certain": self.certain_false_finds,
            "doubled": self.duplicates,
            "clean": self.clean.json(),
            "outside": self.outside.json(),
            "outside_named": self.named.json(),
            "outside_described": self.described.json(),
            "false_faults": self.false_faults,
            "parameter_error": {"all": self.error.json(), "by_parameter": parameters},
            "coverage": self.coverage.json(),
            "after_over_noise": ratios,
            "confusion": self.confusion.json(),
        })
    }
}

/// The outcomes of each kind that occurs, in the order of the kinds.
#[must_use]
pub fn by_kind(outcomes: &[Outcome]) -> Vec<(Kind, Vec<Outcome>)> {
    let of = |kind: Kind| outcomes.iter().filter(|outcome| outcome.kind == kind).cloned().collect();
    let all = Kind::ALL.into_iter().map(|kind| (kind, of(kind)));
    all.filter(|(_, outcomes): &(_, Vec<_>)| !outcomes.is_empty()).collect()
}

/// The statistics of each kind by its name.
#[must_use]
pub fn kinds_json(outcomes: &[Outcome]) -> Value {
    let entry =
        |(kind, outcomes): (Kind, Vec<Outcome>)| (kind.name().to_owned(), Summary::new(&outcomes).json());
    Value::Object(by_kind(outcomes).into_iter().map(entry).collect())
}

/// Effects that only things from outside the textbook catalogue are estimated by; see [`super::outside::as_effect`].
const ESTIMATED: [&str; 5] =
    ["friction_warm_up", "friction_temperature", "motor_stribeck", "position_load", "yaw"];

fn parameters(estimates: &[&Estimate]) -> Vec<Parameter> {
    let mut keys: Vec<(&str, &str)> = Vec::new();
    for name in NAMES.into_iter().chain(CONTROLLER).chain(ESTIMATED) {
        for estimate in estimates.iter().filter(|estimate| estimate.effect == name) {
            if !keys.contains(&(name, estimate.parameter)) {
                keys.push((name, estimate.parameter));
            }
        }
    }
    let of = |(effect, parameter)| {
        let same = || estimates.iter().filter(move |e| (e.effect, e.parameter) == (effect, parameter));
        let errors: Vec<f64> = same().map(|estimate| estimate.error()).collect();
        let is_declared = same().all(|estimate| estimate.is_declared());
        let coverage = (!is_declared).then(|| Proportion::of(same().map(|estimate| estimate.is_covered())));
        Parameter { effect, parameter, error: Spread::of(&errors), errors, coverage }
    };
    keys.into_iter().map(of).collect()
}

/// Ratios of both axes.
fn of_channel(outcomes: &[Outcome], channel: &str) -> Spread {
    let all = outcomes.iter().flat_map(|outcome| &outcome.ratios);
    let same = all.filter(|(name, _)| name.split(' ').next_back() == Some(channel));
    Spread::of(&same.map(|(_, ratio)| *ratio).collect::<Vec<_>>())
}

/// A statistic without values is NaN, which JSON cannot represent.
fn finite(figure: f64) -> Option<f64> {
    figure.is_finite().then_some(figure)
}

#[cfg(test)]
mod tests {
    use super::super::score::tests::{found, truth};
    use super::*;

    fn outcomes() -> Vec<Outcome> {
        let backlash = [truth("backlash", "x", &[("width_um", 10.0)])];
        let cyclic = [truth("pitch_cyclic", "y", &[("amplitude_um", 5.0), ("period_mm", 10.0)])];
        let width = |value: f64, half: f64| json!({"width_um": {"value": value, "ci95": [value - half, value + half]}});
        let cyclic_error = json!({"amplitude_um": {"value": 5.5, "ci95": [5.4, 5.6]}, "period_mm": {"value": 10.0, "ci95": [10.0, 10.0]}});
        let of =
            |number, truths: &[_], effects: Value| Outcome::new(number, truths, &json!({"effects": effects}));
        vec![
            of(1, &backlash, json!([found("backlash", "x", &width(10.1, 0.2))])),
            of(2, &backlash, json!([found("backlash", "x", &width(9.7, 0.2))])),
            of(
                3,
                &cyclic,
                json!([found("pitch_cyclic", "y", &cyclic_error), found("intalk", "x", &json!({}))]),
            ),
            of(4, &backlash, json!([])),
            of(5, &[], json!([])),
        ]
    }

    #[test]
    fn counts_add_up() {
        let summary = Summary::new(&outcomes());
        assert_eq!(summary.exact, Proportion { hits: 3, trials: 5 });
        assert_eq!(summary.found, Proportion { hits: 3, trials: 4 });
        assert_eq!(summary.false_finds, 1);
        assert_eq!(summary.clean, Proportion { hits: 1, trials: 1 });
        assert_eq!(summary.outside, Proportion::default());
        // 10.0 lies within 10.1 ± 0.2, neither within 9.7 ± 0.2 nor 5.0 within 5.5 ± 0.1; the period is declared.
        assert_eq!(summary.coverage, Proportion { hits: 1, trials: 3 });
        // Errors 1 %, 3 % and 10 %.
        assert!(
            (summary.error.median - 0.03).abs() < 1e-12 && (summary.error.percentile95 - 0.1).abs() < 1e-12
        );
        let by: Vec<_> =
            summary.parameters.iter().map(|p| (p.parameter, p.error.count, p.coverage)).collect();
        assert_eq!(by[0], ("width_um", 2, Some(Proportion { hits: 1, trials: 2 })));
        assert_eq!(by[2], ("period_mm", 1, None));
    }

    #[test]
    fn a_figure_without_values_is_null() {
        let json = Summary::new(&[]).json();
        assert_eq!(json["exact"]["share"], Value::Null);
        assert_eq!(json["exact"]["interval95"], json!([0.0, 1.0]));
        assert_eq!(json["parameter_error"]["all"]["median"], Value::Null);
    }
}
