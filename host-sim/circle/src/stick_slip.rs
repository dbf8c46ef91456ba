//! Stick-slip: irregular steps while an axis is slow, near its reversals.
//!
//! The residual of an axis less its mean over one degree is compared near its reversals and elsewhere. If it is larger there, over most of
//! the angle, there is something that no smooth curve, wave or vibration describes. A sawtooth of height A has the standard deviation
//! A/√12, so that A follows from the difference of the variances.

use std::f64::consts::PI;

use super::builder::{self, Builder, Estimate};
use super::part::{Name, Part};

/// Angle before and after a reversal, in bins of [`BIN_RAD`].
const BIN_RAD: f64 = PI / 180.0;
const NEAR_BINS: usize = 10;

/// Smallest ratio of the standard deviations in a bin, and smallest number of such bins.
const MIN_RATIO: f64 = 1.6;
const MIN_BINS: usize = 4;

/// Smallest number of samples in a bin.
const MIN_SAMPLES: usize = 40;

/// Stick-slip of each axis.
pub(crate) fn parts(builder: &Builder<'_>) -> Vec<Part> {
    (0..2).filter_map(|axis| part(builder, axis)).collect()
}

fn part(builder: &Builder<'_>, axis: usize) -> Option<Part> {
    let samples = builder.samples;
    let fine = fine_residual(builder, axis);
    let mut near = [(0.0, 0_usize); NEAR_BINS];
    let mut far = (0.0, 0_usize);
    for (value, at) in fine.iter().zip(&samples.instants) {
        // An axis is only seen in a radius near its own reversals.
        let since = at.since_reversal(axis);
        let distance = since.min(PI - since);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to 90")]
        let bin = (distance / BIN_RAD) as usize;
        let (sum, count) = near.get_mut(bin).unwrap_or(&mut far);
        (*sum, *count) = (*sum + value * value, *count + 1);
    }
    let far = far.0 / far.1.max(1) as f64;
    let is_louder = |(sum, count): &&(f64, usize)| {
        *count >= MIN_SAMPLES && sum / *count as f64 > MIN_RATIO * MIN_RATIO * far
    };
    // From the reversal outwards, without a gap: the axis is slow there.
    let louder: Vec<&(f64, usize)> = near.iter().skip(1).take_while(|bin| is_louder(bin)).collect();
    if louder.len() < MIN_BINS {
        return None;
    }
    let (sum, count) = louder.iter().fold((0.0, 0), |(s, c), (sum, count)| (s + sum, c + count));
    let variance = sum / count as f64 - far;
    let um = (12.0 * variance).sqrt();
    // Steps are independent of each other, samples are not: about one step a tenth of a degree.
    let steps = (louder.len() as f64 * BIN_RAD / (0.1 * BIN_RAD)).max(1.0);
    let range = Estimate { value: um, error: um / (2.0 * steps).sqrt() };
    Some(builder::part(Name::StickSlip, builder.measured.axes[axis].clone(), Vec::new(), range))
}

/// Residual of an axis less its mean over one degree, µm.
fn fine_residual(builder: &Builder<'_>, axis: usize) -> Vec<f64> {
    let samples = builder.samples;
    let (first, _) = samples.seen(axis);
    let residual = &builder.fitted.fit.residual;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples")]
    let half = ((0.5 * BIN_RAD / samples.step_rad().max(1e-9)).round() as usize).max(1);
    let mut fine = vec![0.0; samples.instants.len()];
    for arc in &samples.arcs {
        let mut sums = vec![0.0];
        for i in arc.clone() {
            sums.push(sums[sums.len() - 1] + residual[first + i]);
        }
        for i in 0..arc.len() {
            let (from, to) = (i.saturating_sub(half), (i + half + 1).min(arc.len()));
            let mean = (sums[to] - sums[from]) / (to - from) as f64;
            fine[arc.start + i] = residual[first + arc.start + i] - mean;
        }
    }
    fine
}
