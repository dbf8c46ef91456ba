//! Collection of the faults of one log.

use std::ops::Range;

use super::channels;
use super::excluded::Excluded;
use super::fault::{DataFault, FaultHandling, FaultKind};
use files::log::{AxisLog, Channel, Log};
use model::effects::Stage;

/// The faults of one log, and the samples that they spoil.
#[derive(Clone, Debug, Default)]
pub struct Findings {
    /// The faults.
    pub faults: Vec<DataFault>,
    /// The spoiled samples.
    pub excluded: Vec<Excluded>,
}

/// The place of a fault: an axis of a log, and a channel.
#[derive(Clone, Copy, Debug)]
pub struct ChannelLocation<'a> {
    /// The log.
    pub log: &'a Log,
    /// Index of the axis in the log.
    pub axis: usize,
    /// The channel.
    pub channel: Channel,
}

impl<'a> ChannelLocation<'a> {
    /// The axis.
    #[must_use]
    pub fn axis(&self) -> &'a AxisLog {
        &self.log.axes[self.axis]
    }

    /// The fault of a kind over the whole log.
    #[must_use]
    pub fn fault(&self, kind: FaultKind, size: Option<f64>, treatment: FaultHandling) -> DataFault {
        DataFault {
            axis: self.axis().name.clone(),
            channel: Some(self.channel),
            kind,
            log: self.log.source.clone(),
            at_s: None,
            size,
            frequency_hz: None,
            count: 1,
            treatment,
        }
    }

    /// The fault of a kind at a sample, which is corrected.
    #[must_use]
    pub fn fault_at(&self, kind: FaultKind, sample: usize, size: f64) -> DataFault {
        let at_s = Some(self.log.time_s(sample));
        DataFault { at_s, ..self.fault(kind, Some(size), FaultHandling::Corrected) }
    }
}

impl Findings {
    /// Excludes samples, and `margin` neighbours on both sides, from the stages that use the channel.
    pub fn exclude(&mut self, place: &ChannelLocation<'_>, samples: &Range<usize>, margin: usize) {
        self.exclude_stages(place, samples, margin, channels::stages(place.axis(), place.channel));
    }

    /// Excludes samples, and `margin` neighbours on both sides, from stages.
    pub fn exclude_stages(
        &mut self,
        place: &ChannelLocation<'_>,
        samples: &Range<usize>,
        margin: usize,
        stages: &'static [Stage],
    ) {
        let log = place.log;
        // Half a sample beyond the first and the last one, so that rounding of times does not matter.
        let half_s = 0.5 * log.sample_time_s;
        self.excluded.push(Excluded {
            log: log.source.clone(),
            axis: place.axis().name.clone(),
            stages,
            from_s: log.time_s(samples.start.saturating_sub(margin)) - half_s,
            to_s: log.time_s((samples.end + margin).saturating_sub(1)) + half_s,
        });
    }
}
