//! Logs at another sampling rate than that of the machine.

use std::borrow::Cow;

use crate::options::AdmissionOptions;
use files::error::InputError;
use files::log::{Channel, Log};
use model::machine::Machine;

/// The log at the rate of the machine. A log at N times this rate is thinned to each Nth sample, which is noted.
///
/// # Errors
/// For any other rate.
pub fn at_machine_rate<'a>(
    machine: &Machine,
    log: Cow<'a, Log>,
    options: &AdmissionOptions,
    notes: &mut Vec<String>,
) -> Result<Cow<'a, Log>, InputError> {
    let rate = 1.0 / log.sample_time_s;
    let ratio = rate / machine.sample_rate_hz;
    let whole = ratio.round();
    let what = format!("samples at the machine's sample_rate_hz of {}", machine.sample_rate_hz);
    if whole < 1.0 || (ratio / whole - 1.0).abs() > options.rate_tolerance {
        let why = if ratio < 1.0 - options.rate_tolerance {
            "too few; sample_rate_hz can be set to the rate of the log"
        } else {
            "not a whole multiple"
        };
        return Err(InputError::expected(&log.source, what, format!("{rate:.6} Hz: {why}")));
    }
    if whole < 1.5 {
        return Ok(log);
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 2")]
    let every = whole as usize;
    notes.push(format!(
        "{}: sampled at {rate:.0} Hz, {every} times the machine's rate; every {} sample is used, as read: a controller at \
         the machine's rate reads its encoders just so, and a filter would delay what it sees. Vibration above {:.0} Hz \
         appears at a lower frequency.",
        log.source,
        ordinal(every),
        0.5 * machine.sample_rate_hz
    ));
    let mut thinned = log.into_owned();
    thinned.sample_time_s *= whole;
    for axis in &mut thinned.axes {
        for channel in Channel::ALL {
            if let Some(samples) = axis.channel_mut(channel) {
                *samples = samples.iter().copied().step_by(every).collect();
            }
        }
    }
    Ok(Cow::Owned(thinned))
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
