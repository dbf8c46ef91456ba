//! All cases of a self-test together.

use numerics::distributions::wilson_interval;
use numerics::quantile;
use serde_json::{Map, Value, json};

use super::confusion::Confusion;
use super::score::{Estimate, Outcome};

/// So many of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Of these.
    pub hits: usize,
    /// Of these.
    pub trials: usize,
}

impl Share {
    fn of(each: impl Iterator<Item = bool>) -> Self {
        each.fold(Self::default(), |sum, hit| Self {
            hits: sum.hits + usize::from(hit),
            trials: sum.trials + 1,
        })
    }

    /// 0 to 1; NaN of none.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.hits as f64 / self.trials as f64
    }

    /// 95 % interval of the probability.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        wilson_interval(self.hits, self.trials)
    }

    fn json(self) -> Value {
        let Self { hits, trials } = self;
        json!({"hits": hits, "of": trials, "share": known(self.share()), "interval95": self.interval()})
    }
}

/// How a figure spreads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// How many.
    pub count: usize,
    /// Half of them are no greater.
    pub median: f64,
    /// 95 % of them are no greater.
    pub most: f64,
}

impl Spread {
    fn of(values: &[f64]) -> Self {
        Self { count: values.len(), median: quantile(values, 0.5), most: quantile(values, 0.95) }
    }

    fn json(self) -> Value {
        json!({"count": self.count, "median": known(self.median), "percentile95": known(self.most)})
    }
}

/// One parameter of one effect over all cases in which the effect was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name of the effect.
    pub effect: &'static str,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Error over truth of each.
    pub errors: Vec<f64>,
    /// Of the errors.
    pub error: Spread,
    /// Share of the truths inside the 95 % confidence intervals; none of what the machine file gives away.
    pub coverage: Option<Share>,
}

/// All figures.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Cases with exactly the right effects.
    pub exact: Share,
    /// Effects of the catalogue that were found.
    pub found: Share,
    /// Effects that were found and were not there.
    pub false_ones: usize,
    /// Effects that were found a second time on an axis, which the score takes for one.
    pub doubled: usize,
    /// Machines as declared in which nothing was found.
    pub clean: Share,
    /// Effects from outside the catalogue of which the trace said what they follow.
    pub outside: Share,
    /// By effect and parameter, in the order of the catalogue.
    pub parameters: Vec<Parameter>,
    /// Errors of all parameters that the machine file does not give away.
    pub error: Spread,
    /// Coverage of all of these.
    pub coverage: Share,
    /// Residual after over noise on the logs that were not fitted, by channel.
    pub ratios: Vec<(&'static str, Spread)>,
    /// What was taken for what.
    pub confusion: Confusion,
}

impl Summary {
    /// Sums up.
    #[must_use]
    pub fn new(outcomes: &[Outcome]) -> Self {
        let missed: usize = outcomes.iter().map(|outcome| outcome.missed().len()).sum();
        let there = outcomes.iter().flat_map(|outcome| &outcome.truths).filter(|t| !t.is_outside()).count();
        let estimates: Vec<&Estimate> = outcomes.iter().flat_map(|outcome| &outcome.estimates).collect();
        let open = || estimates.iter().filter(|estimate| !estimate.is_given());
        let errors: Vec<f64> = open().map(|estimate| estimate.error()).collect();
        let clean = outcomes.iter().filter(|outcome| outcome.is_clean());
        let outside = outcomes.iter().flat_map(|outcome| &outcome.said);
        Self {
            exact: Share::of(outcomes.iter().map(Outcome::is_exact)),
            found: Share { hits: there - missed, trials: there },
            false_ones: outcomes.iter().map(|outcome| outcome.false_ones().len()).sum(),
            doubled: outcomes.iter().map(Outcome::doubled).sum(),
            clean: Share::of(clean.map(Outcome::is_exact)),
            outside: Share::of(outside.copied()),
            parameters: parameters(&estimates),
            error: Spread::of(&errors),
            coverage: Share::of(open().map(|estimate| estimate.is_covered())),
            ratios: ["table", "force", "motor", "tool"]
                .map(|channel| (channel, of_channel(outcomes, channel)))
                .to_vec(),
            confusion: Confusion::new(outcomes),
        }
    }

    /// As it stands in the JSON of the self-test.
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
            "false": self.false_ones,
            "doubled": self.doubled,
            "clean": self.clean.json(),
            "outside": self.outside.json(),
            "parameter_error": {"all": self.error.json(), "by_parameter": parameters},
            "coverage": self.coverage.json(),
            "after_over_noise": ratios,
            "confusion": self.confusion.json(),
        })
    }
}

fn parameters(estimates: &[&Estimate]) -> Vec<Parameter> {
    let mut keys: Vec<(&str, &str)> = Vec::new();
    for name in super::truth::NAMES {
        for estimate in estimates.iter().filter(|estimate| estimate.effect == name) {
            if !keys.contains(&(name, estimate.parameter)) {
                keys.push((name, estimate.parameter));
            }
        }
    }
    let of = |(effect, parameter)| {
        let same = || estimates.iter().filter(move |e| (e.effect, e.parameter) == (effect, parameter));
        let errors: Vec<f64> = same().map(|estimate| estimate.error()).collect();
        let is_given = same().all(|estimate| estimate.is_given());
        let coverage = (!is_given).then(|| Share::of(same().map(|estimate| estimate.is_covered())));
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

/// JSON has no number for a figure that nothing was seen of.
fn known(figure: f64) -> Option<f64> {
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
        let wave = json!({"amplitude_um": {"value": 5.5, "ci95": [5.4, 5.6]}, "period_mm": {"value": 10.0, "ci95": [10.0, 10.0]}});
        let of =
            |number, truths: &[_], effects: Value| Outcome::new(number, truths, &json!({"effects": effects}));
        vec![
            of(1, &backlash, json!([found("backlash", "x", &width(10.1, 0.2))])),
            of(2, &backlash, json!([found("backlash", "x", &width(9.7, 0.2))])),
            of(3, &cyclic, json!([found("pitch_cyclic", "y", &wave), found("intalk", "x", &json!({}))])),
            of(4, &backlash, json!([])),
            of(5, &[], json!([])),
        ]
    }

    #[test]
    fn counts_add_up() {
        let summary = Summary::new(&outcomes());
        assert_eq!(summary.exact, Share { hits: 3, trials: 5 });
        assert_eq!(summary.found, Share { hits: 3, trials: 4 });
        assert_eq!(summary.false_ones, 1);
        assert_eq!(summary.clean, Share { hits: 1, trials: 1 });
        assert_eq!(summary.outside, Share::default());
        // 10.0 lies within 10.1 ± 0.2, neither within 9.7 ± 0.2 nor 5.0 within 5.5 ± 0.1; the period is given.
        assert_eq!(summary.coverage, Share { hits: 1, trials: 3 });
        // Errors 1 %, 3 % and 10 %.
        assert!((summary.error.median - 0.03).abs() < 1e-12 && (summary.error.most - 0.1).abs() < 1e-12);
        let by: Vec<_> =
            summary.parameters.iter().map(|p| (p.parameter, p.error.count, p.coverage)).collect();
        assert_eq!(by[0], ("width_um", 2, Some(Share { hits: 1, trials: 2 })));
        assert_eq!(by[2], ("period_mm", 1, None));
    }

    #[test]
    fn nothing_seen_is_no_number() {
        let json = Summary::new(&[]).json();
        assert_eq!(json["exact"]["share"], Value::Null);
        assert_eq!(json["exact"]["interval95"], json!([0.0, 1.0]));
        assert_eq!(json["parameter_error"]["all"]["median"], Value::Null);
    }
}
