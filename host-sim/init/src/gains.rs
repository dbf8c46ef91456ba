//! Gains that a machine file does not have, as first values of a trace, which then fits them.

use files::log::Log;
use model::axis::{Drive, Settings};
use model::machine::Machine;
use trace::TraceOptions;
use trace::input::signals::Signals;

use crate::rounded;
use crate::velocity_loop;

/// Tolerance of a gain from a regression, percent: bandwidth of the drive and gain are known only together from slow motions.
const PERCENT: f64 = 75.0;

/// The machine with gains from the logs on the axes that command the velocity of a drive with an unknown gain, and a sentence for each.
///
/// The lag (1 − Kf)/Kp is what such logs show best; the gains have a tolerance, within which a trace fits them. An unknown feed-forward
/// beside a known gain is 0, and the gains of other drives stay unknown: what a force says of them takes the whole of
/// [`machine`](crate::machine).
#[must_use]
pub fn of_unknown(machine: &Machine, logs: &[Log]) -> (Machine, Vec<String>) {
    let is_open = |settings: &Settings| {
        let controller = &settings.controller;
        controller.drive == Drive::Velocity && controller.position_gain_per_s.is_none()
    };
    let (mut with, mut notes) = (machine.clone(), Vec::new());
    if !machine.axis.values().any(|axis| is_open(&axis.settings)) {
        return (with, notes);
    }
    let Some(sample_s) = logs.first().map(|log| log.sample_time_s) else { return (with, notes) };
    let names: Vec<String> = machine.axis.keys().cloned().collect();
    let samples = TraceOptions::default().samples;
    let signals: Vec<Signals> = logs.iter().map(|log| Signals::new(log, &names, &samples)).collect();
    for (index, (name, axis)) in with.axis.iter_mut().enumerate() {
        let of_axis: Vec<_> = signals.iter().map(|log| &log.axes[index]).collect();
        let settings = &mut axis.settings;
        let found = is_open(settings).then(|| velocity_loop::settings(&of_axis, sample_s)).flatten();
        let Some(found) = found else { continue };
        let gain_per_s = rounded(found.position_gain_per_s);
        let percent = settings.controller.feedforward_percent.unwrap_or(rounded(found.feedforward_percent));
        settings.controller.position_gain_per_s = Some(gain_per_s);
        let tolerances = settings.mechanics.tolerance_percent.get_or_insert_default();
        tolerances.position_gain_per_s = Some(PERCENT);
        if settings.controller.feedforward_percent.is_none() && percent > 0.0 {
            settings.controller.feedforward_percent = Some(percent);
            tolerances.feedforward_percent = Some(PERCENT);
        }
        notes.push(format!(
            "{name}: the gains of the position loop are not in the machine file. They are fitted to the logs, from a position gain of \
             {gain_per_s:.3} 1/s and a feed-forward of {percent:.1} %; what they are wrong by is no effect."
        ));
    }
    (with, notes)
}
