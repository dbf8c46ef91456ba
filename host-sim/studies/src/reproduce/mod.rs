//! The published experiments that the project started from, run again: the paper's figure beside ours.
//!
//! One file a paper. Each gives [`Study`]: what came out in sentences, every figure with its verdict, and pictures.
//! What the papers print illegibly or wrongly stands in the study's notes, with what was read instead and why;
//! `docs/reproduce.md` has all of it on one page.

pub mod acceleration;
pub mod ballbar;
pub mod corner;
pub mod dual_feedback;
pub mod page;
pub mod stick_slip;

use rayon::prelude::*;
use serde::Serialize;
use serde::ser::SerializeStruct;

use plant::simulate::SimulationError;

/// What a paper printed, and what counts as agreeing with it.
#[derive(Clone, Debug, PartialEq)]
pub enum Printed {
    /// A figure; ours agrees within ± the tolerance.
    Figure {
        /// As printed.
        value: f64,
        /// Half of the last printed digit, or what the paper's own scatter leaves open.
        tolerance: f64,
    },
    /// "2 to 3"; ours agrees between the two.
    Between(f64, f64),
    /// A finding without a figure: ours agrees below this.
    Below(f64),
    /// A finding without a figure: ours agrees above this.
    Above(f64),
}

impl Printed {
    /// Whether ours agrees.
    #[must_use]
    pub fn agrees(&self, ours: f64) -> bool {
        match *self {
            Self::Figure { value, tolerance } => (ours - value).abs() <= tolerance,
            Self::Between(least, most) => (least..=most).contains(&ours),
            Self::Below(most) => ours < most,
            Self::Above(least) => ours > least,
        }
    }

    /// In a few characters.
    #[must_use]
    pub fn words(&self) -> String {
        match self {
            Self::Figure { value, .. } => value.to_string().replace('-', "−"),
            Self::Between(least, most) => format!("{least} to {most}"),
            Self::Below(most) => format!("< {most}"),
            Self::Above(least) => format!("> {least}"),
        }
    }
}

/// A figure as a number, anything else in words.
impl Serialize for Printed {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Figure { value, .. } => to.serialize_f64(*value),
            other => to.serialize_str(&other.words()),
        }
    }
}

/// One quantity of a paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// What it is, in a few words.
    pub quantity: String,
    /// In the paper.
    pub printed: Printed,
    /// Here.
    pub ours: f64,
    /// Of both; empty where there is none.
    pub unit: &'static str,
}

impl Outcome {
    /// A quantity with what was printed and what came out.
    #[must_use]
    pub fn new(quantity: impl Into<String>, printed: Printed, ours: f64, unit: &'static str) -> Self {
        Self { quantity: quantity.into(), printed, ours, unit }
    }

    /// Whether ours agrees with the printed one.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.printed.agrees(self.ours)
    }
}

/// A picture of the report: a drawing as markup, and its caption in plain text.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Heading.
    pub title: String,
    /// Inline SVG.
    pub svg: String,
    /// What it shows.
    pub caption: String,
    /// What the line styles stand for: class of the stylesheet, with ` mark` behind it for points, and meaning.
    pub keys: Vec<(&'static str, String)>,
}

/// What came out for one paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Author and year.
    pub paper: &'static str,
    /// What the paper is about.
    pub title: &'static str,
    /// In sentences.
    pub said: Vec<String>,
    /// In figures.
    pub outcomes: Vec<Outcome>,
    /// In pictures.
    pub pictures: Vec<Picture>,
    /// What the print leaves open, what was read, and why.
    pub notes: Vec<String>,
}

/// All papers.
#[derive(Clone, Debug, PartialEq)]
pub struct Reproduction {
    /// In the order of their year.
    pub studies: Vec<Study>,
}

/// As the contract has it.
impl Serialize for Reproduction {
    fn serialize<S: serde::Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Row<'a> {
            paper: &'a str,
            quantity: &'a str,
            printed: &'a Printed,
            ours: f64,
            unit: &'a str,
            agrees: bool,
        }
        let rows = self.studies.iter().flat_map(|study| {
            study.outcomes.iter().map(|outcome| Row {
                paper: study.paper,
                quantity: &outcome.quantity,
                printed: &outcome.printed,
                ours: outcome.ours,
                unit: outcome.unit,
                agrees: outcome.agrees(),
            })
        });
        let mut whole = to.serialize_struct("Reproduction", 1)?;
        whole.serialize_field("results", &rows.collect::<Vec<_>>())?;
        whole.end()
    }
}

/// Why an experiment could not be run.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// A loop did not hold.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A fit did not come to an end, or an integration failed.
    #[error("{0}")]
    Numerics(String),
}

/// Runs all papers, side by side; `say` is told which one has begun.
///
/// # Errors
/// When an experiment cannot be run.
pub fn run(say: &(dyn Fn(&str) + Sync)) -> Result<Reproduction, ReproduceError> {
    type Run = fn() -> Result<Study, ReproduceError>;
    let papers: [(&str, Run); 4] = [
        ("dual feedback", dual_feedback::run),
        ("errors at the corner", corner::run),
        ("stick-slip", stick_slip::run),
        ("acceleration", acceleration::run),
    ];
    let studies = papers
        .into_par_iter()
        .map(|(name, run)| {
            say(name);
            run()
        })
        .collect::<Result<_, _>>()?;
    Ok(Reproduction { studies })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agreement_has_two_sides() {
        let printed = Printed::Figure { value: 2.0, tolerance: 0.25 };
        assert!(
            printed.agrees(1.75) && printed.agrees(2.25) && !printed.agrees(1.74) && !printed.agrees(2.26)
        );
        assert!(Printed::Between(2.0, 3.0).agrees(2.5) && !Printed::Between(2.0, 3.0).agrees(3.1));
        assert!(Printed::Below(1.0).agrees(0.9) && !Printed::Below(1.0).agrees(1.0));
        assert!(Printed::Above(1.0).agrees(1.1) && !Printed::Above(1.0).agrees(f64::NAN));
    }

    #[test]
    fn the_json_is_that_of_the_contract() {
        let figure = Printed::Figure { value: 1.5, tolerance: 0.1 };
        let outcomes = vec![
            Outcome::new("a", figure, 1.55, "µm"),
            Outcome::new("b", Printed::Between(2.0, 3.0), 4.0, ""),
        ];
        let study = Study { paper: "P", title: "", said: vec![], outcomes, pictures: vec![], notes: vec![] };
        let json = serde_json::to_string(&Reproduction { studies: vec![study] }).unwrap();
        let row = |rest: &str| format!("{{\"paper\":\"P\",{rest}}}");
        let a = row("\"quantity\":\"a\",\"printed\":1.5,\"ours\":1.55,\"unit\":\"µm\",\"agrees\":true");
        let b = row("\"quantity\":\"b\",\"printed\":\"2 to 3\",\"ours\":4.0,\"unit\":\"\",\"agrees\":false");
        assert_eq!(json, format!("{{\"results\":[{a},{b}]}}"));
    }
}
