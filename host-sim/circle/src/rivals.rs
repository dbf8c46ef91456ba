//! What a part may be confused with.
//!
//! - A circle sees the whole lost motion of an axis: backlash, and the wind-up of its drive under friction.
//! - In one direction at one speed, squareness and servo mismatch are one oval.
//! - Smooth parts whose estimates depend on each other, because too little of the circle was measured, name each other.
//! - Where no fitted shape describes a spike, its remains fall into smaller parts, which name it.
//! - A spike that is as wide as it takes a drive to make up for lost motion may be backlash, and the reverse.

use super::part::{Name, OTHER_SHAPE, Part};
use super::samples::Samples;
use super::selection::Fitted;
use super::term::Term;

/// Correlation of two estimates above which they name each other.
const MAX_CORRELATION: f64 = 0.97;

/// Width of a spike, degrees, above which it resembles a step.
const WIDE_DEG: f64 = 8.0;

/// Whether a part is a spike that no fitted shape describes: what is left of it falls into other parts.
fn is_undescribed(part: &Part) -> bool {
    part.shape == Some(OTHER_SHAPE)
}

/// Whether the remains of a spike may be in a part.
fn takes_remains(name: Name) -> bool {
    use Name::{Backlash, Cyclic, LateralPlay, Radius, ScaleMismatch, ServoMismatch};
    matches!(name, Backlash | Cyclic | LateralPlay | Radius | ScaleMismatch | ServoMismatch)
}

/// Removes stick-slip of an axis with a spike that no shape describes: its remains are irregular near the reversals, too.
pub fn without_remains(parts: &mut Vec<Part>) {
    let axes: Vec<String> =
        parts.iter().filter(|part| is_undescribed(part)).map(|part| part.axis.clone()).collect();
    parts.retain(|part| part.name != Name::StickSlip || !axes.contains(&part.axis));
}

/// Adds the rivals of each part.
pub fn assign(parts: &mut [Part], samples: &Samples, fitted: &Fitted) {
    let found: Vec<(Name, String, Option<usize>)> =
        parts.iter().map(|part| (part.name, part.axis.clone(), index(part, fitted))).collect();
    let is_one_oval = fitted.index(Term::Servo).is_none();
    let remains_um = numerics::max_abs(parts.iter().filter(|part| is_undescribed(part)).map(|part| part.um));
    for part in parts.iter_mut() {
        let mut rivals = of_name(part, is_one_oval);
        if !samples.has_both_axes()
            && let Some(i) = index(part, fitted)
        {
            let others = found.iter().filter(|(name, axis, _)| (*name, axis) != (part.name, &part.axis));
            let correlated =
                others.filter(|(_, _, j)| j.is_some_and(|j| correlation(fitted, i, j) > MAX_CORRELATION));
            rivals.extend(correlated.map(|(name, ..)| name.word()));
        }
        if takes_remains(part.name) && part.um < remains_um {
            rivals.push(Name::ReversalSpike.word());
        }
        for rival in rivals {
            if !part.rivals.contains(&rival) && rival != part.name.word() {
                part.rivals.push(rival);
            }
        }
    }
}

/// The rivals that follow from the name alone.
fn of_name(part: &Part, is_one_oval: bool) -> Vec<&'static str> {
    let width_deg = part.details.iter().find(|detail| detail.key == "width_deg").map(|detail| detail.value);
    match part.name {
        Name::Backlash => vec!["windup"],
        Name::Squareness if is_one_oval => vec![Name::ServoMismatch.word()],
        Name::ReversalSpike if width_deg.is_some_and(|deg| deg > WIDE_DEG) => vec![Name::Backlash.word()],
        Name::StickSlip => vec![Name::Vibration.word(), Name::Cyclic.word()],
        _ => Vec::new(),
    }
}

/// The term of a part of a single smooth coefficient.
fn index(part: &Part, fitted: &Fitted) -> Option<usize> {
    match part.terms[..] {
        [(term, _)] => fitted.index(term),
        _ => None,
    }
}

fn correlation(fitted: &Fitted, i: usize, j: usize) -> f64 {
    let inverse = &fitted.fit.inverse;
    (inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt()).abs()
}
