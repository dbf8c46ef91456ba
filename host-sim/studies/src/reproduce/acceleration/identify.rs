//! Identifies which part of the catalogue's data is wrong, and by which factor.
//!
//! The paper explains the factor of 2 to 3 by reduced stiffness of the guideways. Here each part of the structure in
//! turn gets a factor, fitted to one set of circles; a second set, not used in the fit, ranks the parts. Masses that are
//! too large deflect the machine like springs that are too soft by the same factor; the drive forces, which depend on
//! the masses only, separate the two.

use super::circles::{CircleRecord, Measured};
use super::closed_loop::AXES;
use super::machines::Weights;
use model::bodies::talk::Talk;
use model::bodies::{Assembly, JointKind, Part, Structure, StructureError};

/// Parts of the model that may be wrong, with their names in the report.
pub const PARTS: [(Part, &str); 5] = [
    (Part::Joints(JointKind::Guideway), "stiffness of the guideways"),
    (Part::Screws, "stiffness of the screws"),
    (Part::Joints(JointKind::Flange), "stiffness of the column's foot"),
    (Part::Joints(JointKind::Foot), "stiffness of the machine's feet"),
    (Part::Masses, "masses"),
];

/// Lower limit of the search for a factor; the upper limit is its inverse.
const MIN_FACTOR: f64 = 0.05;

/// A part with its best factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The part.
    pub part: Part,
    /// Its name in the report.
    pub name: &'static str,
    /// Best factor on the catalogue's data.
    pub factor: f64,
    /// Rms error with that factor on the validation circles, in standard deviations of the readings.
    pub residual: f64,
}

impl Candidate {
    /// Whether the factor is identifiable: at a limit of the search no reading depends on it.
    #[must_use]
    pub fn is_identifiable(&self) -> bool {
        libm::log(self.factor).abs() < -0.99 * libm::log(MIN_FACTOR)
    }
}

/// All parts, fitted to one measurement and ranked by another, best first.
///
/// # Errors
/// If a scaled structure is invalid.
pub fn candidates(
    catalogue: &Structure,
    fit: &Measured,
    validation: &Measured,
    weights: Weights,
) -> Result<Vec<Candidate>, StructureError> {
    let mut all = Vec::new();
    for (part, name) in PARTS {
        let error = |log_factor: f64, measured: &Measured| {
            let assembly = Assembly::of(&catalogue.scaled(part, libm::exp(log_factor)))?;
            Ok::<f64, StructureError>(rms_error(measured, &assembly.talk_at(measured.rad_per_s)?, weights))
        };
        let best = minimum(libm::log(MIN_FACTOR), -libm::log(MIN_FACTOR), |at| error(at, fit))?;
        all.push(Candidate { part, name, factor: libm::exp(best), residual: error(best, validation)? });
    }
    all.sort_by(|a, b| a.residual.total_cmp(&b.residual));
    Ok(all)
}

/// Rms error of a model over a circle, tool and drive forces together, in standard deviations of the readings.
#[must_use]
pub fn rms_error(measured: &Measured, model: &Talk, weights: Weights) -> f64 {
    // An error e of a coefficient gives e·a·cos ωt, of rms e·a/√2.
    let rms_m_per_s2 = measured.reached_m_per_s2 * std::f64::consts::FRAC_1_SQRT_2;
    let mut squares = 0.0;
    for axis in 0..AXES {
        for along in 0..AXES {
            let error = measured.talk_um_s2_per_m[(along, axis)] - model.tool_um_s2_per_m[(along, axis)];
            squares += (rms_m_per_s2 * error / weights.tool_um).powi(2);
        }
        let error = measured.effective_kg[axis] - model.force_kg[(axis, axis)];
        squares += (rms_m_per_s2 * error / weights.force_n).powi(2);
    }
    (squares / (AXES * AXES + AXES) as f64).sqrt()
}

/// Rms error at the tool on circles after subtraction of a model, all directions, µm; `None` subtracts nothing.
#[must_use]
pub fn rms_residual_um(circles: &[CircleRecord], talk: Option<&Talk>) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for circle in circles {
        for (row, acceleration) in circle.rows.iter().zip(&circle.acceleration) {
            for along in 0..AXES {
                let coefficient = |axis: usize| talk.map_or(0.0, |talk| talk.tool_um_s2_per_m[(along, axis)]);
                let predicted: f64 =
                    circle.plane.iter().zip(acceleration).map(|(axis, a)| coefficient(*axis) * a).sum();
                squares += (1e6 * row.error_m(along) - predicted).powi(2);
                count += 1.0;
            }
        }
    }
    (squares / count).sqrt()
}

/// Argument at the minimum of a unimodal function between `from` and `to`, by golden-section search.
fn minimum<E>(mut from: f64, mut to: f64, mut of: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
    /// (√5 − 1)/2.
    const RATIO: f64 = 0.618_033_988_749_894_8;
    /// Each iteration keeps 0.618 of the range: 0.618²⁹ = 1e-6.
    const ITERATIONS: u32 = 29;
    let mut left = to - RATIO * (to - from);
    let mut right = from + RATIO * (to - from);
    let (mut at_left, mut at_right) = (of(left)?, of(right)?);
    for _ in 0..ITERATIONS {
        if at_left <= at_right {
            (to, right, at_right) = (right, left, at_left);
            left = to - RATIO * (to - from);
            at_left = of(left)?;
        } else {
            (from, left, at_left) = (left, right, at_right);
            right = from + RATIO * (to - from);
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

    /// Circles of a structure without noise.
    fn noiseless(structure: &Structure, rad_per_s: f64) -> Measured {
        let talk = Assembly::of(structure).unwrap().talk_at(rad_per_s).unwrap();
        let talk_um_s2_per_m = Matrix3::from_fn(|along, axis| talk.tool_um_s2_per_m[(along, axis)]);
        Measured {
            talk_um_s2_per_m,
            deviation_um_s2_per_m: Matrix3::zeros(),
            effective_kg: [0, 1, 2].map(|axis| talk.force_kg[(axis, axis)]),
            reached_m_per_s2: 5.0,
            rad_per_s,
        }
    }

    /// The changed part is found, with its factor. Screw stiffness is not observable: the scales measure behind it.
    #[test]
    fn the_part_that_was_changed_is_found() {
        let catalogue = machines::catalogue().unwrap();
        for (part, name) in PARTS.into_iter().filter(|(part, _)| *part != Part::Screws) {
            for factor in [0.4, 1.7] {
                let changed = catalogue.scaled(part, factor);
                let (fit, validation) = (noiseless(&changed, 50.0), noiseless(&changed, 45.0));
                let all = candidates(&catalogue, &fit, &validation, WEIGHTS).unwrap();
                let best = all[0];
                assert_eq!((best.part, best.name), (part, name));
                // Resolution of the golden-section search.
                assert!((best.factor / factor - 1.0).abs() < 2e-5, "{name}: {}", best.factor);
            }
        }
    }

    /// An error e of one coefficient gives e·a/√2 in one of the twelve terms.
    #[test]
    fn the_error_is_a_root_mean_square() {
        let catalogue = machines::catalogue().unwrap();
        let mut measured = noiseless(&catalogue, 50.0);
        let talk = Assembly::of(&catalogue).unwrap().talk_at(50.0).unwrap();
        assert!(rms_error(&measured, &talk, WEIGHTS) < 1e-9);
        measured.talk_um_s2_per_m[(1, 2)] += 0.1;
        let expected = 0.1 * 5.0 / 2f64.sqrt() / WEIGHTS.tool_um / 12f64.sqrt();
        assert!((rms_error(&measured, &talk, WEIGHTS) / expected - 1.0).abs() < 1e-9);
    }
}
