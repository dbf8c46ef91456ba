//! Sign: the reading decreases while the axis moves in the + direction.

use super::fault::{FaultKind, Treatment};
use super::findings::{Findings, Place};
use crate::options::FaultOptions;

/// Whether a channel that moves by this factor of the others has the wrong sign only.
#[must_use]
pub fn is_reversed(factor: f64, options: &FaultOptions) -> bool {
    (factor + 1.0).abs() < options.max_command_factor
}

/// Reports and negates a channel. It is negated about its own zero; the distance between its zero and that of the other
/// channels is fitted with the model.
pub fn correct(values: &mut [f64], place: &Place<'_>, findings: &mut Findings) {
    findings.faults.push(place.fault(FaultKind::Sign, None, Treatment::Corrected));
    values.iter_mut().for_each(|value| *value = -*value);
}
