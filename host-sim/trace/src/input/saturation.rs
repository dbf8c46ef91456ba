//! Exclusion of samples whose force is at its limit. At these samples the controller's output is not known.

use std::borrow::Cow;

use super::signals::Signals;
use crate::options::AdmissionOptions;
use files::error::InputError;
use files::log::Log;
use model::machine::Machine;

/// Notes the fraction of saturated samples of each fit log.
///
/// # Errors
/// For a log with too large a fraction of saturated samples.
pub fn check(
    machine: &Machine,
    fit: &[Cow<'_, Log>],
    options: &AdmissionOptions,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    for log in fit {
        for (name, axis) in &machine.axis {
            let (Some(limit_n), Some(force)) =
                (axis.settings.controller.force_limit_n, log.axis(name).and_then(|axis| axis.force.as_ref()))
            else {
                continue;
            };
            let count = at_limit(force, limit_n, options).iter().filter(|is_at_limit| **is_at_limit).count();
            let fraction = count as f64 / force.len().max(1) as f64;
            if fraction > options.max_saturated {
                let what = format!("a force below force_limit_n ({limit_n}) in most samples");
                let found = format!("a force at the limit in {:.0} %", 100.0 * fraction);
                return Err(InputError::expected(&log.source, what, found).at_key(name));
            }
            if count > 0 {
                notes.push(format!(
                    "{}: the force of {name} stands at its limit in {:.2} % of the samples; the force stage leaves \
                     them out.",
                    log.source,
                    100.0 * fraction
                ));
            }
        }
    }
    Ok(())
}

fn at_limit(force: &[f64], limit_n: f64, options: &AdmissionOptions) -> Vec<bool> {
    force.iter().map(|force| force.abs() >= options.saturation * limit_n).collect()
}

/// Sets [`AxisSignals::saturated`](super::signals::AxisSignals::saturated): the saturated samples and their neighbours
/// within the window of the smoothing filter.
pub fn mark(machine: &Machine, logs: &mut [Signals], options: &AdmissionOptions) {
    for log in logs {
        for (axis, declared) in log.axes.iter_mut().zip(machine.axis.values()) {
            let (Some(force), Some(limit_n)) = (&axis.force, declared.settings.controller.force_limit_n)
            else {
                continue;
            };
            let at = at_limit(&force.raw, limit_n, options);
            if at.iter().any(|at| *at) {
                let half = force.half_window();
                let around = |i: usize| i.saturating_sub(half)..(i + half + 1).min(at.len());
                axis.saturated = (0..at.len()).map(|i| at[around(i)].iter().any(|at| *at)).collect();
            }
        }
    }
}
