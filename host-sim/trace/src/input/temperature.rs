//! The temperature of a guide, as its friction sees it.

use files::log::AxisLog;
use plant::guide_temperature::GuideTemperature;

/// The temperature of an axis in a log that starts at a time of the session, s, its readings averaged over `smoothing_s`: a guide
/// changes its temperature within minutes, and a sensor reads whole tenths or degrees.
#[must_use]
pub fn of_log(axis: &AxisLog, [start_s, sample_s]: [f64; 2], smoothing_s: f64) -> Option<GuideTemperature> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "samples of seconds")]
    let half = (0.5 * smoothing_s / sample_s).round() as usize;
    let averaged = averaged(axis.temperature.as_ref()?, half);
    GuideTemperature::new(start_s, sample_s, averaged)
}

/// Means over `half` values on either side; fewer at the ends, and as many on one side as on the other.
fn averaged(values: &[f64], half: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    for value in values {
        sums.push(sums[sums.len() - 1] + value);
    }
    let mean = |i: usize| {
        let half = half.min(i).min(values.len() - 1 - i);
        (sums[i + half + 1] - sums[i - half]) / (2 * half + 1) as f64
    };
    (0..values.len()).map(mean).collect()
}

/// The mean over the temperatures of some logs, °C; `None` if one is missing, or if they vary by less than this.
#[must_use]
pub fn mean_c<'a>(
    of_logs: impl Iterator<Item = Option<&'a GuideTemperature>>,
    min_range_c: f64,
) -> Option<f64> {
    let of_logs: Vec<&GuideTemperature> = of_logs.collect::<Option<_>>()?;
    let all = || of_logs.iter().flat_map(|log| log.celsius()).copied();
    (numerics::peak_to_peak(all()) >= min_range_c).then(|| numerics::mean(all()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    /// The mean of a straight line over a symmetric window is its middle, at the ends as well; the rounding to whole degrees averages
    /// to less than a degree by the number of steps in the window.
    #[test]
    fn a_reading_in_whole_degrees_is_averaged() {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.temperature = Some((0..1000).map(|i| (20.0 + 0.05 * f64::from(i)).round()).collect());
        let curve = of_log(&axis, [0.0, 0.01], 1.0).unwrap();
        for (i, celsius) in curve.celsius().iter().enumerate().skip(50).take(900) {
            assert!((celsius - (20.0 + 0.05 * i as f64)).abs() < 0.11, "{i}: {celsius}");
        }
        axis.temperature = Some((0..1000).map(|i| 20.0 + 0.05 * f64::from(i)).collect());
        let curve = of_log(&axis, [0.0, 0.01], 1.0).unwrap();
        for (i, celsius) in curve.celsius().iter().enumerate() {
            assert!((celsius - (20.0 + 0.05 * i as f64)).abs() < 1e-9, "{i}: {celsius}");
        }
    }

    #[test]
    fn a_temperature_that_hardly_varies_or_is_missing_shows_nothing() {
        let [cold, warm] = [20.0, 23.0].map(|celsius| GuideTemperature::new(0.0, 1.0, vec![celsius; 5]));
        let mean = |logs: &[&Option<GuideTemperature>]| mean_c(logs.iter().map(|log| log.as_ref()), 2.0);
        assert_eq!(mean(&[&cold, &warm]), Some(21.5));
        assert_eq!(mean(&[&cold, &cold]), None);
        assert_eq!(mean(&[&cold, &warm, &None]), None);
    }
}
