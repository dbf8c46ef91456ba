//! The ratio of the motions of two channels.

use super::channels::thinned;

/// Ratio of the motion of one channel to that of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Median of the ratios of the increments.
    pub factor: f64,
    /// Median deviation of the ratios from `factor`, as a fraction of it.
    pub spread: f64,
}

impl Ratio {
    /// The ratio with the channels exchanged.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { factor: 1.0 / self.factor, ..self }
    }
}

/// Durations of an increment, s: long enough that noise does not matter, and shorter than the time between two reversals.
/// The longer ones are used if the axis moves slowly.
const INCREMENTS_S: [f64; 3] = [0.02, 0.1, 0.5];
/// Lags of a closed loop that are tried, s.
const LAGS_S: [f64; 7] = [0.004, 0.008, 0.012, 0.018, 0.025, 0.035, 0.05];
/// Spread up to which no lag is looked for.
const IN_PHASE: f64 = 0.02;
/// Smallest increment that counts, mm or degrees; at smaller ones backlash and wind-up are a part of the motion.
const MIN_INCREMENT: f64 = 0.05;
/// Smallest increment that counts, as a fraction of the large ones.
const MIN_FRACTION: f64 = 0.3;
/// Smallest number of increments.
const MIN_COUNT: usize = 40;

/// The ratio of the increments of `values` to those of `reference`, which medians make insensitive to slips, spikes and
/// repeated samples. `None` if the reference moves too little.
#[must_use]
pub fn ratio(values: &[f64], reference: &[f64], sample_s: f64) -> Option<Ratio> {
    let (values, reference) = (&*thinned(values), &*thinned(reference));
    INCREMENTS_S.into_iter().find_map(|increment_s| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let step = (increment_s / sample_s).round().max(1.0) as usize;
        ratio_of_increments(values, reference, step)
    })
}

/// The ratio of the motion of a command to that of a sensor that follows it with an unknown lag.
#[must_use]
pub fn ratio_to_follower(command: &[f64], follower: &[f64], sample_s: f64) -> Option<Ratio> {
    if let Some(in_phase) = ratio(command, follower, sample_s).filter(|ratio| ratio.spread < IN_PHASE) {
        return Some(in_phase);
    }
    let lags = LAGS_S.into_iter().filter_map(|lag_s| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few samples")]
        let lag = (lag_s / sample_s).round() as usize;
        ratio(command.get(..command.len().checked_sub(lag)?)?, follower.get(lag..)?, sample_s)
    });
    lags.min_by(|a, b| a.spread.total_cmp(&b.spread))
}

fn ratio_of_increments(values: &[f64], reference: &[f64], step: usize) -> Option<Ratio> {
    let increments = |values: &[f64]| -> Vec<f64> {
        let ends = (step..values.len()).step_by(step.div_ceil(4));
        ends.map(|end| values[end] - values[end - step]).collect()
    };
    let (own, reference) = (increments(values), increments(reference));
    let sizes: Vec<f64> = reference.iter().map(|increment| increment.abs()).collect();
    let min = (MIN_FRACTION * numerics::quantile(&sizes, 0.95)).max(MIN_INCREMENT);
    let pairs = own.iter().zip(&reference).filter(|(_, reference)| reference.abs() >= min);
    let ratios: Vec<f64> = pairs.map(|(own, reference)| own / reference).collect();
    if ratios.len() < MIN_COUNT {
        return None;
    }
    let factor = numerics::median(&ratios)?;
    let deviations: Vec<f64> = ratios.iter().map(|ratio| (ratio - factor).abs()).collect();
    Some(Ratio { factor, spread: numerics::median(&deviations)? / factor.abs().max(f64::MIN_POSITIVE) })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(phase: f64) -> Vec<f64> {
        (0..4000).map(|i| 30.0 * (4e-3 * f64::from(i) + phase).sin()).collect()
    }

    #[test]
    fn a_factor_is_found_beside_a_slip_and_not_between_unrelated_motions() {
        let mut values: Vec<f64> = sine(0.0).iter().map(|mm| 7.0 - 25.4 * mm).collect();
        values[1000..].iter_mut().for_each(|mm| *mm += 10.0);
        let found = ratio(&values, &sine(0.0), 1e-3).unwrap();
        assert!((found.factor + 25.4).abs() < 1e-6 && found.spread < 1e-6, "{found:?}");
        // A quarter of a period: ratios of a tangent, whose median deviation is its own size.
        assert!(ratio(&sine(1.57), &sine(0.0), 1e-3).unwrap().spread > 0.5);
        assert_eq!(ratio(&sine(0.0), &vec![5.0; 4000], 1e-3), None);
    }
}
