//! Latency: a channel that is logged late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::{Coordinate, Kind, Stage, Surroundings};
use crate::axis::Settings;

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
    /// Drive force, against the time that the log's format gives it: over the tick that ends at the
    /// sample. A log that shows what is going to be given over the next tick is early by one.
    Force,
}

impl Kind for Latency {
    fn stages(&self) -> &'static [Stage] {
        match self.channel {
            Channel::Table => &[Stage::Table],
            Channel::Tool => &[Stage::Tool],
            Channel::Force => &[Stage::Force],
        }
    }

    fn starts(around: &Surroundings<'_>) -> Vec<Self> {
        let has = |stage| around.stages.contains(&stage);
        // Beside a linear scale a force that is late looks like a screw that is soft and damped.
        let force = has(Stage::Force) && !has(Stage::Table);
        [(has(Stage::Table), Channel::Table), (has(Stage::Tool), Channel::Tool), (force, Channel::Force)]
            .into_iter()
            .filter_map(|(is_tried, channel)| is_tried.then_some(Self { channel, ms: 0.0 }))
            .collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.ms, 0.02, 100.0)]
    }

    /// A tenth of a sample: the instants of a log's channels are not known better.
    fn is_material(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms.abs() * rates.velocity_loop_hz > 0.1 * f64::from(rates.position_loop_divider)
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0], ..self.clone() }
    }

    fn parameters(&self) -> Vec<(&'static str, f64)> {
        vec![("ms", self.ms)]
    }
}
