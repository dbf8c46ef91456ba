//! The size of the difference of two channels.

/// Deviation of differences from their median that 95 % of them do not exceed. Unlike a median it does not disregard motion in
/// a small part of a log; unlike a root mean square it disregards spikes.
#[must_use]
pub fn deviation(differences: &[f64]) -> f64 {
    let Some(median) = numerics::median(differences) else { return 0.0 };
    let deviations: Vec<f64> = differences.iter().map(|value| (value - median).abs()).collect();
    numerics::quantile(&deviations, 0.95)
}
