//! Samples at which the direction of an axis is not known.

use std::ops::Range;

use crate::input::smoothing::Smooth;

/// Speeds between rest and motion, m/s. At such a speed it is not known which direction counts, as friction holds the axis by its
/// springs.
const CREEPING_M_PER_S: Range<f64> = 2e-5..1e-3;

/// Whether the filter's window around each sample contains a reversal: a speed between rest and motion, or two samples of
/// different directions. A residual that jumps there depends on when within the window it does.
#[must_use]
pub fn near_reversals(motion: &Smooth) -> Vec<bool> {
    let velocity = &motion.velocity;
    let reverses = |sample: usize| {
        let [before, now] = [sample.saturating_sub(1), sample].map(|sample| direction(velocity[sample]));
        CREEPING_M_PER_S.contains(&velocity[sample].abs()) || before != now
    };
    let mut near = vec![false; velocity.len()];
    for sample in (0..velocity.len()).filter(|&sample| reverses(sample)) {
        let first = sample.saturating_sub(motion.half_window());
        let end = (sample + motion.half_window() + 1).min(near.len());
        near[first..end].fill(true);
    }
    near
}

/// −1, 0 or 1.
fn direction(m_per_s: f64) -> i8 {
    i8::from(m_per_s > 0.0) - i8::from(m_per_s < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.1 mm a sample forwards, then back: the two samples around the reversal move, and the windows of 11 samples of five samples before and
    /// after them contain it.
    #[test]
    fn a_reversal_reaches_as_far_as_the_window_of_the_filter() {
        const SAMPLE_S: f64 = 1e-3;
        let raw: Vec<f64> = (0..100_i32).map(|i| 1e-4 * f64::from(50 - (i - 50).abs())).collect();
        let motion = Smooth::new(raw, SAMPLE_S, 5);
        let near = near_reversals(&motion);
        let (first, last) = (near.iter().position(|near| *near), near.iter().rposition(|near| *near));
        // The filtered velocity is zero at sample 50.
        assert!(matches!(first, Some(44 | 45)) && matches!(last, Some(55 | 56)), "{first:?} {last:?}");
        assert!(near[45..=55].iter().all(|near| *near));
        let steady = Smooth::new((0..100_i32).map(|i| 1e-4 * f64::from(i)).collect(), SAMPLE_S, 5);
        assert!(near_reversals(&steady).iter().all(|near| !near));
    }
}
