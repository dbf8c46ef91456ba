//! Stribeck effect of the motor: its friction increases towards standstill.

use serde::{Deserialize, Serialize};

use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence,
    Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;
use crate::friction_law::stribeck_rise_n;

/// Adds excess·exp(−(v/vs)²) to the Coulomb friction of the motor and its bearings. Unlike friction of the guideway, it
/// does not stretch the screw; a linear scale tells both apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotorStribeck {
    /// Friction at standstill above the Coulomb friction of the motor.
    pub static_excess_n: f64,
    /// vs, at the table.
    pub velocity_mm_s: f64,
}

impl Default for MotorStribeck {
    /// No excess; the velocity is typical of greased bearings.
    fn default() -> Self {
        Self { static_excess_n: 0.0, velocity_mm_s: 5.0 }
    }
}

impl MotorStribeck {
    /// Change of the motor's Coulomb friction at a velocity, N.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, velocity_m_per_s: f64) -> f64 {
        stribeck_rise_n(self.static_excess_n, self.velocity_mm_s, velocity_m_per_s)
    }
}

impl EffectModel for MotorStribeck {
    const NAME: &'static str = "motor_stribeck";
    const SUMMARY: &'static str =
        "friction of the motor increases by static_excess·exp(−(v/vs)²) towards standstill";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("static_excess_n", Unit::Newton, Range::NotNegative),
        Parameter::new("velocity_mm_s", Unit::MillimetrePerSecond, Range::Positive),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    /// On a rigid axis, friction of motor and guideway are one force.
    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let is_elastic = Prerequisite::elastic(axis);
        let table = Prerequisite::Needs("logs with a force and a table channel");
        Prerequisite::masses(axis).and(is_elastic).and(table)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where motor_mass_kg is given: it acts on the motor";
        let has_motor = place.axis.mechanics.motor_mass_kg.is_some() || place.has_structure;
        (!has_motor).then(|| Misplaced::name(what))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_separable = context.axis.has_mass()
            && !context.axis.is_rigid()
            && context.has(Stage::Force)
            && context.has(Stage::Table);
        let speeds: &[f64] = if is_separable { &[2.0, 8.0, 30.0] } else { &[] };
        speeds.iter().map(|&velocity_mm_s| Self { static_excess_n: 0.0, velocity_mm_s }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::between(self.static_excess_n, 2.0, 0.0, 1e5),
            Coordinate::scale(self.velocity_mm_s, 0.1, 300.0),
        ]
    }

    /// At lower speeds, the smoothed sign of Coulomb friction is not yet one.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        self.velocity_mm_s > 0.5
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { static_excess_n: x[0], velocity_mm_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.static_excess_n, self.velocity_mm_s]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction of the motor increases by {} towards standstill, with a Stribeck velocity of {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
