//! Spikes: single readings, or a few in a row, far from their neighbours.

use std::ops::Range;

use super::bridge::bridge;
use super::fault::{DataFault, FaultKind};
use super::findings::ChannelLocation;

/// A displacement of a few readings, which returns to zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Spike {
    /// The displaced readings.
    pub samples: Range<usize>,
    /// Largest displacement, in the channel's unit.
    pub size: f64,
}

/// Replaces the readings of a spike.
pub fn remove(values: &mut [f64], reference: Option<&[f64]>, samples: &Range<usize>) -> Spike {
    let broken = values[samples.clone()].to_vec();
    bridge(values, reference, samples);
    let displacements = broken.iter().zip(&values[samples.clone()]).map(|(broken, mended)| broken - mended);
    let size =
        displacements.fold(0.0, |largest: f64, one| if one.abs() > largest.abs() { one } else { largest });
    Spike { samples: samples.clone(), size }
}

/// The spikes of a channel as one fault, with the time of the first and the size of the largest.
#[must_use]
pub fn fault(place: &ChannelLocation<'_>, spikes: &[Spike]) -> Option<DataFault> {
    let largest = spikes.iter().max_by(|a, b| a.size.abs().total_cmp(&b.size.abs()))?;
    let first = spikes.iter().map(|spike| spike.samples.start).min()?;
    let fault = place.fault_at(FaultKind::Spike, first, 1e3 * largest.size);
    Some(DataFault { count: spikes.len(), ..fault })
}
