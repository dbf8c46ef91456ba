//! Resonance: the tool oscillates relative to the table.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Channel, Coordinate, EffectContext, EffectModel, Misplaced, Occurrence, Parameter, Placement,
    Range, Stage, Unit, Wording,
};

/// Transfer function from table to tool: ω²/(s² + 2ζωs + ω²).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resonance {
    /// Channel that oscillates; only the tool is modelled.
    #[serde(default = "tool")]
    pub channel: Channel,
    /// ω/2π.
    pub frequency_hz: f64,
    /// ζ.
    pub damping_ratio: f64,
}

fn tool() -> Channel {
    Channel::Tool
}

impl EffectModel for Resonance {
    const NAME: &'static str = "resonance";
    const SUMMARY: &'static str = "tool follows table as a second-order mode";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("frequency_hz", Unit::Hertz, Range::Positive),
        Parameter::new("damping_ratio", Unit::One, Range::NotNegative),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        let is_modelled = self.channel == Channel::Tool;
        (!is_modelled).then(|| Misplaced { key: "channel", expected: "\"tool\"".to_owned() })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(_context: &EffectContext<'_>) -> Vec<Self> {
        [15.0, 30.0, 60.0, 120.0, 240.0, 480.0]
            .map(|frequency_hz| Self { channel: tool(), frequency_hz, damping_ratio: 0.05 })
            .to_vec()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            // A mode far above the frequencies of the motion is an in-talk of −1/(2π·frequency)², which the search shall know as
            // its rival.
            Coordinate { step: 0.1, ..Coordinate::scale(self.frequency_hz, 1.0, 1000.0) },
            // A more strongly damped mode cannot be distinguished from a latency.
            Coordinate::scale(self.damping_ratio, 0.001, 0.3),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { frequency_hz: x[0], damping_ratio: x[1], ..self.clone() }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.frequency_hz, self.damping_ratio]
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the tool oscillates relative to the table at {}, with a damping ratio of {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
