//! Resonance: the tool oscillates relative to the table.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Channel, Coordinate, DampedAgainst, Distinction, EffectCompensation, EffectContext,
    EffectModel, Imitation, ImitationContext, Misplaced, Mode, Occurrence, Parameter, Placement, Range,
    Stage, Unit, Wording,
};

/// Tool − table = participation·(H − 1)·table, H = ω²/(s² + 2ζωs + ω²), or (2ζωs + ω²)/(s² + 2ζωs + ω²) where the damper acts against
/// the table: that is −participation·s²/(s² + 2ζωs + ω²)·table. The contributions of several modes add up (modal
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
    /// Against what its damper acts.
    #[serde(default, skip_serializing_if = "DampedAgainst::is_ground")]
    pub damped_against: DampedAgainst,
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

    /// First modes with which a fit starts. One that is damped against the ground lags at every speed: of a mode that is damped against the
    /// table it explains nothing.
    fn first_modes() -> impl Iterator<Item = Self> {
        let of_tool = [15.0, 30.0, 60.0, 120.0, 240.0, 480.0].map(|hz| Self::of_tool(hz, 0.05));
        of_tool.into_iter().flat_map(|mode| [mode.clone(), mode.on_table()])
    }

    /// Second modes with which a fit starts, without any participation yet.
    fn second_modes() -> impl Iterator<Item = Self> {
        (0..22).map(|power| Self {
            participation: 0.0,
            fits_participation: true,
            ..Self::of_tool(15.0 * GUESS_RATIO.powi(power), 0.05)
        })
    }

    /// This mode with its damper against the table.
    fn on_table(self) -> Self {
        Self { damped_against: DampedAgainst::Table, ..self }
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
            damped_against: DampedAgainst::Ground,
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
    const OPTIONAL_NAMED_KEYS: &'static [(&'static str, &'static str)] =
        &[("damped_against", "`ground` (default) or `table`: where its damper acts")];
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
            0 => Self::first_modes().collect(),
            // Of those on the table every other one: its fit starts again at all frequencies.
            1 => Self::second_modes().chain(Self::second_modes().step_by(2).map(Self::on_table)).collect(),
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
            let participation = self.participation * ratio * ratio;
            Self { participation, damped_against: self.damped_against, ..guess }
        };
        Self::second_modes().map(at).collect()
    }

    fn other_form(&self) -> Option<Self> {
        Some(Self { damped_against: self.damped_against.other(), ..self.clone() })
    }

    fn mode(&self) -> Option<Mode> {
        let Self { frequency_hz, damping_ratio, participation, damped_against, .. } = *self;
        Some(Mode { frequency_hz, damping_ratio, participation, damped_against })
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::Compensated {
            does: match self.damped_against {
                DampedAgainst::Ground => {
                    "the command leads by the lag of the tool, 2·ζ/ω (Kf) and 1/ω² per commanded acceleration"
                }
                DampedAgainst::Table => {
                    "the command leads by the lag of the tool, 1/ω² per commanded acceleration"
                }
            },
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
        let participation =
            self.has_participation().then(|| format!(" and a participation of {}", wording.value(2)));
        let damper = match self.damped_against {
            DampedAgainst::Ground => "",
            DampedAgainst::Table => "; its damping acts between table and tool",
        };
        mode + participation.as_deref().unwrap_or("") + damper
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Acceleration
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Effect;

    const ON_TABLE: &str = "name = \"resonance\"\nchannel = \"tool\"\nfrequency_hz = 60.0\ndamping_ratio = 0.1\ndamped_against = \"table\"\n";

    #[test]
    fn the_damper_is_read_and_written_where_it_is_not_at_the_ground() {
        let read = |text: &str| toml::from_str::<Effect>(text).unwrap();
        let on_table = read(ON_TABLE);
        assert_eq!(toml::to_string(&on_table).unwrap(), ON_TABLE);
        assert!(on_table.sentence(&[], false).ends_with("; its damping acts between table and tool"));
        // A file without the key is written as it was read.
        let without = ON_TABLE.replace("damped_against = \"table\"\n", "");
        assert_eq!(toml::to_string(&read(&without)).unwrap(), without);
        assert_eq!(read(&without), read(&ON_TABLE.replace("\"table\"", "\"ground\"")));
        assert_eq!(on_table.other_form(), Some(read(&without)));
    }

    /// 2ζ/ω = 2·0.1/(2π·60 Hz) = 0.53 ms where the damper is at the ground, none where it is at the table; 1/ω² of both.
    #[test]
    fn a_damper_at_the_table_makes_no_lag_in_time() {
        let ground = Resonance::of_tool(60.0, 0.1);
        let lag_s = |mode: &Resonance| mode.mode().unwrap().lag_s();
        let omega = std::f64::consts::TAU * 60.0;
        assert!((lag_s(&ground) - 0.2 / omega).abs() < 1e-15);
        let on_table = ground.clone().on_table();
        assert_eq!((lag_s(&on_table), on_table.static_s2()), (0.0, ground.static_s2()));
        let does = |mode: &Resonance| mode.compensation().description();
        assert!(does(&ground).contains("2·ζ/ω") && !does(&on_table).contains("2·ζ/ω"));
    }
}
