//! The budget of a motion.

use commissioning::compensate::prediction::{PredictionError, TestMotion};
use files::format::significant;
use model::machine::Machine;
use model::machine::evidence::Certainty;

use crate::cause::Cause;
use crate::interval;
use crate::radial::RadialDeviation;
use crate::remedy;
use crate::share::{Measured, shares, signed_root};
use crate::simulation::{AloneAndWithout, Outcome, Simulated};
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
    /// That with a compensation of everything that the model gives reason for; `None`: it gives none, or it was not simulated.
    pub compensated: Option<Sizes>,
    /// Why it was not simulated with a compensation.
    pub not_compensated: Option<String>,
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
    /// Its share where everything is compensated; `None`: see [`MotionBudget::compensated`].
    pub compensated: Option<Sizes>,
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
    /// The budget of a motion, without and with a compensation of its causes.
    ///
    /// # Errors
    /// If the motion does not fit the machine, or the machine does not complete it without a compensation.
    pub fn of(model: &Machine, test: &TestMotion, seed: u64) -> Result<Self, PredictionError> {
        let simulated = Simulated { model, seed, is_compensated: false };
        let causes = Cause::all(model);
        let before = Shared::of(&simulated, test, &causes)?;
        let (after, not_compensated) = match Shared::compensated(&simulated, test, &causes) {
            Ok(after) => (after, None),
            Err(error) => (None, Some(error.to_string())),
        };
        let mut listed: Vec<CauseShare> = causes
            .iter()
            .enumerate()
            .zip(before.causes)
            .map(|((index, cause), (one, share))| {
                let evidence = cause.evidence(model);
                CauseShare {
                    name: cause.name(model),
                    axis: cause.axis(model).map(str::to_owned),
                    share,
                    interval_um: interval::of(cause, model).map(|relative| around(share.rms, relative)),
                    alone: one.alone,
                    without: one.without.sizes,
                    compensated: after.as_ref().map(|after| after.causes[index].1),
                    circle_without: one.without.circle,
                    certainty: evidence.map_or(Certainty::Declared, |evidence| evidence.certainty),
                    rivals: evidence.map(|evidence| evidence.rivals.clone()).unwrap_or_default(),
                    remedy: remedy::of(cause, model),
                }
            })
            .collect();
        listed.sort_by(|a, b| b.share.rms.abs().total_cmp(&a.share.rms.abs()));
        Ok(Self {
            name: test.motion.name.clone(),
            whole: before.whole.sizes,
            compensated: after.map(|after| after.whole.sizes),
            not_compensated,
            circle: before.whole.circle,
            causes: listed,
            shared_in_proportion: before.in_proportion,
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

/// The shares of the causes in the contour error of a motion.
struct Shared {
    whole: Outcome,
    /// In the order of the causes.
    causes: Vec<(AloneAndWithout, Sizes)>,
    /// Part of the mean square that was shared in proportion.
    in_proportion: f64,
}

impl Shared {
    fn of(simulated: &Simulated<'_>, test: &TestMotion, causes: &[Cause]) -> Result<Self, PredictionError> {
        let (whole, each) = simulated.outcomes(test, causes)?;
        let measured: Vec<Measured> = each
            .iter()
            .map(|one| Measured { alone: one.alone.rms.powi(2), without: one.without.sizes.rms.powi(2) })
            .collect();
        let (squares, in_proportion) = shares(whole.sizes.rms.powi(2), &measured);
        let share = |(one, square): (AloneAndWithout, f64)| {
            let gone = whole.sizes.combined(one.without.sizes, |whole, without| whole - without);
            let mean = one.alone.combined(gone, |alone, gone| 0.5 * (alone + gone));
            (one, Sizes { rms: signed_root(square), ..mean })
        };
        let causes = each.into_iter().zip(squares).map(share).collect();
        Ok(Self { whole, causes, in_proportion })
    }

    /// The shares where those of the causes that act are compensated; `None`: the model gives no reason for a compensation.
    fn compensated(
        simulated: &Simulated<'_>,
        test: &TestMotion,
        causes: &[Cause],
    ) -> Result<Option<Self>, PredictionError> {
        let simulated = Simulated { is_compensated: true, ..*simulated };
        let has_any = simulated.compensation(simulated.model, test, causes)?.is_some();
        has_any.then(|| Self::of(&simulated, test, causes)).transpose()
    }
}

/// The interval of a value with a relative half width, in ascending order.
fn around(value: f64, relative: f64) -> [f64; 2] {
    let half = (value * relative).abs();
    [value - half, value + half]
}
