//! Sign: the reading decreases while the axis moves in the + direction.

use super::agreement::tolerance;
use super::fault::{FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use crate::options::FaultOptions;
use files::log::Channel;

/// Whether a channel that moves by this factor of the others has the wrong sign only. The motion of a sensor is that of the
/// others up to the large pitch error of a wrong lead, that of the command differs by the following error.
#[must_use]
pub fn is_reversed(channel: Channel, factor: f64, options: &FaultOptions) -> bool {
    (factor + 1.0).abs() < tolerance(&[channel], options)
}

/// Reports and negates a channel. It is negated about its own zero; the distance between its zero and that of the other
/// channels is fitted with the model.
pub fn correct(values: &mut [f64], place: &ChannelLocation<'_>, findings: &mut Findings) {
    findings.faults.push(place.fault(FaultKind::Sign, None, FaultHandling::Corrected));
    for value in values {
        *value = -*value;
    }
}
