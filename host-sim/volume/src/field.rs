//! The error at the tool that the components make: rigid bodies, to first order in the errors.
//!
//! A carriage that is displaced by E and turned by θ moves the tool against the workpiece by E + θ × L, where L is the way along the
//! axes between this carriage and the tool, from a place
//! that is that of the first measurement in the direction of the error. Which of the axes carry the tool and which the workpiece does not
//! matter; their order does.

use std::collections::BTreeMap;

use super::component::{Axis, Component, Course, Kind, Range, carried, hat, legendre};
use super::measurement::Row;
use super::vector::{cross, dot, unit};

/// Smallest part of an error along an axis, or lever of one about an axis, mm, that a reading counts as showing.
const LEAST_SEEN: f64 = 0.1;

/// Order of the axes, and where they were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The axes from the workpiece to the tool.
    pub chain: [Axis; 3],
    /// Of x, y and z.
    pub ranges: [Range; 3],
    /// Lowest and highest position, mm, at which a reading can show a component.
    pub spans_mm: BTreeMap<Component, [f64; 2]>,
}

/// A course of a component: one unknown, µm or µrad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term {
    /// The component.
    pub component: Component,
    /// Its course.
    pub course: Course,
}

impl Geometry {
    /// The geometry of an order of the axes and of the measurements that are to be fitted, each with its rows.
    #[must_use]
    pub fn new(chain: [Axis; 3], ranges: [Range; 3], measurements: &[&[Row]]) -> Self {
        let mut geometry = Self { chain, ranges, spans_mm: BTreeMap::new() };
        for component in Component::all() {
            let seen = measurements.iter().flat_map(|rows| geometry.seen_mm(component, rows));
            let seen_mm: Vec<f64> = seen.collect();
            let [low_mm, high_mm] =
                [numerics::min(seen_mm.iter().copied()), numerics::max(seen_mm.iter().copied())];
            if high_mm > low_mm {
                geometry.spans_mm.insert(component, [low_mm, high_mm]);
            }
        }
        geometry
    }

    /// The positions of its axis, mm, at which a measurement shows a component. Where it does the same to all readings, it is in the origin
    /// of the instrument.
    fn seen_mm(&self, component: Component, rows: &[Row]) -> Vec<f64> {
        let moved = component.moved as usize;
        let effects = rows.iter().map(|row| {
            let per_unit = match component.kind {
                Kind::Along(axis) => unit(axis),
                // A lever of 1 mm counts as an error of 1.
                Kind::About(axis) => {
                    self.turned_um(component.moved, unit(axis), row.at_mm).map(|um| 1e3 * um)
                }
            };
            (row.at_mm[moved], dot(row.direction, per_unit))
        });
        let effects: Vec<(f64, f64)> = effects.collect();
        let differs =
            |of: fn(&(f64, f64)) -> f64| numerics::peak_to_peak(effects.iter().map(of)) > LEAST_SEEN;
        let is_part = match component.kind {
            Kind::Along(_) => differs(|(at_mm, _)| *at_mm),
            Kind::About(_) => differs(|(at_mm, _)| *at_mm) || differs(|(_, effect)| *effect),
        };
        let shown = effects.into_iter().filter(|(_, effect)| is_part && effect.abs() > LEAST_SEEN);
        shown.map(|(at_mm, _)| at_mm).collect()
    }

    /// The value of a course of a component at a position of its axis; 0 if no reading shows the component.
    #[must_use]
    pub fn value(&self, term: Term, at_mm: f64) -> f64 {
        let component = term.component;
        match (term.course, self.spans_mm.get(&component)) {
            (Course::Knot(index), _) => hat(&self.ranges[component.moved as usize].knots_mm, index, at_mm),
            (Course::Legendre(degree), Some(span_mm)) => {
                let value = |mm: f64| legendre(degree, component.has_squareness(), *span_mm, mm);
                let zero_mm = match component.kind {
                    Kind::Along(_) => None,
                    Kind::About(axis) => self.ranges[component.moved as usize].unturned_mm[axis as usize],
                };
                value(at_mm) - zero_mm.map_or(0.0, value)
            }
            (Course::EitherCubic, Some(span_mm)) => legendre(3, false, *span_mm, at_mm),
            (_, None) => 0.0,
        }
    }

    /// All terms of a machine.
    #[must_use]
    pub fn terms(&self) -> Vec<Term> {
        let of = |component: Component| {
            let courses = self.ranges[component.moved as usize].courses(component);
            courses.into_iter().map(move |course| Term { component, course })
        };
        let moves_tool = |component: &Component| match component.kind {
            Kind::Along(_) => true,
            Kind::About(about) => carried(self.chain, component.moved)
                .iter()
                .any(|axis| *axis != about && self.ranges[*axis as usize].is_moved()),
        };
        Component::all().into_iter().filter(moves_tool).flat_map(of).collect()
    }

    /// What a rotation of a carriage, µrad, moves the tool by at a position, µm.
    fn turned_um(&self, moved: Axis, about_urad: [f64; 3], at_mm: [f64; 3]) -> [f64; 3] {
        let from_mm = &self.ranges[moved as usize].lever_from_mm;
        turned_um(&carried(self.chain, moved), about_urad, from_mm, at_mm)
    }

    /// The error at the tool, µm, that one unit of a term makes at a position.
    #[must_use]
    pub fn effect_um(&self, term: Term, at_mm: [f64; 3]) -> [f64; 3] {
        let moved = term.component.moved;
        let value = self.value(term, at_mm[moved as usize]);
        match term.component.kind {
            Kind::Along(axis) if term.course == Course::EitherCubic => {
                let other = Component { moved: axis, kind: Kind::Along(moved) };
                let value_of_other = self.value(Term { component: other, ..term }, at_mm[axis as usize]);
                let (along, across) = (unit(axis), unit(moved));
                [0, 1, 2].map(|part| along[part] * value - across[part] * value_of_other)
            }
            Kind::Along(axis) => unit(axis).map(|part| part * value),
            Kind::About(axis) => self.turned_um(moved, unit(axis).map(|part| part * value), at_mm),
        }
    }
}

/// What a rotation of a carriage, µrad, moves the tool by at a position, µm: for each direction the vector product with the way from a place
/// of its own along the axes between the carriage and the tool.
#[must_use]
pub fn turned_um(
    carried: &[Axis],
    about_urad: [f64; 3],
    from_mm: &[[f64; 3]; 3],
    at_mm: [f64; 3],
) -> [f64; 3] {
    [0, 1, 2].map(|direction| {
        let mut lever_mm = [0.0; 3];
        for axis in carried.iter().map(|axis| *axis as usize) {
            lever_mm[axis] = at_mm[axis] - from_mm[direction][axis];
        }
        // µrad · mm = 10⁻³ µm.
        1e-3 * cross(about_urad, lever_mm)[direction]
    })
}
