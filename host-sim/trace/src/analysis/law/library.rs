//! The terms that a law may contain.

use model::residual_law::{Term, WavePosition};
use model::residual_table::TableVariable as V;

use crate::fit::fit_data::FitData;
use crate::prediction::table_variable;
use model::effects::Stage;

/// Variables, each of which may be a factor.
const VARIABLES: [V; 11] = [
    V::PositionMm,
    V::VelocityMPerS,
    V::SpeedMPerS,
    V::AccelerationMPerS2,
    V::Direction,
    V::ForceN,
    V::TimeS,
    V::OtherPositionMm,
    V::OtherVelocityMPerS,
    V::OtherAccelerationMPerS2,
    V::OtherDirection,
];

/// Each position of which cubes and waves are in the library.
pub const POSITIONS: [WavePosition; 2] = [WavePosition::PositionMm, WavePosition::OtherPositionMm];

/// Distances of which a hysteresis is tried, mm; the best one is refined.
const DISTANCES_MM: [f64; 9] = [0.03, 0.1, 0.3, 1.0, 2.5, 6.0, 15.0, 40.0, 100.0];

/// The variables that every log of some data contains, and that do not contain the residual itself.
#[must_use]
pub fn variables(data: &FitData<'_>, stage: Stage) -> Vec<V> {
    let is_known = |variable: &V| {
        data.logs_with(stage).all(|log| {
            table_variable::values(&data.logs[log], data.axis, *variable).is_some_and(|all| !all.is_empty())
        })
    };
    let is_independent = |variable: &V| *variable != V::ForceN || stage != Stage::Force;
    VARIABLES.into_iter().filter(is_independent).filter(is_known).collect()
}

/// All terms of these variables, with coefficients of 1: each alone, products of two, cubes of positions, and
/// hystereses. Waves are added once their periods are known: see [`super::waves`].
#[must_use]
pub fn terms(variables: &[V]) -> Vec<Term> {
    let product = |of: Vec<V>| Term::Product { of, coefficient: 1.0 };
    let mut all: Vec<Term> = variables.iter().map(|one| product(vec![*one])).collect();
    for (i, &a) in variables.iter().enumerate() {
        all.extend(variables[i..].iter().filter(|&&b| !is_redundant(a, b)).map(|&b| product(vec![a, b])));
    }
    let positions = POSITIONS.map(WavePosition::variable);
    all.extend(positions.into_iter().filter(|one| variables.contains(one)).map(|one| product(vec![one; 3])));
    if variables.contains(&V::PositionMm) {
        all.extend(DISTANCES_MM.map(|distance_mm| Term::Hysteresis { distance_mm, coefficient: 1.0 }));
    }
    all
}

/// Whether a product is a constant or another term of the library: direction·direction, direction·speed, … Of the time, products
/// would be drifts of everything.
fn is_redundant(a: V, b: V) -> bool {
    let is = |x: V, y: V| (a, b) == (x, y) || (b, a) == (x, y);
    a == V::TimeS
        || b == V::TimeS
        || is(V::Direction, V::Direction)
        || is(V::OtherDirection, V::OtherDirection)
        || is(V::Direction, V::SpeedMPerS)
        || is(V::Direction, V::VelocityMPerS)
        || is(V::SpeedMPerS, V::SpeedMPerS)
}

/// Whether two terms say the same of these logs: they differ at most in coefficients, or in a distance or a period that the travel
/// does not resolve.
#[must_use]
pub fn is_same_form(a: &Term, b: &Term, travel_mm: impl Fn(WavePosition) -> f64) -> bool {
    match (a, b) {
        (Term::Product { of: a, .. }, Term::Product { of: b, .. }) => a == b,
        (Term::Hysteresis { .. }, Term::Hysteresis { .. }) => true,
        (Term::Wave { over: a, period_mm: of_a, .. }, Term::Wave { over: b, period_mm: of_b, .. }) => {
            a == b && (1.0 / of_a - 1.0 / of_b).abs() * travel_mm(*a) < 1.0
        }
        _ => false,
    }
}

/// Number of values that a fit of the term determines.
#[must_use]
pub const fn parameters(term: &Term) -> i32 {
    match term {
        Term::Product { .. } => 1,
        Term::Hysteresis { .. } => 2,
        Term::Wave { .. } => 3,
    }
}
