//! All simulations and fits of the paper.

use model::bodies::Assembly;
use model::bodies::talk::Talk;

use super::circles::{self, CircleRecord, Measured};
use super::closed_loop::{ClosedLoop, X, Z};
use super::identify::{self, Candidate};
use super::machines::{self, Instruments};
use super::z_move::{self, Limits, Peaks, ZMove};
use crate::reproduce::study::ReproduceError;

/// Set acceleration of the circles that the factors are fitted to, m/s².
const FIT_M_PER_S2: f64 = 5.0;

/// Set acceleration of the circles that validate the fit, m/s².
const VALIDATION_M_PER_S2: f64 = 4.5;

/// Results of all simulations.
pub struct Experiment {
    /// Circles of the catalogue's machine, without noise.
    pub catalogue: Measured,
    /// Circles of the true machine, evaluated; the factors are fitted to them.
    pub measured: Measured,
    /// Records of those circles.
    pub circles: Vec<CircleRecord>,
    /// Records of other circles of the true machine, not used in the fit.
    pub validation_circles: Vec<CircleRecord>,
    /// This experiment, evaluated.
    pub validation: Measured,
    /// Parts of the catalogue's model that may be wrong, best first.
    pub candidates: Vec<Candidate>,
    /// Coefficients of the catalogue's machine at the frequency of the validation circles.
    pub before: Talk,
    /// Coefficients of the identified machine at the same frequency.
    pub after: Talk,
    /// The 20 mm movement of the catalogue's machine.
    pub simulated_move: ZMove,
    /// The 20 mm movement of the true machine.
    pub measured_move: ZMove,
    /// Peak values that the interpolator commands on 20 mm: with the printed limits, with twice the speed limit, and
    /// with the jerk limit that reaches the acceleration limit.
    pub commanded: [Peaks; 3],
}

impl Experiment {
    /// Runs everything.
    ///
    /// # Errors
    /// If a simulation or a fit fails.
    pub fn run() -> Result<Self, ReproduceError> {
        let catalogue = machines::catalogue()?;
        let model = ClosedLoop::new(&catalogue, machines::GAINS, Instruments::default())?;
        let real = ClosedLoop::new(&machines::truth(&catalogue), machines::GAINS, machines::instruments())?;
        let circles = circles::run(&real, FIT_M_PER_S2)?;
        let measured = circles::evaluate(&circles)?;
        let validation_circles = circles::run(&real.reseeded(1), VALIDATION_M_PER_S2)?;
        let validation = circles::evaluate(&validation_circles)?;
        let candidates = identify::candidates(&catalogue, &measured, &validation, machines::WEIGHTS)?;
        let best = candidates.first().ok_or_else(|| ReproduceError::Numerics("no candidate".to_owned()))?;
        let identified = catalogue.scaled(best.part, best.factor);
        let printed = z_move::PRINTED;
        let faster = Limits { speed_m_per_s: 2.0 * printed.speed_m_per_s, ..printed };
        let more_jerk = Limits {
            jerk_m_per_s3: 1.01 * z_move::jerk_reaching(z_move::DISTANCE_M, printed.acceleration_m_per_s2),
            ..printed
        };
        Ok(Self {
            catalogue: circles::evaluate(&circles::run(&model, FIT_M_PER_S2)?)?,
            measured,
            circles,
            before: Assembly::of(&catalogue)?.talk_at(validation.rad_per_s)?,
            after: Assembly::of(&identified)?.talk_at(validation.rad_per_s)?,
            validation_circles,
            validation,
            candidates,
            simulated_move: ZMove::run(&model)?,
            measured_move: ZMove::run(&real.reseeded(2))?,
            commanded: [
                z_move::commanded(printed)?,
                z_move::commanded(faster)?,
                z_move::commanded(more_jerk)?,
            ],
        })
    }

    /// Error at the tool on the validation circles, µm rms, with the probe's noise removed: uncorrected, after the
    /// catalogue's model, and after the identified one.
    pub fn residuals_um(&self) -> [f64; 3] {
        [None, Some(&self.before), Some(&self.after)]
            .map(|talk| without_noise_um(identify::rms_residual_um(&self.validation_circles, talk)))
    }

    /// Residual with the guideways' factor, divided by the residual with the best of the other parts.
    pub fn guideways_over_next(&self) -> f64 {
        let is_guideway = |candidate: &&Candidate| candidate.part == identify::PARTS[0].0;
        let guideways = self.candidates.iter().find(is_guideway);
        let other = self.candidates.iter().find(|candidate| !is_guideway(candidate));
        guideways.zip(other).map_or(f64::NAN, |(guideways, other)| guideways.residual / other.residual)
    }

    /// Cross-talk of z to x on circles, µm per m/s².
    pub fn z_to_x(measured: &Measured) -> f64 {
        measured.talk_um_s2_per_m[(X, Z)]
    }
}

/// Rms of probe readings with the probe's noise removed, µm: √(rms² − σ²), 0 if the rms is below the noise.
pub fn without_noise_um(rms_um: f64) -> f64 {
    (rms_um.powi(2) - machines::WEIGHTS.tool_um.powi(2)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The factor of the guideways is found to within the scatter of the true machine, and it holds on circles and on
    /// a movement outside the fit: at least five times better than the catalogue, and not below the noise.
    #[test]
    fn the_guideways_are_found_and_the_error_falls() {
        let experiment = Experiment::run().unwrap();
        let best = experiment.candidates[0];
        assert_eq!(best.part, identify::PARTS[0].0);
        assert!(
            (best.factor / machines::TRUE_GUIDEWAY_FACTOR - 1.0).abs() < machines::GUIDEWAY_SCATTER,
            "{best:?}"
        );
        let [raw, before, after] = experiment.residuals_um();
        assert!(before < 0.75 * raw && before > 0.5 * raw, "{raw} {before}");
        assert!(after < 0.2 * before && after > 0.01, "{before} {after}");
        let on_circles = Experiment::z_to_x(&experiment.measured);
        let on_the_move = experiment.measured_move.coefficient(X);
        assert!((on_the_move / on_circles - 1.0).abs() < 0.05, "{on_circles} {on_the_move}");
    }
}
