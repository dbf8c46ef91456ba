//! The forms that the deviation may have over position, direction and time, from none to one value at each target.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use model::position_curve::PositionCurve;

use super::course::Course;

/// Mean of both directions over position.
#[derive(Clone, Debug, PartialEq)]
pub enum Mean {
    /// Alike everywhere.
    Offset,
    /// A straight line.
    Line,
    /// A straight line and waves of these periods, mm.
    Waves(Vec<f64>),
    /// A value at each knot.
    Map,
}

/// Difference of the directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gap {
    /// None.
    None,
    /// Alike everywhere.
    Constant,
    /// A value at each knot.
    Map,
}

/// Change over the clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Drift {
    /// None.
    None,
    /// Alike everywhere.
    Offset,
    /// A straight line over position.
    Line,
    /// A value at each knot, held to a straight line as far as the readings do not tell it.
    Map,
}

/// A form of the deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// Mean of both directions over position.
    pub mean: Mean,
    /// Difference of the directions.
    pub gap: Gap,
    /// Change over the clock.
    pub drift: Drift,
}

/// A place where the deviation is known or asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Position, mm.
    pub position_mm: f64,
    /// +1 or −1: direction of the approach.
    pub sign: f64,
    /// Instant on the clock.
    pub instant: f64,
}

/// Where the curves have their knots, and the course of the drift.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Positions of the knots, mm, increasing.
    pub knots_mm: Vec<f64>,
    /// Course of the drift.
    pub course: Course,
    /// Mean of the course over the fitted readings, which is taken off: the other columns are those at this mean.
    pub mean_course: f64,
    cardinals: Vec<PositionCurve>,
}

/// The columns of a form: ranges of its parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Of the mean.
    pub mean: std::ops::Range<usize>,
    /// Of the gap.
    pub gap: std::ops::Range<usize>,
    /// Of the drift.
    pub drift: std::ops::Range<usize>,
}

impl Grid {
    /// A grid with knots at these positions.
    #[must_use]
    pub fn new(knots_mm: Vec<f64>, course: Course, mean_course: f64) -> Self {
        let cardinal = |index: usize| {
            let values: Vec<f64> = (0..knots_mm.len()).map(|i| f64::from(u8::from(i == index))).collect();
            PositionCurve::new(&knots_mm, &values)
        };
        let cardinals = (0..knots_mm.len()).map(cardinal).collect();
        Self { knots_mm, course, mean_course, cardinals }
    }

    /// Middle of the knots, mm: their mean.
    #[must_use]
    pub fn middle_mm(&self) -> f64 {
        numerics::mean(self.knots_mm.iter().copied())
    }

    /// Distance of a position from the middle, m.
    fn along_m(&self, position_mm: f64) -> f64 {
        1e-3 * (position_mm - self.middle_mm())
    }

    /// Weights of the knots' values at a position.
    fn weights(&self, position_mm: f64) -> Vec<f64> {
        let knots = &self.knots_mm;
        let nearest = knots.partition_point(|knot| *knot < position_mm);
        // Most readings are at a knot, of which the value alone counts.
        if knots.get(nearest).is_some_and(|knot| knot.to_bits() == position_mm.to_bits()) {
            return (0..knots.len()).map(|index| f64::from(u8::from(index == nearest))).collect();
        }
        self.cardinals.iter().map(|cardinal| cardinal.value(position_mm)).collect()
    }

    /// Value 1 and distance from the middle (m) at each knot: the straight lines.
    #[must_use]
    pub fn lines(&self) -> DMatrix<f64> {
        let knots = self.knots_mm.len();
        DMatrix::from_fn(knots, 2, |i, j| if j == 0 { 1.0 } else { self.along_m(self.knots_mm[i]) })
    }

    /// What is left of values at the knots without their straight line by least squares.
    #[must_use]
    pub fn without_line(&self) -> DMatrix<f64> {
        let knots = self.knots_mm.len();
        let lines = self.lines();
        let normal = lines.transpose() * &lines;
        let unit = DMatrix::identity(knots, knots);
        normal
            .try_inverse()
            .map_or_else(|| unit.clone(), |inverse| &unit - &lines * inverse * lines.transpose())
    }

    /// Factor of the drift at an instant.
    #[must_use]
    pub fn drift_factor(&self, instant: f64) -> f64 {
        self.course.at(instant) - self.mean_course
    }
}

impl Variant {
    /// The least: an offset.
    #[must_use]
    pub const fn offset() -> Self {
        Self { mean: Mean::Offset, gap: Gap::None, drift: Drift::None }
    }

    /// The columns of each part.
    #[must_use]
    pub fn columns(&self, grid: &Grid) -> Columns {
        let knots = grid.knots_mm.len();
        let mean = match &self.mean {
            Mean::Offset => 1,
            Mean::Line => 2,
            Mean::Waves(periods) => 2 + 2 * periods.len(),
            Mean::Map => knots,
        };
        let gap = match self.gap {
            Gap::None => 0,
            Gap::Constant => 1,
            Gap::Map => knots,
        };
        let drift = match self.drift {
            Drift::None => 0,
            Drift::Offset => 1,
            Drift::Line => 2,
            Drift::Map => knots,
        };
        Columns { mean: 0..mean, gap: mean..mean + gap, drift: mean + gap..mean + gap + drift }
    }

    /// The row of the design at a place.
    #[must_use]
    pub fn row(&self, grid: &Grid, place: &Place) -> DVector<f64> {
        let x = place.position_mm;
        let mut row: Vec<f64> = Vec::new();
        match &self.mean {
            Mean::Offset => row.push(1.0),
            Mean::Line => row.extend([1.0, grid.along_m(x)]),
            Mean::Waves(periods) => {
                row.extend([1.0, grid.along_m(x)]);
                row.extend(periods.iter().flat_map(|period_mm| {
                    let angle = TAU * x / period_mm;
                    [libm::sin(angle), libm::cos(angle)]
                }));
            }
            Mean::Map => row.extend(grid.weights(x)),
        }
        // With a gap, the axis stays behind by half of it.
        let half = -0.5 * place.sign;
        match self.gap {
            Gap::None => {}
            Gap::Constant => row.push(half),
            Gap::Map => row.extend(grid.weights(x).iter().map(|weight| half * weight)),
        }
        let factor = grid.drift_factor(place.instant);
        match self.drift {
            Drift::None => {}
            Drift::Offset => row.push(factor),
            Drift::Line => row.extend([factor, factor * grid.along_m(x)]),
            Drift::Map => row.extend(grid.weights(x).iter().map(|weight| factor * weight)),
        }
        DVector::from_vec(row)
    }

    /// The rows of the design at places.
    #[must_use]
    pub fn design(&self, grid: &Grid, places: &[Place]) -> DMatrix<f64> {
        let count = self.columns(grid).drift.end;
        let rows: Vec<DVector<f64>> = places.iter().map(|place| self.row(grid, place)).collect();
        DMatrix::from_fn(places.len(), count, |i, j| rows[i][j])
    }

    /// The penalty of a drift over position: the square of what is not a straight line.
    #[must_use]
    pub fn penalty(&self, grid: &Grid) -> DMatrix<f64> {
        let Columns { drift, .. } = self.columns(grid);
        let mut penalty = DMatrix::zeros(drift.end, drift.end);
        if self.drift == Drift::Map {
            let square = grid.without_line();
            penalty.view_mut((drift.start, drift.start), (drift.len(), drift.len())).copy_from(&square);
        }
        penalty
    }
}
