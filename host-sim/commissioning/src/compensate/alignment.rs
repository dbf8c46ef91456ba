//! Logs as exact sensors would have recorded them: each channel is moved back by the latency that the model has for it, and the
//! errors of scale and probe are subtracted.
//!
//! A channel of one axis that is late, or a probe that is turned, makes a contour error in the log which the machine does not have.

use files::log::{Channel as LogChannel, Log};
use model::effects::{Channel, Timing};
use model::machine::Machine;
use numerics::resample::delayed_cubic;
use plant::parameters::AxisParameters;
use plant::probe::Probe;
use plant::scale::Scale;
use plant::tool_parameters::ToolParameters;

/// A log with its channels at the same instants and without the errors of scales and probes, by the effects of a machine's model. The
/// last samples of a channel that is moved keep its last value.
#[must_use]
pub fn aligned(log: &Log, model: &Machine) -> Log {
    let mut aligned = log.clone();
    for axis in &mut aligned.axes {
        let Some(of_model) = model.axis.get(&axis.name) else { continue };
        for effect in &of_model.effect {
            let Some(Timing::Reading { channel, late_ms }) = effect.timing() else { continue };
            let channel = match channel {
                Channel::Table => LogChannel::Table,
                Channel::Tool => LogChannel::Tool,
                Channel::Force => LogChannel::Force,
                Channel::Command => LogChannel::Command,
            };
            if let Some(values) = axis.channel_mut(channel) {
                *values = delayed_cubic(std::mem::take(values), -1e-3 * late_ms, log.sample_time_s);
            }
        }
    }
    subtract_errors(&mut aligned, model);
    aligned
}

/// Subtracts the errors of scales and probes at the readings: they are so small that those at the positions are the same.
fn subtract_errors(log: &mut Log, model: &Machine) {
    let (start_s, sample_s) = (log.start_s, log.sample_time_s);
    let read: Vec<Option<Vec<f64>>> =
        log.axes.iter().map(|axis| axis.channel(LogChannel::Tool).map(<[f64]>::to_vec)).collect();
    for (position, axis) in log.axes.iter_mut().enumerate() {
        let Some((number, _, of_model)) = model.axis.get_full(&axis.name) else { continue };
        let AxisParameters { scale, tool: ToolParameters { probe, .. }, .. } = AxisParameters::of(of_model);
        if let (true, Some(table_mm)) = (scale != Scale::default(), axis.channel_mut(LogChannel::Table)) {
            for (i, mm) in table_mm.iter_mut().enumerate() {
                let (table_m, time_s) = (1e-3 * *mm, start_s + i as f64 * sample_s);
                *mm -= 1e3 * (scale.error_m(table_m, time_s) - scale.displacement_m(table_m, time_s));
            }
        }
        let other = read.iter().enumerate().find(|(other, _)| *other != position);
        let other_mm = other.and_then(|(_, tool)| tool.as_deref());
        if let (true, Some(tool_mm)) = (probe != Probe::default(), axis.channel_mut(LogChannel::Tool)) {
            for (i, mm) in tool_mm.iter_mut().enumerate() {
                let turned_m = other_mm.map_or(0.0, |other| probe.rotation.offset_m(number, 1e-3 * other[i]));
                *mm -= 1e3 * (probe.gain.offset_m(1e-3 * *mm) + turned_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};
    use model::axis::Settings;
    use model::effects::{Effect, Latency};
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
        let log = Log::new("log", 0.0, 1e-3, [axis]);
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

    /// A probe turned by 0.3 mrad with a gain of 0.05 %, and a scale 60 µm/m too long: at 50 mm, what is left is of second order, the
    /// square of the gain (13 nm) and its product with the angle (8 nm).
    #[test]
    fn the_errors_of_scale_and_probe_are_subtracted() {
        let (angle, gain, scale) = (300e-6, 500e-6, 60e-6);
        let mm = [[50.0, -30.0], [-20.0, 45.0]];
        let axis = |name: &str, number: usize| {
            let mut axis = AxisLog::new(name, Unit::Millimetre);
            let sign = [angle, -angle][number];
            let tool = mm.map(|at| (1.0 + gain) * (at[number] + sign * at[1 - number]));
            *axis.channel_mut(LogChannel::Tool) = Some(tool.to_vec());
            *axis.channel_mut(LogChannel::Table) = Some(mm.map(|at| (1.0 + scale) * at[number]).to_vec());
            axis
        };
        let axes = vec![axis("x", 0), axis("y", 1)];
        let log = Log::new("log", 0.0, 1e-3, axes);
        let mut model = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        for name in ["x", "y"] {
            let effect = [("probe_rotation", angle), ("probe_gain", gain), ("scale_gain", scale)]
                .map(|(name, size)| format!("name = '{name}'\num_per_m = {:?}", 1e6 * size))
                .map(|text| toml::from_str(&text).unwrap());
            model.axis[name] = Axis { effect: effect.to_vec(), ..Axis::default() };
        }
        let aligned = aligned(&log, &model);
        for (number, axis) in aligned.axes.iter().enumerate() {
            for channel in [LogChannel::Tool, LogChannel::Table] {
                for (value, at) in axis.channel(channel).unwrap().iter().zip(mm) {
                    assert!((value - at[number]).abs() < 25e-6, "{channel:?} {value} {at:?}");
                }
            }
        }
    }
}
