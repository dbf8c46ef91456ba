//! What is known of each error: shown, not told from zero, not determined.

use serde::Serialize;

use super::component::{Component, Kind};
use super::field::Geometry;
use super::fit::Fit;
use super::measurement::Group;
use super::selection::{self, Item, Shown, of_item, shown};

/// Positions of each axis at which the size of an error is looked for.
const POSITIONS: usize = 81;

/// An error that was looked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The name of ISO 230-1, such as `EYX`; of squareness the two axes.
    pub name: String,
    /// In words.
    pub words: String,
    /// Unit of the value: µm, µrad, or µm/m for squareness.
    pub unit: &'static str,
    /// What is known of it.
    #[serde(flatten)]
    pub known: Known,
}

/// What is known of an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "known", rename_all = "snake_case")]
pub enum Known {
    /// It is there, and is in the tables.
    Shown {
        /// Where it is furthest from zero; of squareness its slope.
        greatest: f64,
        /// Half of the 95 % interval there.
        half_width: f64,
        /// Errors that were taken as zero, without which the value is not known.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        if_zero: Vec<String>,
    },
    /// It is not told from zero.
    Small {
        /// The furthest that it may move the tool at any reading, µm.
        at_most_um: f64,
    },
    /// The measurements do not determine it.
    Open {
        /// The measurement that would.
        shown_by: String,
    },
    /// It does not move the tool: no axis is between its carriage and the tool that would be its lever.
    WithoutEffect,
}

/// All errors: shown, small, open.
#[must_use]
pub fn findings(geometry: &Geometry, groups: &[Group], fit: &Fit, simpler: &[Component]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for item in selection::items(&geometry.terms()) {
        let known = match shown(fit, item) {
            Shown::Yes => greatest(geometry, fit, item, simpler),
            Shown::No => Known::Small { at_most_um: selection::bound(fit, geometry, groups, item) },
            Shown::Open => open(geometry, item.component),
        };
        findings.push(named(item, known));
    }
    for component in Component::all() {
        let is_known = findings.iter().any(|finding| finding.name == component.name());
        if !is_known {
            let item = Item { component, is_squareness: false };
            findings.push(named(item, open(geometry, component)));
        }
    }
    let rank = |finding: &Finding| match finding.known {
        Known::Shown { .. } => 0,
        Known::Small { .. } => 1,
        Known::Open { .. } => 2,
        Known::WithoutEffect => 3,
    };
    findings.sort_by_key(rank);
    findings
}

fn open(geometry: &Geometry, component: Component) -> Known {
    component.shown_by(geometry.chain).map_or(Known::WithoutEffect, |shown_by| Known::Open { shown_by })
}

fn named(item: Item, known: Known) -> Finding {
    let component = item.component;
    match component.kind {
        Kind::Along(axis) if item.is_squareness => {
            let [leaning, to] = [component.moved.name(), axis.name()];
            let words = format!("squareness: {leaning} leans towards + of {to}");
            Finding { name: format!("{to}-{leaning}"), words, unit: "µm/m", known }
        }
        _ => Finding { name: component.name(), words: component.words(), unit: component.unit(), known },
    }
}

/// The value of an item where it is furthest from zero; of squareness its slope, µm/m.
fn greatest(geometry: &Geometry, fit: &Fit, item: Item, simpler: &[Component]) -> Known {
    let if_zero = if_zero(item, simpler);
    let own = of_item(&fit.terms, item);
    let [low_mm, high_mm] = geometry.spans_mm.get(&item.component).copied().unwrap_or_default();
    let span_mm = high_mm - low_mm;
    if item.is_squareness {
        // From −1 to 1 over the span: twice the value in its length.
        let (greatest, half_width) = fit.sum(&own, &[2.0 * 1e3 / span_mm]);
        return Known::Shown { greatest, half_width, if_zero };
    }
    let at = |step: usize| {
        let mm = low_mm + span_mm * step as f64 / (POSITIONS - 1) as f64;
        let courses: Vec<f64> = own.iter().map(|term| geometry.value(fit.terms[*term], mm)).collect();
        fit.sum(&own, &courses)
    };
    let furthest = (0..POSITIONS).map(at).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let (greatest, half_width) = furthest.unwrap_or((0.0, 0.0));
    Known::Shown { greatest, half_width, if_zero }
}

/// What was taken as zero of the axes of an item: the other straightness of its plane, and its own courses.
fn if_zero(item: Item, simpler: &[Component]) -> Vec<String> {
    let Component { moved, kind } = item.component;
    let of_item = |component: &&Component| match kind {
        Kind::Along(axis) if item.is_squareness => {
            **component == item.component
                || **component == Component { moved: axis, kind: Kind::Along(moved) }
        }
        _ => **component == item.component,
    };
    let own = simpler.iter().filter(of_item);
    own.map(|component| format!("the finer course of {}", component.name())).collect()
}
