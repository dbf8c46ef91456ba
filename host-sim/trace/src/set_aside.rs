//! What no effect of the catalogue is, taken out of a residual so that it does not hide or feign one.
//!
//! A vibration or a spot on the way can be larger than an effect beside it. Once the search has ended and one of them
//! is most of what stays, the search is made again without it: without the samples at that place, or without the part
//! of the residual that swings at that frequency. In the end it is reported as unexplained, with everything it does.

use super::residual::{Evidence, Part};
use super::unexplained::{Curve, Unexplained, Variable};
use model::effects::Stage;

/// A remainder is set aside if its variable explains this share of its power…
const LEAST_SHARE: f64 = 0.3;

/// …and it stands this far above the noise.
const ABOVE_NOISE: f64 = 2.0;

/// A place is where the curve is farther from its median than this share of the farthest.
const EDGE: f64 = 0.02;

/// A place that holds more of the travel than this is none.
const WIDEST: f64 = 0.6;

/// Something in one stage's residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aside {
    stage: Stage,
    what: What,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// Samples of the axis between two places, mm.
    Place { from_mm: f64, to_mm: f64 },
    /// A swing, with amplitude and phase of its own in each log.
    Tone { frequency_hz: f64 },
}

impl Aside {
    /// What may be set aside of the remainder of a stage, told by what it follows.
    #[must_use]
    pub fn of(evidence: &Evidence<'_>, rest: &Unexplained, noise: f64, parts: &[Part]) -> Option<Self> {
        let of_structure = matches!(rest.channel, Stage::Table | Stage::Tool);
        if !of_structure || rest.share_percent < 100.0 * LEAST_SHARE || rest.rms < ABOVE_NOISE * noise {
            return None;
        }
        let what = match rest.variable {
            Variable::Time => What::Tone { frequency_hz: rest.frequency_hz? },
            Variable::Position => {
                let parts: Vec<&Part> = parts.iter().filter(|part| part.stage == rest.channel).collect();
                let [from_mm, to_mm] = Curve::of(evidence, &parts, Variable::Position)?.spot(EDGE, WIDEST)?;
                What::Place { from_mm, to_mm }
            }
            _ => return None,
        };
        Some(Self { stage: rest.channel, what })
    }

    /// Whether a sample is left out for it.
    #[must_use]
    pub fn covers(&self, evidence: &Evidence<'_>, stage: Stage, log: usize, sample: usize) -> bool {
        let What::Place { from_mm, to_mm } = self.what else { return false };
        let place = || {
            let axis = &evidence.logs[log].axes[evidence.axis];
            axis.table_or_motor().and_then(|signal| signal.position.get(sample)).map(|m| 1e3 * m)
        };
        self.stage == stage && place().is_some_and(|mm| (from_mm..to_mm).contains(&mm))
    }
}

/// Takes out of a residual what swings at the frequencies that were set aside.
pub fn take_out(evidence: &Evidence<'_>, part: &mut Part) {
    for aside in evidence.aside.iter().filter(|aside| aside.stage == part.stage) {
        let What::Tone { frequency_hz } = aside.what else { continue };
        let turn = std::f64::consts::TAU * frequency_hz * evidence.logs[part.log].sample_s;
        let counts: Vec<bool> = (0..part.values.len()).map(evidence.counting(part.stage, part.log)).collect();
        let waves = || counts.iter().enumerate().map(|(i, counts)| (*counts, (turn * i as f64).sin_cos()));
        let mut sums = [0.0; 5];
        for ((counts, (sin, cos)), value) in waves().zip(&part.values) {
            if counts {
                let terms = [cos * cos, sin * cos, sin * sin, cos * value, sin * value];
                sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
            }
        }
        let [cc, sc, ss, cv, sv] = sums;
        let determinant = cc * ss - sc * sc;
        if determinant <= 0.0 {
            continue;
        }
        let (a, b) = ((ss * cv - sc * sv) / determinant, (cc * sv - sc * cv) / determinant);
        for ((counts, (sin, cos)), value) in waves().zip(&mut part.values) {
            if counts {
                *value -= a * cos + b * sin;
            }
        }
    }
}
