//! Logs at another sampling rate than that of the machine.

use std::borrow::Cow;
use std::ops::Range;

use crate::options::AdmissionOptions;
use files::error::InputError;
use files::log::{Channel, Log};
use model::machine::Machine;
use numerics::resample::spaced_cubic;

/// Rates of a log and of the machine.
enum Ratio {
    /// Both are equal.
    Same,
    /// The log has so many samples for each one of the machine.
    Multiple(usize),
    /// The log has more samples, and no whole multiple.
    Faster,
}

impl Ratio {
    /// `None`: the log has fewer samples.
    fn of(ratio: f64, tolerance: f64) -> Option<Self> {
        let is_whole = |ratio: f64| (ratio / ratio.round() - 1.0).abs() <= tolerance;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "above 1")]
        let whole = ratio.round() as usize;
        match () {
            () if (ratio - 1.0).abs() <= tolerance => Some(Self::Same),
            () if ratio > 1.0 && is_whole(ratio) => Some(Self::Multiple(whole)),
            () if ratio > 1.0 => Some(Self::Faster),
            () => None,
        }
    }
}

/// The log at the rate of the machine; any change is noted. A log at N times this rate is thinned to each Nth sample, one at another higher rate
/// is resampled. Between the samples of one at a lower rate, neither the command nor the sensors are known.
///
/// # Errors
/// For a lower rate.
pub fn at_machine_rate<'a>(
    machine: &Machine,
    log: Cow<'a, Log>,
    options: &AdmissionOptions,
    notes: &mut Vec<String>,
) -> Result<Cow<'a, Log>, InputError> {
    let (rate, machine_hz) = (1.0 / log.sample_time_s, machine.sample_rate_hz);
    let (source, half_hz) = (log.source.clone(), 0.5 * machine_hz);
    match Ratio::of(rate / machine_hz, options.rate_tolerance) {
        Some(Ratio::Same) => Ok(log),
        Some(Ratio::Multiple(every)) => {
            notes.push(format!(
                "{source}: sampled at {rate:.0} Hz, {every} times the machine's rate; every {} sample is used, as read: a controller at \
                 the machine's rate reads its encoders just so, and a filter would delay what it sees. Vibration above {half_hz:.0} Hz \
                 appears at a lower frequency.",
                ordinal(every),
            ));
            Ok(Cow::Owned(log.into_owned().thinned(every)))
        }
        Some(Ratio::Faster) => {
            notes.push(format!(
                "{source}: sampled at {rate:.6} Hz and resampled at {machine_hz} Hz, the machine's sample_rate_hz. Vibration above \
                 {half_hz:.0} Hz appears at a lower frequency. If the controller runs at the rate of the log, set sample_rate_hz to it."
            ));
            Ok(Cow::Owned(resampled(&log, rate / machine_hz)))
        }
        None => {
            let expected = format!("samples at the machine's sample_rate_hz of {machine_hz}");
            let found = format!("{rate:.6} Hz: too few; sample_rate_hz can be set to the rate of the log");
            Err(InputError::expected(&log.source, expected, found))
        }
    }
}

/// The log with samples that are `step` of its own apart. A sample is a measurement if those beside it are.
fn resampled(log: &Log, step: f64) -> Log {
    let mut resampled = log.slice(0..0);
    resampled.sample_time_s = step * log.sample_time_s;
    for (axis, of_log) in resampled.axes.iter_mut().zip(&log.axes) {
        for channel in Channel::ALL {
            *axis.channel_mut(channel) = of_log.channel(channel).map(|values| spaced_cubic(values, step));
        }
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the log")]
    let beside =
        |sample: usize| ((sample as f64 / step).floor() as usize, (sample as f64 / step).ceil() as usize + 1);
    let count = resampled.len();
    let of_range =
        |range: &Range<usize>| beside(range.start.saturating_sub(1)).0..beside(range.end).1.min(count);
    resampled.interpolated =
        log.interpolated.iter().map(of_range).filter(|range| !range.is_empty()).collect();
    resampled
}

fn ordinal(n: usize) -> String {
    let end = match (n % 10, n % 100) {
        (1, tens) if tens != 11 => "st",
        (2, tens) if tens != 12 => "nd",
        (3, tens) if tens != 13 => "rd",
        _ => "th",
    };
    format!("{n}{end}")
}
