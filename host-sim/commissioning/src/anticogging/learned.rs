//! Which waves of the force are significant, and are confirmed by passes that their fit does not use.

use numerics::averages::{mean, rms};
use serde::{Deserialize, Serialize};

use super::declared::Declared;
use super::fit::Wave;
use super::forces::Forces;
use super::passes::Pair;
use super::plan::{Candidate, Plan};

/// Least amplitude of a wave that is found, standard errors.
const LEAST_ERRORS: f64 = 3.5;

/// Probability with which noise alone makes any of the waves significant, before the other passes are asked.
const FALSE_ALARMS: f64 = 0.01;

/// Least part of a wave that the other passes have in its phase: below it, subtracting the wave would make them worse.
const CONFIRMED: f64 = 0.5;

/// A wave that was looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Which one.
    pub candidate: Candidate,
    /// Force on the motor in addition to that of the drive, N.
    pub wave_n: Wave,
    /// Standard error of its sine and of its cosine, N.
    pub standard_error_n: f64,
    /// Amplitude from which it is significant, N.
    pub least_n: f64,
    /// The wave in the passes that the fit does not use, N.
    pub held_out_n: Wave,
}

impl Measured {
    /// Whether it exceeds the noise.
    #[must_use]
    pub fn is_significant(&self) -> bool {
        self.wave_n.norm() >= self.least_n
    }

    /// Whether the other passes have it, too.
    #[must_use]
    pub fn is_confirmed(&self) -> bool {
        let in_phase_n = (self.held_out_n * self.wave_n.conj()).re / self.wave_n.norm();
        in_phase_n > CONFIRMED * self.wave_n.norm()
    }

    /// Whether it is cogging.
    #[must_use]
    pub fn is_found(&self) -> bool {
        self.is_significant() && self.is_confirmed()
    }
}

/// Forces, following error and numbers of passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Force that the drive needs in the middle of the positions against load and gravity, N.
    pub load_n: f64,
    /// Change of the load over the positions, N.
    pub load_change_n: f64,
    /// Friction: half of the difference of the forces in both directions, N.
    pub friction_n: f64,
    /// Rms of the force over the position without load, in the passes that the fit does not use, N.
    pub before_n: f64,
    /// Rms of it without the waves that were found, N.
    pub after_n: f64,
    /// Rms of the following error about its mean in each of these passes, µm.
    pub following_error_um: f64,
    /// Pairs of passes from which the waves were fitted.
    pub fitted_pairs: usize,
    /// Pairs of passes with which they were judged.
    pub held_out_pairs: usize,
}

/// What the passes show.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// The waves that were looked for.
    pub waves: Vec<Measured>,
    /// Forces, following error and numbers of passes.
    pub summary: Summary,
}

impl Learned {
    /// Evaluates pairs of passes, at least four: every second one is held out. `force_step_n` is the resolution of the recorded forces, N.
    #[must_use]
    pub fn of(pairs: &[Pair], plan: &Plan, declared: &Declared, force_step_n: f64) -> Self {
        let fitted: Vec<&Pair> = pairs.iter().step_by(2).collect();
        let held_out: Vec<&Pair> = pairs.iter().skip(1).step_by(2).collect();
        let forces = Forces::new(plan, declared.mass_kg);
        let (of_fit, waves_n) = forces.of(&fitted);
        let (of_others, others_n) = forces.of(&held_out);
        let (between, between_freedom) = forces.variance_between(&fitted);
        let waves = plan.candidates.iter().enumerate().map(|(index, candidate)| {
            let (beside, beside_freedom) = forces.design.noise_beside(&of_fit.residual, candidate);
            let (variance, freedom) =
                if beside >= between { (beside, beside_freedom) } else { (between, between_freedom) };
            let standard_error_n = variance.sqrt();
            Measured {
                candidate: *candidate,
                wave_n: waves_n[index],
                standard_error_n,
                least_n: (standard_errors(freedom, plan.candidates.len()) * standard_error_n)
                    .max(force_step_n),
                held_out_n: others_n[index],
            }
        });
        let waves: Vec<Measured> = waves.collect();
        let rest_n = rms(of_others.residual.iter().copied());
        let rms_n = |left: &dyn Fn(&Measured) -> Wave| {
            (rest_n * rest_n + waves.iter().map(|wave| 0.5 * left(wave).norm_sqr()).sum::<f64>()).sqrt()
        };
        let without = |wave: &Measured| {
            if wave.is_found() { wave.held_out_n - wave.wave_n } else { wave.held_out_n }
        };
        let (before_n, after_n) = (rms_n(&|wave| wave.held_out_n), rms_n(&without));
        let summary = Summary {
            load_n: of_fit.middle,
            load_change_n: of_fit.change,
            friction_n: mean(fitted.iter().map(|pair| friction_n(pair))),
            before_n,
            after_n,
            following_error_um: following_error_um(&held_out),
            fitted_pairs: fitted.len(),
            held_out_pairs: held_out.len(),
        };
        Self { waves, summary }
    }

    /// The waves that were found.
    pub fn found(&self) -> impl Iterator<Item = &Measured> {
        self.waves.iter().filter(|wave| wave.is_found())
    }

    /// Amplitude above which any of the other waves would have been found, N.
    #[must_use]
    pub fn limit_n(&self) -> f64 {
        self.waves.iter().filter(|wave| !wave.is_found()).map(|wave| wave.least_n).fold(0.0, f64::max)
    }
}

/// Amplitude over standard error beyond which noise alone takes any of several waves with the probability [`FALSE_ALARMS`], at least
/// [`LEAST_ERRORS`]. The standard error has some degrees of freedom. Half of the square of amplitude over error is F distributed with 2 and n
/// degrees of freedom, which it exceeds with the probability (1 + 2F/n)^(−n/2).
fn standard_errors(freedom: usize, waves: usize) -> f64 {
    let n = freedom.max(1) as f64;
    let probability = FALSE_ALARMS / waves as f64;
    (n * (libm::pow(probability, -2.0 / n) - 1.0)).sqrt().max(LEAST_ERRORS)
}

fn friction_n(pair: &Pair) -> f64 {
    0.5 * (mean(pair.forward.force_n.iter().copied()) - mean(pair.backward.force_n.iter().copied()))
}

/// Rms of the deviation from the command about its mean in each pass, µm.
fn following_error_um(pairs: &[&Pair]) -> f64 {
    let squares = pairs.iter().flat_map(|pair| [&pair.forward, &pair.backward]).map(|curve| {
        let middle = mean(curve.deviation_m.iter().copied());
        let about = rms(curve.deviation_m.iter().map(|deviation| deviation - middle));
        about * about
    });
    1e6 * mean(squares).sqrt()
}
