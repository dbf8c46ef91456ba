//! Check that the times of a log are those of a uniform clock, and computation of its period.

/// Maximum deviation of a step between two samples from the median step, as a fraction of it.
const STEP_TOLERANCE: f64 = 0.01;
/// Maximum deviation of a sample from the uniform grid through first and last sample, in samples.
const GRID_TOLERANCE: f64 = 0.1;
/// Maximum deviation of a step that is attributed to rounding of printed times, as a fraction of the median step. Larger
/// deviations cannot be distinguished from a lost sample.
const MAX_ROUNDING: f64 = 0.4;
/// Minimum number of deviating steps that are attributed to rounding, which recurs, in contrast to a jump.
const MIN_ROUNDED_STEPS: usize = 3;

/// A sample whose time is not that of a uniform clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Irregular {
    /// Index of the sample.
    pub sample: usize,
    /// Time of this sample on a uniform clock.
    pub expected_s: f64,
    /// Whether the time is not greater than that of the previous sample.
    pub is_backward: bool,
}

/// The period (s) of the clock from its times, which were printed with `decimals` decimals. At least two times are required.
pub(super) fn sample_time_s(times_s: &[f64], decimals: usize) -> Result<f64, Irregular> {
    let steps: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let median_s = numerics::median(&steps).unwrap_or_default();
    let irregular = |step: usize, is_backward| Irregular {
        sample: step + 1,
        expected_s: times_s[step] + median_s.max(0.0),
        is_backward,
    };
    if let Some(step) = steps.iter().position(|&step_s| step_s <= 0.0) {
        return Err(irregular(step, true));
    }
    let tolerance_s = STEP_TOLERANCE * median_s;
    let deviates = |step_s: &f64, tolerance_s: f64| (step_s - median_s).abs() > tolerance_s;
    let is_rounded = steps.iter().filter(|step| deviates(step, tolerance_s)).count() >= MIN_ROUNDED_STEPS;
    let resolution_s = libm::pow(0.1_f64, decimals as f64);
    let rounding_s = if is_rounded { resolution_s.min(MAX_ROUNDING * median_s) } else { 0.0 };
    if let Some(step) = steps.iter().position(|step| deviates(step, tolerance_s + rounding_s)) {
        return Err(irregular(step, false));
    }
    grid_period_s(times_s, rounding_s)
}

/// The period from first and last sample, if all samples are on its grid, as small deviations of steps may accumulate.
fn grid_period_s(times_s: &[f64], rounding_s: f64) -> Result<f64, Irregular> {
    let last = times_s.len() - 1;
    let period_s = (times_s[last] - times_s[0]) / last as f64;
    let grid = |sample: usize| times_s[0] + sample as f64 * period_s;
    let tolerance_s = GRID_TOLERANCE * period_s + rounding_s;
    match (0..=last).find(|&i| (times_s[i] - grid(i)).abs() > tolerance_s) {
        Some(sample) => Err(Irregular { sample, expected_s: grid(sample), is_backward: false }),
        None => Ok(period_s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times of a clock, rounded like those of a file.
    fn printed(start_s: f64, period_s: f64, count: u32, decimals: usize) -> Vec<f64> {
        let unit = 10_f64.powf(decimals as f64);
        let time = |i: u32| ((start_s + f64::from(i) * period_s) * unit).round() / unit;
        (0..count).map(time).collect()
    }

    #[test]
    fn the_period_is_found_from_rounded_times() {
        let clocks = [
            (0.0, 1e-3, 3),
            (122.315, 1e-3, 3),
            (1.7e9, 1e-3, 6),
            (0.0, 1.0 / 3e3, 4),
            (0.0, 1.0 / 4096.0, 6),
            (0.0, 1.0003e-3, 4),
            (0.0, 1.0 / 8192.0, 9),
        ];
        for (start_s, period_s, decimals) in clocks {
            let times = printed(start_s, period_s, 20_000, decimals);
            let found = sample_time_s(&times, decimals);
            let found = found.unwrap_or_else(|e| panic!("{period_s} at {decimals}: {e:?}"));
            assert!((found / period_s - 1.0).abs() < 1e-4, "{found} for {period_s}");
        }
    }

    #[test]
    fn a_lost_sample_is_reported_with_its_index() {
        for (period_s, decimals) in [(1e-3, 3), (1e-3, 6), (2e-3, 3), (1.0 / 3e3, 4), (0.25, 2)] {
            for at in [1, 2, 500, 998] {
                let mut times = printed(3.0, period_s, 1000, decimals);
                let lost = times.remove(at);
                let error = sample_time_s(&times, decimals).expect_err("a gap");
                assert_eq!((error.sample, error.is_backward), (at, false), "{period_s}");
                assert!((error.expected_s - lost).abs() < 0.5 * period_s);
            }
        }
    }

    #[test]
    fn a_jump_of_half_a_sample_is_found() {
        let mut times = printed(0.0, 2e-3, 100, 3);
        times[40..].iter_mut().for_each(|time| *time += 1e-3);
        assert_eq!(sample_time_s(&times, 3).expect_err("a jump").sample, 40);
    }

    #[test]
    fn times_that_do_not_increase_are_found() {
        for change_s in [-1e-3, -5e-3] {
            let mut times = printed(0.0, 1e-3, 100, 3);
            times[40] += change_s;
            let error = sample_time_s(&times, 3).expect_err("not increasing");
            assert_eq!((error.sample, error.is_backward), (40, true));
        }
    }

    #[test]
    fn a_clock_that_changes_its_period_is_found() {
        let mut times = printed(0.0, 4e-3, 500, 3);
        let end_s = times[499];
        times.extend(printed(end_s + 5e-3, 5e-3, 400, 3));
        assert!(sample_time_s(&times, 3).is_err());
    }

    #[test]
    fn jitter_beyond_the_tolerance_is_found() {
        let mut times = printed(0.0, 1e-3, 1000, 6);
        times.iter_mut().step_by(7).for_each(|time| *time += 5e-5);
        assert!(sample_time_s(&times, 6).is_err());
    }
}
