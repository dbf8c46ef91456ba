//! The budget of a motion.

use commissioning::compensate::prediction::{PredictionError, TestMotion};
use files::format::significant;
use model::machine::evidence::Certainty;

use crate::cause::Cause;
use crate::interval;
use crate::radial::RadialDeviation;
use crate::remedy;
use crate::share::{Measured, shares, signed_root};
use crate::simulation::Simulated;
use crate::sizes::Sizes;

/// Part of the whole below which a cause is not listed for a reader.
const LEAST_SHOWN: f64 = 0.01;

/// What each cause costs on a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionBudget {
    /// Name of the motion.
    pub name: String,
    /// The contour error with all causes.
    pub whole: Sizes,
    /// The radial deviation with all causes, if the motion is a circle.
    pub circle: Option<RadialDeviation>,
    /// The causes, largest first.
    pub causes: Vec<CauseShare>,
    /// Part of the mean square that the displacements of the causes do not add up to, which is shared in proportion.
    pub shared_in_proportion: f64,
}

/// The share of a cause.
#[derive(Clone, Debug, PartialEq)]
pub struct CauseShare {
    /// Name of the effect, or of a part of the declared model.
    pub name: &'static str,
    /// Name of its axis; `None`: all axes together.
    pub axis: Option<String>,
    /// Its share: the squares of `rms`, with their signs, add up to that of the whole; the other figures are the mean of what it makes
    /// alone and what goes away without it. Below zero: it makes others smaller.
    pub share: Sizes,
    /// 95 % confidence interval of the share's rms, µm, from that of its values; `None`: none is known.
    pub interval_um: Option<[f64; 2]>,
    /// The contour error with this cause alone.
    pub alone: Sizes,
    /// The contour error with all causes but this one.
    pub without: Sizes,
    /// The radial deviation with all causes but this one, if the motion is a circle.
    pub circle_without: Option<RadialDeviation>,
    /// Whether the cause is a fact.
    pub certainty: Certainty,
    /// What else may be the cause.
    pub rivals: Vec<String>,
    /// What to do about it.
    pub remedy: String,
}

impl MotionBudget {
    /// The budget of a motion.
    ///
    /// # Errors
    /// If the motion does not fit the machine, or the machine does not complete it.
    pub fn of(simulated: &Simulated<'_>, test: &TestMotion) -> Result<Self, PredictionError> {
        let causes = Cause::all(simulated.model);
        let (whole, each) = simulated.outcomes(test, &causes)?;
        let measured: Vec<Measured> = each
            .iter()
            .map(|one| Measured { alone: one.alone.rms.powi(2), without: one.without.sizes.rms.powi(2) })
            .collect();
        let (squares, shared_in_proportion) = shares(whole.sizes.rms.powi(2), &measured);
        let mut causes: Vec<CauseShare> = causes
            .iter()
            .zip(each)
            .zip(squares)
            .map(|((cause, one), square)| {
                let gone = whole.sizes.combined(one.without.sizes, |whole, without| whole - without);
                let mean = one.alone.combined(gone, |alone, gone| 0.5 * (alone + gone));
                let share = Sizes { rms: signed_root(square), ..mean };
                let machine = simulated.model;
                let evidence = cause.evidence(machine);
                CauseShare {
                    name: cause.name(machine),
                    axis: cause.axis(machine).map(str::to_owned),
                    share,
                    interval_um: interval::of(cause, machine).map(|relative| around(share.rms, relative)),
                    alone: one.alone,
                    without: one.without.sizes,
                    circle_without: one.without.circle,
                    certainty: evidence.map_or(Certainty::Declared, |evidence| evidence.certainty),
                    rivals: evidence.map(|evidence| evidence.rivals.clone()).unwrap_or_default(),
                    remedy: remedy::of(cause, machine),
                }
            })
            .collect();
        causes.sort_by(|a, b| b.share.rms.abs().total_cmp(&a.share.rms.abs()));
        Ok(Self {
            name: test.motion.name.clone(),
            whole: whole.sizes,
            circle: whole.circle,
            causes,
            shared_in_proportion,
        })
    }

    /// The causes of at least a hundredth of the whole, and a sentence on the others, if there are any.
    #[must_use]
    pub fn shown(&self) -> (Vec<&CauseShare>, Option<String>) {
        let least_um = LEAST_SHOWN * self.whole.rms;
        let shown: Vec<&CauseShare> =
            self.causes.iter().filter(|cause| cause.share.rms.abs() >= least_um).collect();
        let hidden = self.causes.len() - shown.len();
        (shown, (hidden > 0).then(|| format!("{hidden} more below {} µm.", significant(least_um, 2))))
    }

    /// Relative half width of the 95 % interval of the whole: that of the simulation, and those of the causes that have one.
    #[must_use]
    pub fn relative_uncertainty(&self) -> f64 {
        let square = self.whole.rms.powi(2);
        if square <= 0.0 {
            return interval::OF_SIMULATION;
        }
        // The square of the whole is the sum of the shares' squares with their signs: it varies by 2·share times the variation of each.
        let of_cause =
            |cause: &CauseShare| cause.interval_um.map(|[from, to]| cause.share.rms * 0.5 * (to - from));
        let variation =
            self.causes.iter().filter_map(of_cause).map(|product| product.powi(2)).sum::<f64>().sqrt();
        libm::hypot(variation / square, interval::OF_SIMULATION)
    }

    /// Rms of the sum of the shares, µm.
    #[must_use]
    pub fn sum_um(&self) -> f64 {
        let squares = self.causes.iter().map(|cause| cause.share.rms * cause.share.rms.abs());
        signed_root(squares.sum())
    }
}

/// The interval of a value with a relative half width, in ascending order.
fn around(value: f64, relative: f64) -> [f64; 2] {
    let half = (value * relative).abs();
    [value - half, value + half]
}
