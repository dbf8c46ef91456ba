//! Rate: each row of a log stands there several times, so that its true rate is a fraction of that which its times give.

use super::fault::{DataFault, FaultHandling, FaultKind};
use files::error::InputError;
use files::log::{Channel, Log};

/// Largest number of repetitions that is looked for.
const MAX_REPEATED: usize = 20;
/// Smallest number of changes that show it.
const MIN_CHANGES: usize = 50;

/// How often each row is repeated, if it is: the channels change together, and only at multiples of this number of rows.
#[must_use]
pub fn repeated(log: &Log) -> Option<usize> {
    let columns: Vec<&[f64]> = log
        .axes
        .iter()
        .flat_map(|axis| Channel::ALL.map(|channel| axis.channel(channel)))
        .flatten()
        .collect();
    let changes = || {
        (1..log.len())
            .filter(|&row| columns.iter().any(|column| column[row].to_bits() != column[row - 1].to_bits()))
    };
    let steps = || changes().skip(1).zip(changes()).map(|(next, row)| next - row);
    // Most logs end this at the first step of one row.
    let every = steps().find(|step| *step < 2).or_else(|| steps().min())?;
    let is_repeated = (2..=MAX_REPEATED).contains(&every) && changes().count() >= MIN_CHANGES;
    (is_repeated && steps().all(|step| step % every == 0)).then_some(every)
}

/// The fault of a log that is left out, for each of its axes.
pub fn faults(log: &Log, every: usize) -> impl Iterator<Item = DataFault> {
    log.axes.iter().map(move |axis| DataFault {
        axis: axis.name.clone(),
        channel: None,
        kind: FaultKind::Rate,
        log: log.source.clone(),
        at_s: None,
        size: Some(every as f64),
        frequency_hz: None,
        count: 1,
        treatment: FaultHandling::LogLeftOut,
    })
}

/// The error for a log that cannot be left out, as no other one can be fitted.
#[must_use]
pub fn error(log: &Log, every: usize) -> InputError {
    let rate = 1.0 / log.sample_time_s;
    let found = format!("each row {every} times: the log was sampled at {:.0} Hz", rate / every as f64);
    InputError::expected(
        &log.source,
        format!("rows that were sampled at the {rate:.0} Hz of their times"),
        found,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Unit};

    fn log(every: u32, resolution_mm: f64) -> Log {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let at = |i: u32| (30.0 * (1e-3 * f64::from(i)).sin() / resolution_mm).round() * resolution_mm;
        axis.motor = Some((0..4000).map(|i| at(i / every * every)).collect());
        axis.table = Some((0..4000).map(|i| at(i / every * every + 1)).collect());
        Log::new("l", 0.0, 1e-3, [axis])
    }

    #[test]
    fn repeated_rows_are_counted() {
        for every in [2, 4, 10] {
            let found = repeated(&log(every, 1e-6));
            assert_eq!(found, usize::try_from(every).ok());
        }
        assert_eq!(repeated(&log(1, 1e-6)), None);
        // An encoder of 0.2 mm changes in every seventh row at most, but not in multiples of a number of rows.
        assert_eq!(repeated(&log(1, 0.2)), None);
    }
}
