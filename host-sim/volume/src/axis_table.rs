//! The errors that are shown, as polylines over the position of each axis: what a control computes with.

use serde::Serialize;

use super::component::{Axis, Kind, carried};
use super::field::{Geometry, turned_um};
use super::fit::Fit;

/// Nodes of an axis besides its knots.
const NODES: usize = 33;

/// The six errors of an axis at its nodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AxisTable {
    /// Positions of the axis, mm, ascending; two at least.
    pub position_mm: Vec<f64>,
    /// Errors along x, y and z at each, µm.
    pub along_um: Vec<[f64; 3]>,
    /// Errors about x, y and z at each, µrad.
    pub about_urad: Vec<[f64; 3]>,
}

impl AxisTable {
    /// The errors along and about x, y and z at a position, straight between the nodes and constant beyond them.
    #[must_use]
    pub fn at(&self, at_mm: f64) -> ([f64; 3], [f64; 3]) {
        let last = self.position_mm.len() - 1;
        let after = self.position_mm.partition_point(|mm| *mm <= at_mm).clamp(1, last);
        let [from, to] = [self.position_mm[after - 1], self.position_mm[after]];
        let part = ((at_mm - from) / (to - from)).clamp(0.0, 1.0);
        let between = |values: &[[f64; 3]]| {
            [0, 1, 2].map(|axis| values[after - 1][axis] * (1.0 - part) + values[after][axis] * part)
        };
        (between(&self.along_um), between(&self.about_urad))
    }
}

/// The tables of x, y and z of some of the terms of a fit.
#[must_use]
pub fn of(geometry: &Geometry, fit: &Fit, kept: &[usize]) -> [AxisTable; 3] {
    Axis::ALL.map(|axis| {
        let mut table =
            AxisTable { position_mm: nodes_mm(geometry, axis), along_um: vec![], about_urad: vec![] };
        for at_mm in &table.position_mm {
            let (mut along_um, mut about_urad) = ([0.0; 3], [0.0; 3]);
            for index in kept.iter().filter(|index| fit.terms[**index].component.moved == axis) {
                let term = fit.terms[*index];
                let value = fit.values[*index] * geometry.value(term, *at_mm);
                match term.component.kind {
                    Kind::Along(direction) => along_um[direction as usize] += value,
                    Kind::About(direction) => about_urad[direction as usize] += value,
                }
            }
            table.along_um.push(along_um);
            table.about_urad.push(about_urad);
        }
        table
    })
}

/// Knots, and positions between which the polynomials are nearly straight. An axis that did not move has two nodes.
fn nodes_mm(geometry: &Geometry, axis: Axis) -> Vec<f64> {
    let range = &geometry.ranges[axis as usize];
    if !range.is_moved() {
        return vec![range.low_mm, range.low_mm + 1.0];
    }
    let span_mm = range.high_mm - range.low_mm;
    let even = (0..NODES).map(|node| range.low_mm + span_mm * node as f64 / (NODES - 1) as f64);
    // Where a polynomial ends, the course has a corner.
    let own = geometry.spans_mm.iter().filter(|(component, _)| component.moved == axis);
    let ends = own.flat_map(|(_, span_mm)| *span_mm);
    let mut nodes_mm: Vec<f64> = even.chain(range.knots_mm.iter().copied()).chain(ends).collect();
    nodes_mm.sort_by(f64::total_cmp);
    nodes_mm.dedup_by(|a, b| (*a - *b).abs() < 1e-6 * span_mm);
    nodes_mm
}

/// The error of the tool, µm, at a position: see [`super::field`].
#[must_use]
pub fn error_um(
    tables: &[AxisTable; 3],
    chain: [Axis; 3],
    lever_from_mm: &[[[f64; 3]; 3]; 3],
    at_mm: [f64; 3],
) -> [f64; 3] {
    let mut error_um = [0.0; 3];
    for axis in Axis::ALL {
        let (along_um, about_urad) = tables[axis as usize].at(at_mm[axis as usize]);
        let turned_um = turned_um(&carried(chain, axis), about_urad, &lever_from_mm[axis as usize], at_mm);
        for direction in 0..3 {
            error_um[direction] += along_um[direction] + turned_um[direction];
        }
    }
    error_um
}
