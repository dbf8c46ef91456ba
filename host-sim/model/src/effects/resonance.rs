//! Resonance: the tool oscillates relative to the table.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Channel, Coordinate, Distinction, EffectCompensation, EffectContext, EffectModel, Imitation,
    ImitationContext, Misplaced, Mode, Occurrence, Parameter, Placement, Range, Stage, Unit, Wording,
};

/// Tool − table = participation·(H − 1)·table, H = ω²/(s² + 2ζωs + ω²). The contributions of several modes add up (modal
/// superposition); two modes in series are such a sum, too, with participations of opposite signs whose sum is 1.
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
    /// Displacement of the tool in the mode, relative to that of the mass which the table drives; 1: the tool is this mass.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub participation: f64,
    /// Whether a fit changes the participation: of each mode beside another one. Not in files.
    #[serde(skip)]
    pub fits_participation: bool,
}

const fn one() -> f64 {
    1.0
}

#[expect(clippy::trivially_copy_pass_by_ref, clippy::float_cmp, reason = "as serde calls it; 1 is exact")]
fn is_one(value: &f64) -> bool {
    *value == 1.0
}

impl Resonance {
    /// Tool − table per acceleration far below its frequency, m per m/s²: there, a mode is an in-talk.
    #[must_use]
    pub fn static_s2(&self) -> f64 {
        -self.participation / (std::f64::consts::TAU * self.frequency_hz).powi(2)
    }

    /// Second modes with which a fit starts, without any participation yet.
    fn second_modes() -> impl Iterator<Item = Self> {
        (0..22).map(|power| Self {
            participation: 0.0,
            fits_participation: true,
            ..Self::of_tool(15.0 * GUESS_RATIO.powi(power), 0.05)
        })
    }

    fn has_participation(&self) -> bool {
        self.fits_participation || !is_one(&self.participation)
    }

    /// A mode of the tool with a participation of 1.
    #[must_use]
    pub const fn of_tool(frequency_hz: f64, damping_ratio: f64) -> Self {
        Self {
            channel: Channel::Tool,
            frequency_hz,
            damping_ratio,
            participation: 1.0,
            fits_participation: false,
        }
    }
}

/// Ratio of neighbouring frequencies with which the fit of a second mode starts. A mode with a damping ratio of 0.05 is half as
/// wide.
const GUESS_RATIO: f64 = 1.15;

fn tool() -> Channel {
    Channel::Tool
}

impl EffectModel for Resonance {
    const NAME: &'static str = "resonance";
    const SUMMARY: &'static str =
        "tool follows table as a second-order mode; a second mode adds up, each with its participation";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("frequency_hz", Unit::Hertz, Range::Positive),
        Parameter::new("damping_ratio", Unit::One, Range::NotNegative),
        Parameter::new("participation", Unit::One, Range::Signed),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Repeated;
    const SHOWN_IN: &'static [Stage] = &[Stage::Tool];

    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        let is_modelled = self.channel == Channel::Tool;
        (!is_modelled).then(|| Misplaced { key: "channel", expected: "\"tool\"".to_owned() })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Tool]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        match context.count(Self::NAME) {
            0 => [15.0, 30.0, 60.0, 120.0, 240.0, 480.0].map(|hz| Self::of_tool(hz, 0.05)).to_vec(),
            1 => Self::second_modes().collect(),
            _ => Vec::new(),
        }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let mut coordinates = vec![
            // A mode far above the frequencies of the motion is an in-talk of −1/(2π·frequency)², which the search shall know as
            // its rival.
            Coordinate { step: 0.1, ..Coordinate::scale(self.frequency_hz, 1.0, 1000.0) },
            // A more strongly damped mode cannot be distinguished from a latency.
            Coordinate::scale(self.damping_ratio, 0.001, 0.3),
        ];
        if self.fits_participation {
            coordinates.push(Coordinate::signed(self.participation, 0.01, 10.0));
        }
        coordinates
    }

    fn at(&self, x: &[f64]) -> Self {
        let participation = if self.fits_participation { x[2] } else { self.participation };
        Self { frequency_hz: x[0], damping_ratio: x[1], participation, ..*self }
    }

    fn values(&self) -> Vec<f64> {
        let mut values = vec![self.frequency_hz, self.damping_ratio];
        if self.has_participation() {
            values.push(self.participation);
        }
        values
    }

    fn lengths(&self) -> Vec<usize> {
        vec![1; if self.has_participation() { 3 } else { 2 }]
    }

    fn distinction(&self) -> Distinction<'_> {
        Distinction::Frequency(self.frequency_hz)
    }

    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let stretch = context.hides_stretch().then_some(Imitation::STRETCH);
        stretch.into_iter().chain(context.displaced_head(Some(self.static_s2()))).collect()
    }

    fn among_several(&self) -> Option<Self> {
        (!self.fits_participation).then(|| Self { fits_participation: true, ..self.clone() })
    }

    /// Far below its frequency every mode lags alike, so that a fit ends at any frequency near that with which it started. The lag is
    /// kept.
    fn other_starts(&self) -> Vec<Self> {
        let at = |guess: Self| {
            let ratio = guess.frequency_hz / self.frequency_hz;
            Self { participation: self.participation * ratio * ratio, ..guess }
        };
        Self::second_modes().map(at).collect()
    }

    fn mode(&self) -> Option<Mode> {
        let Self { frequency_hz, damping_ratio, participation, .. } = *self;
        Some(Mode { frequency_hz, damping_ratio, participation })
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::Compensated {
            does: "the command leads by the lag of the tool, 2·ζ/ω (Kf) and 1/ω² per commanded acceleration",
            also: format!(
                "against the oscillation that steps of the acceleration excite, limit the jerk, or set smoothing_s = {:.4}, one \
                 period, on all axes of the machine file",
                self.frequency_hz.recip()
            ),
        }
    }

    fn sentence(&self, wording: &Wording) -> String {
        let mode = format!(
            "the tool oscillates relative to the table at {}, with a damping ratio of {}",
            wording.value(0),
            wording.value(1)
        );
        if self.has_participation() {
            return format!("{mode} and a participation of {}", wording.value(2));
        }
        mode
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}
