//! Replacement of samples by means of another channel.

use std::ops::Range;

/// Replaces samples of `values` by the motion of a reference, with the difference between both interpolated linearly from the
/// last sample before to the first sample after them. Without a reference, the values are interpolated themselves. At an
/// end of the log the difference is constant.
pub fn bridge(values: &mut [f64], reference: Option<&[f64]>, samples: &Range<usize>) {
    let motion = |sample: usize| reference.map_or(0.0, |reference| reference[sample]);
    let before = samples.start.checked_sub(1).map(|sample| values[sample] - motion(sample));
    let after = values.get(samples.end).map(|value| value - motion(samples.end));
    let [first, last] = match (before, after) {
        (Some(before), Some(after)) => [before, after],
        (Some(only), None) | (None, Some(only)) => [only, only],
        (None, None) => return,
    };
    let count = (samples.len() + 1) as f64;
    for (number, sample) in samples.clone().enumerate() {
        let fraction = (number + 1) as f64 / count;
        values[sample] = motion(sample) + first + fraction * (last - first);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_of_the_reference_is_restored() {
        // Table = motor² plus a difference that is linear over the samples: restored exactly.
        let motor: Vec<f64> = (0..50).map(|i| f64::from(i * i)).collect();
        let table: Vec<f64> = motor.iter().zip(0..).map(|(m, i)| m + 0.5 * f64::from(i)).collect();
        let mut broken = table.clone();
        broken[20..30].fill(7.0);
        bridge(&mut broken, Some(&motor), &(20..30));
        assert!(broken.iter().zip(&table).all(|(a, b)| (a - b).abs() < 1e-9));
        // At the end the last difference is kept: 0.5 × 44.
        bridge(&mut broken, Some(&motor), &(45..50));
        assert!((broken[49] - (motor[49] + 22.0)).abs() < 1e-9);
        // Without a reference, a straight line.
        let mut line = vec![0.0, 9.0, 9.0, 3.0];
        bridge(&mut line, None, &(1..3));
        assert_eq!(line, [0.0, 1.0, 2.0, 3.0]);
    }
}
