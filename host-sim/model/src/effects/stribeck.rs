//! Stribeck effect: friction increases towards standstill.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Imitation, ImitationContext,
    Neighbours, Occurrence, Parameter, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;
use crate::friction_law::stribeck_rise_n;

/// Adds excess·exp(−(v/vs)²) to the sliding level of Coulomb friction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Friction at standstill above Coulomb friction.
    pub static_excess_n: f64,
    /// vs.
    pub velocity_mm_s: f64,
}

impl Default for Stribeck {
    /// No excess; the velocity is typical of lubricated guides.
    fn default() -> Self {
        Self { static_excess_n: 0.0, velocity_mm_s: 5.0 }
    }
}

impl Stribeck {
    /// Change of the sliding level at a velocity, N.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, velocity_m_per_s: f64) -> f64 {
        stribeck_rise_n(self.static_excess_n, self.velocity_mm_s, velocity_m_per_s)
    }
}

impl EffectModel for Stribeck {
    const NAME: &'static str = "stribeck";
    const SUMMARY: &'static str = "friction increases by static_excess·exp(−(v/vs)²) towards standstill";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("static_excess_n", Unit::Newton, Range::NotNegative),
        Parameter::new("velocity_mm_s", Unit::MillimetrePerSecond, Range::Positive),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];
    const DRAW_NUMBER: Option<u32> = Some(4);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let speeds: &[f64] = if context.axis.has_mass() { &[2.0, 8.0, 30.0] } else { &[] };
        let start = |&velocity_mm_s: &f64| Self { static_excess_n: 0.0, velocity_mm_s };
        speeds.iter().map(start).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::between(self.static_excess_n, 2.0, 0.0, 1e5),
            Coordinate::scale(self.velocity_mm_s, 0.1, 300.0),
        ]
    }

    /// At lower speeds the axis is in presliding; a change of friction there is not one of the sliding level.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.velocity_mm_s > 0.5
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { static_excess_n: x[0], velocity_mm_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.static_excess_n, self.velocity_mm_s]
    }

    /// The logged force is that of the last velocity tick of a sample. Without Kv, how it differs from the mean is not known, which
    /// shows where the force changes fast: at reversals.
    fn imitations(&self, context: &ImitationContext<'_>) -> Vec<Imitation> {
        let is_sampled = context.rates.position_loop_divider > 1;
        let is_gain_unknown = context.axis.controller.velocity_gain_n_s_per_m.is_none();
        let sampling = Imitation {
            name: "force_sampling",
            clause: "the logged force is not the mean of its sample",
            decided_by: "velocity_gain_n_s_per_m in the machine file",
        };
        if is_sampled && is_gain_unknown { vec![sampling] } else { Vec::new() }
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction increases by {} towards standstill, with a Stribeck velocity of {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        Some(Self { static_excess_n: draw.between(70.0, 150.0), velocity_mm_s: draw.between(3.0, 10.0) })
    }
}
