//! Which part of the catalogue's data is wrong, and by how much.
//!
//! The paper leaves the factor of 2 to 3 to reduction factors for the guideways' stiffness. Here each part of
//! the structure gets a factor in its turn, fitted to circles; circles that the fit has not seen judge which part
//! it was. A mass bends the machine as much as a spring too soft by the same factor: the drive forces, which
//! feel the mass alone, tell the two apart.

use super::bench::AXES;
use super::circles::{Lap, Measured};
use model::bodies::talk::Talk;
use model::bodies::{Assembly, JointKind, Part, Structure, StructureError};

/// What may be wrong.
pub const PARTS: [(Part, &str); 5] = [
    (Part::Joints(JointKind::Guideway), "stiffness of the guideways"),
    (Part::Screws, "stiffness of the screws"),
    (Part::Joints(JointKind::Flange), "stiffness of the column's foot"),
    (Part::Joints(JointKind::Foot), "stiffness of the machine's feet"),
    (Part::Masses, "masses"),
];

/// Least factor that is tried; the greatest is its inverse.
const LEAST_FACTOR: f64 = 0.05;

/// Standard deviations of the readings, by which errors of tool (µm) and force (N) are weighed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// External.
    pub tool_um: f64,
    /// Drive.
    pub force_n: f64,
}

/// A part with the factor that fits best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// What.
    pub part: Part,
    /// In words.
    pub name: &'static str,
    /// Of the catalogue's data.
    pub factor: f64,
    /// Error that is left on circles that it has not seen, in standard deviations of the readings.
    pub left: f64,
}

impl Candidate {
    /// Whether it has a best factor: one that goes to an end of what is tried shows in no reading.
    #[must_use]
    pub fn helps(&self) -> bool {
        self.factor.ln().abs() < -0.99 * LEAST_FACTOR.ln()
    }
}

/// All parts, fitted to one measurement and judged by another, best first.
///
/// # Errors
/// Where a structure cannot be built.
pub fn candidates(
    catalogue: &Structure,
    fit: &Measured,
    judge: &Measured,
    weights: Weights,
) -> Result<Vec<Candidate>, StructureError> {
    let mut all = Vec::new();
    for (part, name) in PARTS {
        let error = |log_factor: f64, measured: &Measured| {
            let assembly = Assembly::of(&catalogue.scaled(part, log_factor.exp()))?;
            Ok::<f64, StructureError>(distance(measured, &assembly.talk_at(measured.rad_per_s)?, weights))
        };
        let best = least(LEAST_FACTOR.ln(), -LEAST_FACTOR.ln(), |at| error(at, fit))?;
        all.push(Candidate { part, name, factor: best.exp(), left: error(best, judge)? });
    }
    all.sort_by(|a, b| a.left.total_cmp(&b.left));
    Ok(all)
}

/// Root mean square over a circle of what a model gets wrong, tool and forces together, in standard deviations of the
/// readings.
#[must_use]
pub fn distance(measured: &Measured, model: &Talk, weights: Weights) -> f64 {
    // A coefficient that is wrong by e shows as e·a·cos ωt.
    let swing = measured.reached_m_per_s2 * std::f64::consts::FRAC_1_SQRT_2;
    let mut squares = 0.0;
    for axis in 0..AXES {
        for along in 0..AXES {
            let error = measured.talk_um_s2_per_m[(along, axis)] - model.tool_um_s2_per_m[(along, axis)];
            squares += (swing * error / weights.tool_um).powi(2);
        }
        let error = measured.felt_kg[axis] - model.force_kg[(axis, axis)];
        squares += (swing * error / weights.force_n).powi(2);
    }
    (squares / (AXES * AXES + AXES) as f64).sqrt()
}

/// Root mean square of the error at the tool that coefficients leave on circles, all directions, µm; `None`: of
/// the error itself.
#[must_use]
pub fn left_um(laps: &[Lap], talk: Option<&Talk>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for lap in laps {
        for (row, acceleration) in lap.rows.iter().zip(&lap.acceleration) {
            for along in 0..AXES {
                let coefficient = |axis: usize| talk.map_or(0.0, |talk| talk.tool_um_s2_per_m[(along, axis)]);
                let predicted: f64 =
                    lap.plane.iter().zip(acceleration).map(|(axis, a)| coefficient(*axis) * a).sum();
                squares += (1e6 * row.error_m(along) - predicted).powi(2);
                count += 1.0;
            }
        }
    }
    (squares / count).sqrt()
}

/// Where a function of one variable with one valley is least: the golden section.
fn least<E>(mut from: f64, mut to: f64, mut of: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    // Each round leaves 0.618 of the range: to 1e-6 of it.
    const ROUNDS: u32 = 29;
    let mut left = to - SHARE * (to - from);
    let mut right = from + SHARE * (to - from);
    let (mut at_left, mut at_right) = (of(left)?, of(right)?);
    for _ in 0..ROUNDS {
        if at_left <= at_right {
            (to, right, at_right) = (right, left, at_left);
            left = to - SHARE * (to - from);
            at_left = of(left)?;
        } else {
            (from, left, at_left) = (left, right, at_right);
            right = from + SHARE * (to - from);
            at_right = of(right)?;
        }
    }
    Ok(0.5 * (from + to))
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::reproduce::acceleration::machines::{self, WEIGHTS};

    /// What circles of a structure would show without noise.
    fn shown(structure: &Structure, rad_per_s: f64) -> Measured {
        let talk = Assembly::of(structure).unwrap().talk_at(rad_per_s).unwrap();
        let talk_um_s2_per_m = Matrix3::from_fn(|along, axis| talk.tool_um_s2_per_m[(along, axis)]);
        Measured {
            talk_um_s2_per_m,
            deviation_um_s2_per_m: Matrix3::zeros(),
            felt_kg: [0, 1, 2].map(|axis| talk.force_kg[(axis, axis)]),
            reached_m_per_s2: 5.0,
            rad_per_s,
        }
    }

    /// Whatever part was changed is found, with its factor. Screws do not show behind scales.
    #[test]
    fn the_part_that_was_changed_is_found() {
        let catalogue = machines::catalogue().unwrap();
        for (part, name) in PARTS.into_iter().filter(|(part, _)| *part != Part::Screws) {
            for factor in [0.4, 1.7] {
                let changed = catalogue.scaled(part, factor);
                let (fit, judge) = (shown(&changed, 50.0), shown(&changed, 45.0));
                let all = candidates(&catalogue, &fit, &judge, WEIGHTS).unwrap();
                let best = all[0];
                assert_eq!((best.part, best.name), (part, name));
                // Ends of the golden section.
                assert!((best.factor / factor - 1.0).abs() < 2e-5, "{name}: {}", best.factor);
            }
        }
    }

    /// A coefficient that is wrong by e leaves e·a/√2, one of twelve.
    #[test]
    fn the_distance_is_a_root_mean_square() {
        let catalogue = machines::catalogue().unwrap();
        let mut measured = shown(&catalogue, 50.0);
        let talk = Assembly::of(&catalogue).unwrap().talk_at(50.0).unwrap();
        assert!(distance(&measured, &talk, WEIGHTS) < 1e-9);
        measured.talk_um_s2_per_m[(1, 2)] += 0.1;
        let expected = 0.1 * 5.0 / 2f64.sqrt() / WEIGHTS.tool_um / 12f64.sqrt();
        assert!((distance(&measured, &talk, WEIGHTS) / expected - 1.0).abs() < 1e-9);
    }
}
