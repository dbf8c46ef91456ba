//! Logs whose channels are read late: each channel is moved back by the latency that the model has for it.
//!
//! A channel of one axis that is late makes a contour error in the log which the machine does not have.

use files::log::{Channel as LogChannel, Log};
use model::effects::{Channel, Effect};
use model::machine::Machine;
use numerics::resample::delayed_cubic;

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
                *values = delayed_cubic(std::mem::take(values), -1e-3 * latency.ms, log.sample_time_s);
            }
        }
    }
    aligned
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};
    use model::axis::Settings;
    use model::effects::Latency;
    use model::machine::Axis;

    /// A sine of 100 samples a period, 2.3 samples late. The error of the cubic is at most (2π/100)⁴·0.0234 = 4e-7.
    #[test]
    fn a_late_channel_is_moved_back() {
        let sine = |t: f64| (std::f64::consts::TAU * t / 100.0).sin();
        let late: Vec<f64> = (0..300).map(|i| sine(f64::from(i) - 2.3)).collect();
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        for channel in [LogChannel::Tool, LogChannel::Motor] {
            *axis.channel_mut(channel) = Some(late.clone());
        }
        let log = Log { source: "log".to_owned(), start_s: 0.0, sample_time_s: 1e-3, axes: vec![axis] };
        let effect = vec![Effect::Latency(Latency { channel: Channel::Tool, ms: 2.3 })];
        let mut model = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        model.axis["x"] = Axis { settings: Settings::default(), effect, ..Axis::default() };
        let aligned = aligned(&log, &model);
        let tool = aligned.axes[0].channel(LogChannel::Tool).unwrap();
        let worst = tool[..290].iter().zip(0..).map(|(value, i)| (value - sine(f64::from(i))).abs());
        let worst = worst.skip(3).fold(0.0, f64::max);
        assert!(worst > 1e-9 && worst < 4e-7, "{worst}");
        // Only the channel that is late is moved.
        assert_eq!(aligned.axes[0].channel(LogChannel::Motor).unwrap(), &late);
    }
}
