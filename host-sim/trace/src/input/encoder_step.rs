//! The step of an encoder, from its readings.

/// Smallest share of the differences between successive readings that are whole numbers of steps. The others are those of readings
/// that were replaced.
const MIN_WHOLE: f64 = 0.8;

/// Largest deviation from a whole number of steps.
const MAX_DEVIATION: f64 = 0.1;

/// Differences are the same if they differ relatively by less: the rounding of decimal numbers.
const SAME: f64 = 1e-6;

/// Smallest number of differences that are the same, if they are a step.
const MIN_SAME: usize = 3;

/// Number of sets of equal differences that are tried, the smallest first.
const TRIED: usize = 20;

/// Number of readings, from the first on, that are looked at.
const MAX_READINGS: usize = 400_000;

/// The step of which nearly all differences between successive readings are whole multiples. `None` if there is none, or if it is so
/// small compared with the motion from reading to reading that hardly any difference is one step. At constant
/// speed differences are equal, too, but those of a start or a stop are no multiples of them.
#[must_use]
pub fn encoder_step(values: &[f64]) -> Option<f64> {
    let values = &values[..values.len().min(MAX_READINGS)];
    let greatest = values.iter().fold(0.0, |greatest: f64, value| greatest.max(value.abs()));
    let differences = values.windows(2).map(|two| (two[1] - two[0]).abs());
    // Smaller differences are rounding errors of the computation.
    let mut differences: Vec<f64> = differences.filter(|difference| *difference > 1e-10 * greatest).collect();
    differences.sort_unstable_by(f64::total_cmp);
    let is_step = |step: f64| {
        let is_whole =
            |difference: &&f64| (*difference / step - (*difference / step).round()).abs() < MAX_DEVIATION;
        let whole = differences.iter().filter(is_whole).count();
        let has_several = differences.last().is_some_and(|greatest| *greatest > 2.5 * step);
        has_several && whole as f64 >= MIN_WHOLE * differences.len() as f64
    };
    let same = differences.chunk_by(|a, b| b - a <= SAME * b).filter(|same| same.len() >= MIN_SAME);
    same.take(TRIED).filter_map(|same| same.first().copied()).find(|step| is_step(*step))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 5 s of an oscillation with 60 µm from reading to reading at most, in steps of `step_mm`.
    fn readings(step_mm: f64) -> Vec<f64> {
        let at = |i: i32| 20.0 * (3e-3 * f64::from(i)).sin();
        (0..5000).map(|i| (at(i) / step_mm).round() * step_mm).collect()
    }

    #[test]
    fn the_step_is_found_beside_replaced_readings() {
        let mut readings = readings(1e-3);
        for i in (20..5000).step_by(50) {
            readings[i] += 0.3e-3;
        }
        assert!((encoder_step(&readings).unwrap() / 1e-3 - 1.0).abs() < 1e-5);
    }

    /// The differences of up to 60 µm are spread over 6,000 steps of 10 nm: too few are a single step. Nothing else is one.
    #[test]
    fn a_fine_step_is_found_or_none() {
        assert!(encoder_step(&readings(1e-5)).is_none_or(|step_mm| (step_mm / 1e-5 - 1.0).abs() < 1e-3));
    }

    /// An axis that starts, moves at 42 µm from reading to reading, and stops: not in steps of 42 µm. At constant speed alone, nothing
    /// shows the step.
    #[test]
    fn a_constant_speed_is_no_step() {
        let ramp = |i: i32| if i < 100 { 0.42e-3 * f64::from(i) } else { 42e-3 };
        let speeds = (0..2000).map(|i| ramp(i.min(2000 - i)));
        let mut position = 0.0;
        let readings: Vec<f64> = speeds
            .map(|speed| {
                position += speed;
                position
            })
            .collect();
        assert!(encoder_step(&readings).is_none_or(|step_mm| step_mm < 0.43e-3));
        let steady: Vec<f64> = (0..2000).map(|i| 42e-3 * f64::from(i)).collect();
        assert_eq!(encoder_step(&steady), None);
        assert_eq!(encoder_step(&[1.0, 1.0]), None);
    }
}
