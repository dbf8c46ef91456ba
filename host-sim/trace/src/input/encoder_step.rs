//! The step of an encoder, from its readings.

use crate::data_faults::channels::thinned;

/// Smallest share of the differences between successive readings that are the same, if these are steps of an encoder.
const MIN_SHARE: f64 = 0.01;

/// Differences are the same if they differ relatively by less: the rounding of numbers in units of an encoder.
const SAME: f64 = 1e-6;

/// The smallest difference between successive readings that occurs often. Single smaller ones are those of readings that were
/// replaced. `None` if no difference occurs often: the steps, if any, are small compared with the motion from reading to reading.
#[must_use]
pub fn encoder_step(values: &[f64]) -> Option<f64> {
    let values = thinned(values);
    let differences = values.windows(2).map(|two| (two[1] - two[0]).abs());
    let greatest = values.iter().fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
    // Smaller differences are rounding errors of the computation.
    let mut differences: Vec<f64> = differences.filter(|difference| *difference > 1e-12 * greatest).collect();
    differences.sort_unstable_by(f64::total_cmp);
    let often = (MIN_SHARE * differences.len() as f64).ceil().max(2.0);
    let mut same = differences.chunk_by(|a, b| b - a <= SAME * b);
    same.find(|same| same.len() as f64 >= often).and_then(|same| same.first().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 5 s of an oscillation with 60 µm from reading to reading at most, in steps of `step_mm`.
    fn readings(step_mm: f64) -> Vec<f64> {
        (0..5000)
            .map(|i| 20.0 * (3e-3 * f64::from(i)).sin())
            .map(|mm| (mm / step_mm).round() * step_mm)
            .collect()
    }

    #[test]
    fn the_step_is_found_beside_replaced_readings() {
        let mut readings = readings(1e-3);
        for i in (20..5000).step_by(100) {
            readings[i] += 1e-4 * (f64::from(i as u32)).sin();
        }
        assert!((encoder_step(&readings).unwrap() / 1e-3 - 1.0).abs() < 1e-5);
    }

    /// The differences of 60 µm are spread over 6,000 steps of 10 nm, of which none is taken by one in a hundred.
    #[test]
    fn a_fine_encoder_has_no_visible_step() {
        assert_eq!(encoder_step(&readings(1e-5)), None);
        assert_eq!(encoder_step(&[1.0, 1.0]), None);
    }
}
