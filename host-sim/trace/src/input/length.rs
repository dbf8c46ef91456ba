//! Logs that are too long to be fitted as a whole.

use std::borrow::Cow;

use crate::options::AdmissionOptions;
use files::log::Log;

/// Number of stretches to which a log that is too long is reduced.
pub const STRETCHES: usize = 12;

/// If the total length of the logs is too large, reduces each to evenly spaced stretches, and notes this.
pub fn limited<'a>(
    logs: Vec<Cow<'a, Log>>,
    options: &AdmissionOptions,
    notes: &mut Vec<String>,
) -> Vec<Cow<'a, Log>> {
    let total: usize = logs.iter().map(|log| log.len()).sum();
    if total <= options.max_samples {
        return logs;
    }
    let fraction = options.max_samples as f64 / total as f64;
    let of_log = |log: Cow<'a, Log>| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a fraction of a length")]
        let length = (fraction * log.len() as f64 / STRETCHES as f64) as usize;
        if length < options.min_samples {
            return vec![log];
        }
        notes.push(format!(
            "{}: {} samples are more than is needed; {STRETCHES} stretches of {:.0} s, spread evenly over it, are used.",
            log.source,
            log.len(),
            length as f64 * log.sample_time_s
        ));
        let start = |i: usize| i * (log.len() - length) / (STRETCHES - 1);
        (0..STRETCHES).map(|i| Cow::Owned(log.slice(start(i)..start(i) + length))).collect()
    };
    logs.into_iter().flat_map(of_log).collect()
}
