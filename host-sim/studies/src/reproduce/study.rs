//! The result of repeating a paper: its printed values, ours, and what counts as agreement.

use serde::Serialize;
use serde::ser::SerializeStruct;

use model::bodies::StructureError;
use plant::simulate::SimulationError;

/// What a paper printed, and what counts as agreeing with it.
#[derive(Clone, Debug, PartialEq)]
pub enum Printed {
    /// A value; ours agrees within ± the tolerance.
    Figure {
        /// As printed.
        value: f64,
        /// Half of the last printed digit, or the uncertainty that the paper states.
        tolerance: f64,
    },
    /// A range, such as "2 to 3"; ours agrees between the two ends, both included.
    Between(f64, f64),
    /// A finding without a value; ours agrees below this bound.
    Below(f64),
    /// A finding without a value; ours agrees above this bound.
    Above(f64),
}

impl Printed {
    /// A value with a tolerance of half of its last digit; `digit` is one unit in that digit.
    #[must_use]
    pub fn to_digit(value: f64, digit: f64) -> Self {
        Self::Figure { value, tolerance: 0.5 * digit }
    }

    /// Whether our value agrees. NaN never does.
    #[must_use]
    pub fn agrees(&self, ours: f64) -> bool {
        match *self {
            Self::Figure { value, tolerance } => (ours - value).abs() <= tolerance,
            Self::Between(min, max) => (min..=max).contains(&ours),
            Self::Below(bound) => ours < bound,
            Self::Above(bound) => ours > bound,
        }
    }

    /// The table cell: `-1.5` as `−1.5`, `2 to 3`, `< 5`, `> 1`.
    #[must_use]
    pub fn label(&self) -> String {
        match self {
            Self::Figure { value, .. } => value.to_string().replace('-', "−"),
            Self::Between(min, max) => format!("{min} to {max}"),
            Self::Below(bound) => format!("< {bound}"),
            Self::Above(bound) => format!("> {bound}"),
        }
    }
}

/// A value as a number; ranges and bounds as [`Printed::label`].
impl Serialize for Printed {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Figure { value, .. } => serializer.serialize_f64(*value),
            other => serializer.serialize_str(&other.label()),
        }
    }
}

/// One quantity of a paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Name of the quantity.
    pub quantity: String,
    /// The paper's value.
    pub printed: Printed,
    /// Our value.
    pub ours: f64,
    /// Unit of both; empty for ratios and counts.
    pub unit: &'static str,
}

impl Outcome {
    /// A quantity with the printed value and ours.
    #[must_use]
    pub fn new(quantity: impl Into<String>, printed: Printed, ours: f64, unit: &'static str) -> Self {
        Self { quantity: quantity.into(), printed, ours, unit }
    }

    /// Whether our value agrees with the printed one.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.printed.agrees(self.ours)
    }
}

/// A picture of the report page.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Heading.
    pub title: String,
    /// Inline SVG.
    pub svg: String,
    /// Caption, plain text.
    pub caption: String,
    /// Legend: class of the stylesheet (with the suffix ` mark` for point markers), and meaning.
    pub legend: Vec<(&'static str, String)>,
}

/// The result for one paper.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Author and year.
    pub paper: &'static str,
    /// Subject of the paper.
    pub title: &'static str,
    /// Findings, one sentence or paragraph each.
    pub findings: Vec<String>,
    /// Every compared quantity.
    pub outcomes: Vec<Outcome>,
    /// Pictures.
    pub pictures: Vec<Picture>,
    /// Readings that were used where the printed text is unclear or wrong, with the reason.
    pub notes: Vec<String>,
}

/// The results for all papers.
#[derive(Clone, Debug, PartialEq)]
pub struct Reproduction {
    /// One per paper, by year of publication.
    pub studies: Vec<Study>,
}

/// The JSON of `reproduce --json`: `{"results": [...]}`, one row per [`Outcome`].
impl Serialize for Reproduction {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
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
        let mut object = serializer.serialize_struct("Reproduction", 1)?;
        object.serialize_field("results", &rows.collect::<Vec<_>>())?;
        object.end()
    }
}

/// Errors of an experiment.
#[derive(Debug, thiserror::Error)]
pub enum ReproduceError {
    /// The simulated machine did not complete the motion.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A fit did not converge, an integration failed, or a machine file could not be read.
    #[error("{0}")]
    Numerics(String),
}

impl From<StructureError> for ReproduceError {
    fn from(error: StructureError) -> Self {
        Self::Numerics(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_agrees_within_its_tolerance_or_bound() {
        let printed = Printed::Figure { value: 2.0, tolerance: 0.25 };
        assert!(
            printed.agrees(1.75) && printed.agrees(2.25) && !printed.agrees(1.74) && !printed.agrees(2.26)
        );
        assert!(Printed::Between(2.0, 3.0).agrees(2.5) && !Printed::Between(2.0, 3.0).agrees(3.1));
        assert!(Printed::Below(1.0).agrees(0.9) && !Printed::Below(1.0).agrees(1.0));
        assert!(Printed::Above(1.0).agrees(1.1) && !Printed::Above(1.0).agrees(f64::NAN));
    }

    #[test]
    fn the_json_has_the_documented_keys() {
        let figure = Printed::Figure { value: 1.5, tolerance: 0.1 };
        let outcomes = vec![
            Outcome::new("a", figure, 1.55, "µm"),
            Outcome::new("b", Printed::Between(2.0, 3.0), 4.0, ""),
        ];
        let study =
            Study { paper: "P", title: "", findings: vec![], outcomes, pictures: vec![], notes: vec![] };
        let json = serde_json::to_string(&Reproduction { studies: vec![study] }).unwrap();
        let row = |fields: &str| format!("{{\"paper\":\"P\",{fields}}}");
        let a = row("\"quantity\":\"a\",\"printed\":1.5,\"ours\":1.55,\"unit\":\"µm\",\"agrees\":true");
        let b = row("\"quantity\":\"b\",\"printed\":\"2 to 3\",\"ours\":4.0,\"unit\":\"\",\"agrees\":false");
        assert_eq!(json, format!("{{\"results\":[{a},{b}]}}"));
    }
}
