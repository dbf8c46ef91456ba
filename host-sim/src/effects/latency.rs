//! Latency: a channel that is logged late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::machine::Axis;

/// The named channel shows what was true `ms` earlier. The loop itself is not affected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Latency {
    /// Which channel.
    pub channel: Channel,
    /// How late.
    pub ms: f64,
}

/// A channel that may be late against the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Linear scale.
    Table,
    /// Tool-point probe.
    Tool,
}

impl Kind for Latency {
    fn stages(&self) -> &'static [Stage] {
        match self.channel {
            Channel::Table => &[Stage::Table],
            Channel::Tool => &[Stage::Tool],
        }
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        [(Stage::Table, Channel::Table), (Stage::Tool, Channel::Tool)]
            .into_iter()
            .filter(|(stage, _)| around.stages.contains(stage))
            .map(|(_, channel)| Self { channel, ms: 0.0 })
            .collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.ms, 0.02, 100.0)]
    }

    /// A tenth of a sample: the instants of a log's channels are not known better.
    fn is_material(&self, _declared: &Axis, rates: Rates) -> bool {
        1e-3 * self.ms.abs() * rates.velocity_loop_hz > 0.1 * f64::from(rates.position_loop_divider)
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0], ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("ms", self.ms)]
    }
}
