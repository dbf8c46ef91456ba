//! The measured shape of a spike, beside the one that was fitted.
//!
//! The residual and the fitted spike are added and averaged over all reversals of an axis, outwards, over the angle since the reversal.
//! Where the highest mean is above the fitted height by more than its noise explains, no fitted shape is that of the spike: the height is
//! then the measured one, and the interval contains both.

use std::f64::consts::PI;

use super::builder::Builder;
use super::part::{Detail, OTHER_SHAPE, Part};
use super::samples::{Observed, radial};
use super::term::Term;

/// Angle of a mean, rad, and number of means.
const BIN_RAD: f64 = 0.25 * PI / 180.0;
const BINS: usize = 80;

/// Smallest excess of the highest mean over the fitted height: in standard errors, and as a fraction of the height.
const MIN_ERRORS: f64 = 5.0;
const MIN_FRACTION: f64 = 0.05;

/// Replaces the height of a spike where no fitted shape reaches it.
pub(crate) fn correct(builder: &Builder<'_>, part: &mut Part) {
    let Some((Term::Spike(axis, ..), height)) = part.terms.first().copied() else { return };
    let Some((measured, error)) = highest(builder, part.terms[0], axis) else { return };
    let excess = measured - height.abs();
    if excess < MIN_ERRORS * error || excess < MIN_FRACTION * height.abs() {
        return;
    }
    part.ci95 = [part.ci95[0].min(measured - 1.96 * error), part.ci95[1].max(measured + 1.96 * error)];
    part.um = measured;
    part.shape = Some(OTHER_SHAPE);
    if let Some(signed) = part.details.iter_mut().find(|detail| detail.key == "signed_um") {
        *signed = Detail { value: measured * height.signum(), ..*signed };
    }
}

/// The highest mean in the direction of the fitted spike, and its standard error, µm.
fn highest(builder: &Builder<'_>, spike: (Term, f64), axis: usize) -> Option<(f64, f64)> {
    let samples = builder.samples;
    let (first, _) = samples.seen(axis);
    let residual = &builder.fitted.fit.residual;
    let mut sums = vec![(0.0, 0.0, 0_usize); BINS];
    for (i, at) in samples.instants.iter().enumerate() {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of bins")]
        let bin = (at.since_reversal(axis) / BIN_RAD) as usize;
        let Some(sum) = sums.get_mut(bin) else { continue };
        let displacement = spike.0.displacement(at, samples.radius_mm).map(|value| spike.1 * value);
        // Outwards; near its reversals an axis is along the radius.
        let (fitted, outwards) = match samples.observed {
            Observed::Both(_) => (displacement[axis], at.position[axis].signum()),
            Observed::Radial(_) => (radial(at, displacement), 1.0),
        };
        let value = outwards * spike.1.signum() * (residual[first + i] + fitted);
        *sum = (sum.0 + value, sum.1 + value * value, sum.2 + 1);
    }
    let of_bin = |(sum, square, count): &(f64, f64, usize)| {
        let n = *count as f64;
        let mean = sum / n;
        let variance = (square / n - mean * mean).max(0.0);
        (*count >= 4).then(|| (mean, (variance / n).sqrt()))
    };
    sums.iter().filter_map(of_bin).max_by(|a, b| a.0.total_cmp(&b.0))
}
