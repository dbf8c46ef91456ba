//! Latency: a channel is logged late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Channel, Coordinate, Distinction, Draw, EffectContext, EffectModel, Occurrence, Parameter,
    Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Each sample of the channel holds the value of the instant `ms` earlier. The control loop is not affected.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Latency {
    /// The late channel.
    pub channel: Channel,
    /// Delay; negative: early.
    pub ms: f64,
}

/// Largest permitted delay, ms.
pub const LONGEST_LATENCY_MS: f64 = 1000.0;

impl EffectModel for Latency {
    const NAME: &'static str = "latency";
    const SUMMARY: &'static str = "the channel is logged late (`ms` below 0: early) relative to the other channels; a late motor reading is equivalent to an early table reading";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::Within(LONGEST_LATENCY_MS))];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("channel", "`table`, `tool` or `force`")];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table, Stage::Tool];
    const DRAW_NUMBER: Option<u32> = Some(14);

    fn stages(&self) -> &'static [Stage] {
        match self.channel {
            Channel::Table => &[Stage::Table],
            Channel::Tool => &[Stage::Tool],
            Channel::Force => &[Stage::Force],
        }
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let has = |stage| context.has(stage);
        // With a linear scale, a late force cannot be distinguished from a compliant, damped screw.
        let force = has(Stage::Force) && !has(Stage::Table);
        [(has(Stage::Table), Channel::Table), (has(Stage::Tool), Channel::Tool), (force, Channel::Force)]
            .into_iter()
            .filter_map(|(is_tried, channel)| is_tried.then_some(Self { channel, ms: 0.0 }))
            .collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.ms, 0.02, 100.0)]
    }

    /// The instants at which channels are read are known to a tenth of a sample.
    fn exceeds_tolerance(&self, _declared: &Settings, rates: Rates) -> bool {
        1e-3 * self.ms.abs() * rates.velocity_loop_hz > 0.1 * f64::from(rates.position_loop_divider)
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { ms: x[0], ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.ms]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Channel(self.channel)
    }

    fn sentence(&self, wording: &Wording) -> String {
        let channel = match self.channel {
            Channel::Table => "table reading",
            Channel::Tool => "tool reading",
            Channel::Force => "force",
        };
        let how = wording.by_sign("late", "early");
        format!("the {channel} is logged {} {how}", wording.size(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { channel: Channel::Tool, ms: draw.between(0.3, 2.0) })
    }
}
