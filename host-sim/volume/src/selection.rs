//! Which components the readings show.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::component::{Axis, Component, Course, Kind};
use super::field::{Geometry, Term};
use super::fit::Fit;
use super::measurement::{self, Group, Row};
use super::vector::dot;

/// Probability of chance below which a component is shown: 3.5 standard deviations.
const CHANCE: f64 = 4.7e-4;

/// Smallest part of what a term does somewhere in the volume that a reading must show.
const LEAST_SEEN: f64 = 0.03;

/// What is told as one error: a component, or the squareness that is the slope of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Item {
    /// The component.
    pub component: Component,
    /// Whether it is the slope alone.
    pub is_squareness: bool,
}

impl Item {
    /// The item of a term; `None` if it is part of no result.
    #[must_use]
    pub fn of(term: Term) -> Option<Self> {
        let is_squareness = term.component.has_squareness() && term.course == Course::Legendre(1);
        (term.course != Course::EitherCubic).then_some(Self { component: term.component, is_squareness })
    }
}

/// What a fit says of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// It is there.
    Yes,
    /// It is determined, and not told from zero.
    No,
    /// The measurements do not determine it.
    Open,
}

/// The items of terms, each once.
#[must_use]
pub fn items(terms: &[Term]) -> Vec<Item> {
    let mut items: Vec<Item> = terms.iter().filter_map(|term| Item::of(*term)).collect();
    items.sort();
    items.dedup();
    items
}

/// The indices of the terms of an item.
#[must_use]
pub fn of_item(terms: &[Term], item: Item) -> Vec<usize> {
    (0..terms.len()).filter(|index| Item::of(terms[*index]) == Some(item)).collect()
}

/// What a fit says of an item.
#[must_use]
pub fn shown(fit: &Fit, item: Item) -> Shown {
    let own = of_item(&fit.terms, item);
    if own.is_empty() || own.iter().any(|term| !fit.is_determined[*term]) {
        Shown::Open
    } else if chance(fit, &own) < CHANCE {
        Shown::Yes
    } else {
        Shown::No
    }
}

/// What the readings show.
#[derive(Clone, Debug)]
pub struct Selected {
    /// The fit of what is kept.
    pub fit: Fit,
    /// Components of which a course of the highest degree was left out because the readings do not determine it, each once.
    pub simpler: Vec<Component>,
}

/// Fits all terms. What is not told from zero stays in the fit: left out, it would take its uncertainty out of the intervals of the others.
///
/// A course of the highest degree that is not determined is left out: circles about one centre cannot tell the cubic bends of two
/// axes from their squareness (sin θ · cos³ θ + cos θ · sin³ θ = sin θ · cos θ), and a guideway that is smooth has little of it. Their
/// difference is fitted, and told of neither.
#[must_use]
pub fn fitted(geometry: &Geometry, groups: &[Group]) -> Selected {
    let rows: Vec<Row> = measurement::fitted(groups).flat_map(|group| &group.rows).copied().collect();
    let mut seen = geometry.terms();
    seen.retain(|term| is_seen(geometry, *term, &rows));
    let mut fit = Fit::of(geometry, seen, groups);
    let mut simpler = Vec::new();
    let stages = [(false, 3), (true, 3), (true, 2)];
    for (is_of_rotations, degree) in stages {
        let is_highest = |term: Term| {
            term.component.is_rotation() == is_of_rotations && term.course == Course::Legendre(degree)
        };
        let planes = open_planes(&fit);
        let is_open = |index: &usize| {
            let term = fit.terms[*index];
            is_highest(term) && (!fit.is_determined[*index] || planes.iter().any(|plane| is_in(term, *plane)))
        };
        let open: Vec<usize> = (0..fit.terms.len()).filter(is_open).collect();
        if open.is_empty() {
            continue;
        }
        simpler.extend(open.iter().map(|index| fit.terms[*index].component));
        let of = |index: usize| {
            let term = fit.terms[index];
            let is_other = planes
                .iter()
                .any(|plane| is_straightness_in(term, *plane) && term.component.moved == plane[0]);
            match open.contains(&index) {
                false => Some(term),
                true if is_other => Some(Term { course: Course::EitherCubic, ..term }),
                true => None,
            }
        };
        fit = Fit::of(geometry, (0..fit.terms.len()).filter_map(of).collect(), groups);
    }
    simpler.sort();
    simpler.dedup();
    Selected { fit, simpler }
}

/// Whether any reading shows more than a trace of what a term does somewhere in the measured volume: an unknown of which only a trace is seen
/// could be of any size.
fn is_seen(geometry: &Geometry, term: Term, rows: &[Row]) -> bool {
    let along = |row: &Row| dot(row.direction, geometry.effect_um(term, row.at_mm)).abs();
    let corners = (0..8).map(|corner| {
        [0, 1, 2].map(|axis| {
            let range = &geometry.ranges[axis];
            if corner >> axis & 1 == 0 { range.low_mm } else { range.high_mm }
        })
    });
    let anywhere = corners.map(|at_mm| numerics::max_abs(geometry.effect_um(term, at_mm)));
    numerics::max(rows.iter().map(along)) > LEAST_SEEN * numerics::max(anywhere)
}

/// The planes whose squareness is not determined.
fn open_planes(fit: &Fit) -> Vec<[Axis; 2]> {
    let open = fit.terms.iter().zip(&fit.is_determined).filter(|(term, is_determined)| {
        !**is_determined && Item::of(**term).is_some_and(|item| item.is_squareness)
    });
    open.filter_map(|(term, _)| match term.component.kind {
        Kind::Along(axis) => Some([axis, term.component.moved]),
        Kind::About(_) => None,
    })
    .collect()
}

/// Whether a term is the straightness of one axis of a plane in the other.
fn is_straightness_in(term: Term, [first, second]: [Axis; 2]) -> bool {
    let (moved, kind) = (term.component.moved, term.component.kind);
    moved == first && kind == Kind::Along(second) || moved == second && kind == Kind::Along(first)
}

/// Whether a term is the straightness of one axis of a plane in the other, or a rotation of one of them.
fn is_in(term: Term, plane: [Axis; 2]) -> bool {
    is_straightness_in(term, plane) || term.component.is_rotation() && plane.contains(&term.component.moved)
}

/// Probability of such values by chance, if the item were zero.
fn chance(fit: &Fit, terms: &[usize]) -> f64 {
    let values = DVector::from_fn(terms.len(), |index, _| fit.values[terms[index]]);
    let covariance = DMatrix::from_fn(terms.len(), terms.len(), |a, b| fit.covariance[(terms[a], terms[b])]);
    let Some(inverse) = covariance.try_inverse() else { return 1.0 };
    let square = (values.transpose() * inverse * &values)[(0, 0)];
    ChiSquared::new(terms.len() as f64).map_or(1.0, |law| law.sf(square.max(0.0)))
}

/// The furthest that an item may move the tool at any reading, µm: its value and half of its 95 % interval.
#[must_use]
pub fn bound(fit: &Fit, geometry: &Geometry, groups: &[Group], item: Item) -> f64 {
    let own = of_item(&fit.terms, item);
    let rows = measurement::fitted(groups).flat_map(|group| &group.rows);
    numerics::max(rows.map(|row| {
        let effects: Vec<[f64; 3]> =
            own.iter().map(|term| geometry.effect_um(fit.terms[*term], row.at_mm)).collect();
        let along = |axis: usize| {
            let part: Vec<f64> = effects.iter().map(|effect| effect[axis]).collect();
            let (value, half_width) = fit.sum(&own, &part);
            value.abs() + half_width
        };
        numerics::max([0, 1, 2].map(along))
    }))
}
