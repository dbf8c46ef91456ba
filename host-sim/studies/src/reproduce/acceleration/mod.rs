//! Measurement and simulation of acceleration-correlated position errors (Nguyen, Weikert, Wegener).
//!
//! [`machines`] has the catalogue's machine and the true one, [`mod@bench`] closes the loop about either, [`circles`]
//! evaluates the paper's measurement, [`identify`] finds what the catalogue has wrong, [`travel`] is the 20 mm
//! movement that has to agree.

mod bench;
mod circles;
mod identify;
mod machines;
mod pictures;
mod travel;
mod words;

use super::{Outcome, Printed, ReproduceError, Study};
use model::bodies::talk::Talk;
use model::bodies::{Assembly, StructureError};

use bench::{Bench, Instruments};
use circles::{Lap, Measured};
use identify::Candidate;
use travel::{Peaks, Travel, Z};

/// Set acceleration of the circles that are fitted, and of those that judge, m/s².
const FITTED_M_PER_S2: f64 = 5.0;
const JUDGING_M_PER_S2: f64 = 4.5;

/// The direction in which the paper looks at what z does.
const X: usize = 0;

impl From<StructureError> for ReproduceError {
    fn from(error: StructureError) -> Self {
        Self::Numerics(error.to_string())
    }
}

/// All that came out.
struct Experiment {
    /// Circles of the catalogue's machine, without noise.
    catalogue: Measured,
    /// Circles of the true machine.
    measured: Measured,
    laps: Vec<Lap>,
    /// Others, which nothing is fitted to.
    judging: Vec<Lap>,
    judge: Measured,
    /// Parts that may be wrong, best first.
    candidates: Vec<Candidate>,
    /// What the catalogue's and the identified machine do on the judging circles.
    before: Talk,
    after: Talk,
    /// The 20 mm movement of the catalogue's machine, and of the true one.
    simulated: Travel,
    travelled: Travel,
    /// What the interpolator makes of it with the printed limits, a higher speed, and the jerk that it would take.
    commanded: [Peaks; 3],
}

impl Experiment {
    fn run() -> Result<Self, ReproduceError> {
        let catalogue = machines::catalogue()?;
        let model = Bench::new(&catalogue, machines::GAINS, Instruments::default())?;
        let shop = Bench::new(&machines::truth(&catalogue), machines::GAINS, machines::instruments())?;
        let laps = circles::run(&shop, FITTED_M_PER_S2)?;
        let measured = circles::evaluate(&laps)?;
        let judging = circles::run(&shop.reseeded(1), JUDGING_M_PER_S2)?;
        let judge = circles::evaluate(&judging)?;
        let candidates = identify::candidates(&catalogue, &measured, &judge, machines::WEIGHTS)?;
        let best = candidates.first().ok_or_else(|| ReproduceError::Numerics("no candidate".to_owned()))?;
        let found = catalogue.scaled(best.part, best.factor);
        let printed = travel::PRINTED;
        let faster = travel::Limits { speed_m_per_s: 2.0 * printed.speed_m_per_s, ..printed };
        let harder = travel::Limits {
            jerk_m_per_s3: 1.01 * travel::jerk_for(travel::WAY_M, printed.acceleration_m_per_s2),
            ..printed
        };
        Ok(Self {
            catalogue: circles::evaluate(&circles::run(&model, FITTED_M_PER_S2)?)?,
            measured,
            laps,
            before: Assembly::of(&catalogue)?.talk_at(judge.rad_per_s)?,
            after: Assembly::of(&found)?.talk_at(judge.rad_per_s)?,
            judging,
            judge,
            candidates,
            simulated: Travel::run(&model)?,
            travelled: Travel::run(&shop.reseeded(2))?,
            commanded: [travel::commanded(printed)?, travel::commanded(faster)?, travel::commanded(harder)?],
        })
    }

    /// Error at the tool on the judging circles: as it is, and what the catalogue's and the identified machine leave, µm
    /// rms, the probe's noise taken out.
    fn left_um(&self) -> [f64; 3] {
        [None, Some(&self.before), Some(&self.after)]
            .map(|talk| without_noise(identify::left_um(&self.judging, talk)))
    }

    fn outcomes(&self) -> Vec<Outcome> {
        // Half of the last printed digit.
        let figure = |value: f64, tolerance: f64| Printed::Figure { value, tolerance };
        let exz = |measured: &Measured| measured.talk_um_s2_per_m[(X, Z)];
        let spread = self.measured.deviation_um_s2_per_m[(X, Z)];
        let (peak, deviation) = self.simulated.at_most(X);
        let [commanded, ..] = self.commanded;
        let talk = "µm·s²/m";
        vec![
            Outcome::new(
                "circle of 2 mm at 5 m/s²: frequency",
                figure(8.0, 0.5),
                self.catalogue.rad_per_s / std::f64::consts::TAU,
                "Hz",
            ),
            Outcome::new(
                "circle, simulated: acceleration reached",
                figure(4.7, 0.05),
                self.catalogue.reached_m_per_s2,
                "m/s²",
            ),
            Outcome::new(
                "cross-talk of z to x, simulated with catalogue stiffness",
                figure(-0.55, 0.005),
                exz(&self.catalogue),
                talk,
            ),
            // Beside half a digit, two standard errors of the plane fit: the probe has the paper's uncertainty.
            Outcome::new(
                "cross-talk of z to x, measured",
                figure(-1.55, 0.005 + 2.0 * spread),
                exz(&self.measured),
                talk,
            ),
            Outcome::new(
                "cross-talk, measured over simulated",
                Printed::Between(2.0, 3.0),
                exz(&self.measured) / exz(&self.catalogue),
                "",
            ),
            Outcome::new("20 mm move: acceleration reached", figure(7.9, 0.05), peak, "m/s²"),
            Outcome::new("20 mm move: deviation in x then", figure(3.7, 0.05), deviation.abs(), "µm"),
            Outcome::new(
                "20 mm move: cross-talk of z to x then",
                figure(-0.48, 0.005),
                deviation / peak,
                talk,
            ),
            Outcome::new(
                "20 mm move: set acceleration, below its limit of 10",
                Printed::Below(travel::PRINTED.acceleration_m_per_s2),
                commanded.acceleration_m_per_s2,
                "m/s²",
            ),
            Outcome::new(
                "20 mm move: jerk at its limit",
                figure(250.0, 0.5),
                commanded.jerk_m_per_s3,
                "m/s³",
            ),
            Outcome::new(
                "20 mm move: speed at its limit",
                figure(0.5, 0.005),
                commanded.speed_m_per_s,
                "m/s",
            ),
            Outcome::new(
                "guideways against the next best part: error left on judging circles",
                Printed::Below(1.0),
                self.guideways_over_next(),
                "",
            ),
            // "Quite good accordance": within the standard uncertainty of the probe, half of the printed U(k = 2).
            Outcome::new(
                "error left on judging circles by the identified machine",
                Printed::Below(machines::WEIGHTS.tool_um),
                self.left_um()[2],
                "µm",
            ),
        ]
    }

    /// Error that is left with the guideways' factor, over that with the best of the other parts.
    fn guideways_over_next(&self) -> f64 {
        let is_guideway = |candidate: &&Candidate| candidate.part == identify::PARTS[0].0;
        let guideways = self.candidates.iter().find(is_guideway);
        let other = self.candidates.iter().find(|candidate| !is_guideway(candidate));
        guideways.zip(other).map_or(f64::NAN, |(guideways, other)| guideways.left / other.left)
    }
}

/// A root mean square of probe readings without the probe's noise, µm.
fn without_noise(um: f64) -> f64 {
    (um.powi(2) - machines::WEIGHTS.tool_um.powi(2)).max(0.0).sqrt()
}

/// Runs the experiments of the paper.
///
/// # Errors
/// When a loop does not hold.
pub fn run() -> Result<Study, ReproduceError> {
    let experiment = Experiment::run()?;
    Ok(Study {
        paper: "Nguyen",
        title: "Acceleration-correlated position errors",
        said: experiment.said(),
        outcomes: experiment.outcomes(),
        pictures: pictures::all(&experiment),
        notes: words::NOTES.map(str::to_owned).to_vec(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hidden share is found to within its own scatter, and what is found holds on circles and on a movement that
    /// it has not seen: at least five times better than the catalogue, and not better than the noise allows.
    #[test]
    fn the_guideways_are_found_and_the_error_falls() {
        let experiment = Experiment::run().unwrap();
        let best = experiment.candidates[0];
        assert_eq!(best.part, identify::PARTS[0].0);
        assert!((best.factor / machines::TRUE_SHARE - 1.0).abs() < machines::GUIDEWAY_SCATTER, "{best:?}");
        let [raw, before, after] = experiment.left_um();
        assert!(before < 0.75 * raw && before > 0.5 * raw, "{raw} {before}");
        assert!(after < 0.2 * before && after > 0.01, "{before} {after}");
        let on_circles = experiment.measured.talk_um_s2_per_m[(X, Z)];
        let on_the_move = experiment.travelled.coefficient(X);
        assert!((on_the_move / on_circles - 1.0).abs() < 0.05, "{on_circles} {on_the_move}");
    }
}
