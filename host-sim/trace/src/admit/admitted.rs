//! Logs at the rate of the machine.

use super::sampling_rate;
use crate::data_faults::examine::{Examined, exclude_interpolated, interpolate_lost_rows};
use crate::options::AdmissionOptions;
use crate::task::{Job, Logs};
use files::error::InputError;
use files::log::Log;
use model::machine::Machine;

/// Logs at the rate of the machine, with notes for the user.
#[derive(Clone, Debug)]
pub struct Admitted<'a> {
    /// Fit logs and validation logs (none if the fit logs are to be split), with the faults found so far.
    pub examined: Examined<'a>,
    /// Sentences on logs that were resampled, and on missing channels.
    pub notes: Vec<String>,
}

/// Admits logs: interpolates their lost rows, which only show at the rate of the log, and brings them to the rate of the machine.
///
/// # Errors
/// For a log at a rate that is too low for that of the machine.
pub fn admit<'a>(job: &Job<'_>, logs: Logs<'a>) -> Result<Admitted<'a>, InputError> {
    let interpolated = interpolate_lost_rows(job.machine, logs, job.options);
    let mut admitted = at_machine_rate(job.machine, interpolated, &job.options.admission)?;
    exclude_interpolated(job.machine, &mut admitted.examined, job.options);
    Ok(admitted)
}

/// What is said of samples that were interpolated when the file was read.
fn note_of_interpolated(log: &Log) -> Option<String> {
    let count = log.interpolated_samples();
    (count > 0).then(|| {
        format!(
            "{}: {count} of {} samples have no row at their time; they take no part.",
            log.source,
            log.len()
        )
    })
}

/// Logs at the rate of the machine, with notes on those that were changed.
///
/// # Errors
/// For a log at a rate that is too low for it.
pub(super) fn at_machine_rate<'a>(
    machine: &Machine,
    mut examined: Examined<'a>,
    options: &AdmissionOptions,
) -> Result<Admitted<'a>, InputError> {
    let mut notes: Vec<String> =
        examined.logs.iter().flatten().filter_map(|log| note_of_interpolated(log)).collect();
    for logs in &mut examined.logs {
        let given = std::mem::take(logs);
        for log in given {
            logs.push(sampling_rate::at_machine_rate(machine, log, options, &mut notes)?);
        }
    }
    Ok(Admitted { examined, notes })
}
