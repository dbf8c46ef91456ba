//! Logs whose channels are read late: each channel is moved back by the latency that the model has for it.
//!
//! A channel of one axis that is late makes a contour error in the log which the machine does not have.

use files::log::{Channel as LogChannel, Log};
use model::effects::{Channel, Effect};
use model::machine::Machine;

/// A log with its channels at the same instants, by the `latency` effects of a machine's model. The last samples of a channel that
/// is moved keep its last value.
#[must_use]
pub fn aligned(log: &Log, model: &Machine) -> Log {
    let mut aligned = log.clone();
    for axis in &mut aligned.axes {
        let Some(of_model) = model.axis.get(&axis.name) else { continue };
        for effect in &of_model.effect {
            let Effect::Latency(latency) = effect else { continue };
            let channel = match latency.channel {
                Channel::Table => LogChannel::Table,
                Channel::Tool => LogChannel::Tool,
                Channel::Force => LogChannel::Force,
            };
            if let Some(values) = axis.channel_mut(channel) {
                *values = advanced(values, 1e-3 * latency.ms / log.sample_time_s);
            }
        }
    }
    aligned
}

/// The values `samples` later, by cubic interpolation (Lagrange) of four neighbours.
fn advanced(values: &[f64], samples: f64) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let whole = samples.floor();
    let x = samples - whole;
    let weights = [
        -x * (x - 1.0) * (x - 2.0) / 6.0,
        (x + 1.0) * (x - 1.0) * (x - 2.0) / 2.0,
        -(x + 1.0) * x * (x - 2.0) / 2.0,
        (x + 1.0) * x * (x - 1.0) / 6.0,
    ];
    #[expect(clippy::cast_possible_truncation, reason = "a latency of some samples")]
    let whole = whole as i64;
    let at = |index: i64| values[usize::try_from(index).unwrap_or(0).min(last)];
    let index = |i: usize| i64::try_from(i).unwrap_or(0) + whole;
    (0..values.len())
        .map(|i| weights.iter().zip(-1..).map(|(weight, offset)| weight * at(index(i) + offset)).sum())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of 100 samples a period, 2.3 samples late. The error of the cubic is at most (2π/100)⁴·0.0234 = 4e-7.
    #[test]
    fn a_late_channel_is_moved_back() {
        let sine = |t: f64| (std::f64::consts::TAU * t / 100.0).sin();
        let late: Vec<f64> = (0..300).map(|i| sine(f64::from(i) - 2.3)).collect();
        let aligned = advanced(&late, 2.3);
        let worst = aligned[..290].iter().zip(0..).map(|(value, i)| (value - sine(f64::from(i))).abs());
        let worst = worst.skip(3).fold(0.0, f64::max);
        assert!(worst > 1e-9 && worst < 4e-7, "{worst}");
        assert_eq!(advanced(&late, 0.0), late);
    }
}
