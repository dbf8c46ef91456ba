//! Latency: a channel is logged late.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Channel, Coordinate, Distinction, Draw, EffectCompensation, EffectContext, EffectModel, Found,
    Imitation, ImitationContext, Misplaced, Mode, Occurrence, Parameter, Placement, Range, Stage, Substitute,
    Timing, Unit, Wording,
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

/// Step of the finite difference, and limit of the search, ms.
const STEP_MS: f64 = 0.02;
const LIMIT_MS: f64 = 100.0;

/// Damping ratio of a mode of the tool, as structures have it.
const LITTLE_DAMPING: f64 = 0.04;

/// Largest permitted delay, ms.
pub const LONGEST_LATENCY_MS: f64 = 1000.0;

/// Period of the position loop, ms.
fn sample_ms(rates: Rates) -> f64 {
    1e3 * f64::from(rates.position_loop_divider) / rates.velocity_loop_hz
}

impl EffectModel for Latency {
    const NAME: &'static str = "latency";
    const SUMMARY: &'static str = "the channel is logged late (`ms` below 0: early) relative to the other channels; a late motor reading is equivalent to an early table reading";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("ms", Unit::Millisecond, Range::Within(LONGEST_LATENCY_MS))];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] =
        &[("channel", "`table`, `tool`, `force` or `command`")];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table, Stage::Tool, Stage::Motor];
    const DRAW_NUMBER: Option<u32> = Some(14);

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let range = Range::Within(sample_ms(place.rates));
        let is_refused = self.channel == Channel::Command && !range.contains(self.ms);
        is_refused.then(|| Misplaced { key: "ms", expected: range.description() })
    }

    fn stages(&self) -> &'static [Stage] {
        match self.channel {
            Channel::Table => &[Stage::Table],
            Channel::Tool => &[Stage::Tool],
            Channel::Force => &[Stage::Force],
            Channel::Command => &[Stage::Motor],
        }
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let has = |stage| context.has(stage);
        // With a linear scale, a late force cannot be distinguished from a compliant, damped screw.
        let force = has(Stage::Force) && !has(Stage::Table);
        [
            (has(Stage::Table) && context.logged.scale, Channel::Table),
            (has(Stage::Tool), Channel::Tool),
            (force, Channel::Force),
            (has(Stage::Motor), Channel::Command),
        ]
        .into_iter()
        .filter_map(|(is_tried, channel)| is_tried.then_some(Self { channel, ms: 0.0 }))
        .collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.ms, STEP_MS, LIMIT_MS)]
    }

    /// A command that is late by more than a sample is a fault of the data, `shifted`.
    fn coordinates_at(&self, rates: Rates) -> Vec<Coordinate> {
        let limit_ms = if self.channel == Channel::Command { sample_ms(rates) } else { LIMIT_MS };
        vec![Coordinate::signed(self.ms, STEP_MS, limit_ms)]
    }

    /// Far below its frequency ω a mode of the tool whose damper acts against the ground delays by 2ζ/ω. If the reading of the tool is late as well, the fit of the mode
    /// alone ends at a damping ratio that is too high, from where no latency improves it.
    fn in_place_of(found: &Found<'_>) -> Option<Substitute<Self>> {
        let Mode { frequency_hz, damping_ratio, damped_against, .. } = found.mode?;
        let omega = std::f64::consts::TAU * frequency_hz;
        let late = Self { channel: Channel::Tool, ms: 1e3 * 2.0 * (damping_ratio - LITTLE_DAMPING) / omega };
        let mut mode: Vec<f64> = found.coordinates.iter().map(|coordinate| coordinate.value).collect();
        *mode.get_mut(1)? = LITTLE_DAMPING;
        let is_damped = damped_against.is_ground() && damping_ratio > 2.0 * LITTLE_DAMPING;
        is_damped.then_some(Substitute { effect: late, beside: Some(mode) })
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

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let is_of_tool = self.channel == Channel::Tool;
        if is_of_tool && context.hides_stretch() { vec![Imitation::STRETCH] } else { Vec::new() }
    }

    fn timing(&self) -> Option<Timing> {
        Some(Timing::Reading { channel: self.channel, late_ms: self.ms })
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "only the log is late, the machine is not",
            "read the channels at the same instant; this program moves the channel back where it evaluates logs",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let channel = match self.channel {
            Channel::Table => "table reading",
            Channel::Tool => "tool reading",
            Channel::Force => "force",
            Channel::Command => "command",
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
