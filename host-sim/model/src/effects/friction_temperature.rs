//! Friction temperature: friction changes with the temperature of guide and lubricant.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Neighbours, Occurrence, Parameter,
    Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Changes the sliding level of the guideway in proportion to temperature − reference, and its viscous friction exponentially with it, as the
/// viscosity of a lubricant falls: by Reynolds' law η = η0·exp(k·(T − T0)), with k of −2 to −6 % per degree for oils and greases.
///
/// The temperature is that of the log's channel `NAME_temperature_c`. A simulation, which has none, is at the reference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrictionTemperature {
    /// Temperature at which friction is as declared; not fitted.
    pub reference_c: f64,
    /// Change of the sliding level per degree.
    pub level_n_per_c: f64,
    /// k: relative change of the viscous friction per degree; negative: it falls with the temperature.
    pub viscous_percent_per_c: f64,
    /// Time by which the reading is behind the temperature of guide and lubricant; negative: ahead of it, as of a sensor at the source of the
    /// heat.
    pub sensor_late_s: f64,
}

impl Default for FrictionTemperature {
    /// No change.
    fn default() -> Self {
        Self::at_reference(20.0)
    }
}

impl FrictionTemperature {
    /// No change, relative to a temperature, °C.
    #[must_use]
    pub const fn at_reference(reference_c: f64) -> Self {
        Self { reference_c, level_n_per_c: 0.0, viscous_percent_per_c: 0.0, sensor_late_s: 0.0 }
    }

    /// Whether friction depends on the temperature.
    #[must_use]
    #[inline]
    pub fn changes(&self) -> bool {
        self.level_n_per_c != 0.0 || self.viscous_percent_per_c != 0.0
    }

    /// Change of the sliding level, N, at a temperature, °C.
    #[must_use]
    #[inline]
    pub fn rise_n(&self, temperature_c: f64) -> f64 {
        self.level_n_per_c * (temperature_c - self.reference_c)
    }

    /// Change of the viscous friction at a temperature, °C, relative to that at the reference.
    #[must_use]
    #[inline]
    pub fn viscous_change(&self, temperature_c: f64) -> f64 {
        libm::expm1(0.01 * self.viscous_percent_per_c * (temperature_c - self.reference_c))
    }
}

fn has_viscous_friction(axis: &Settings) -> bool {
    axis.mechanics.viscous_n_s_per_m.is_some_and(|viscous| viscous > 0.0)
}

impl EffectModel for FrictionTemperature {
    const NAME: &'static str = "friction_temperature";
    const SUMMARY: &'static str = "sliding level changes in proportion to temperature − reference, viscous friction by the factor exp(k·(temperature − reference)), which a sensor reads late; the reference is not fitted";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("reference_c", Unit::DegreeCelsius, Range::Signed),
        Parameter::new("level_n_per_c", Unit::NewtonPerDegreeCelsius, Range::Signed),
        Parameter::new("viscous_percent_per_c", Unit::PercentPerDegreeCelsius, Range::Signed),
        Parameter::new("sensor_late_s", Unit::Second, Range::Signed),
    ];
    const READS_TEMPERATURE: bool = true;
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force, Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::masses(axis)
            .and(Prerequisite::needs(has_viscous_friction(axis), "viscous_n_s_per_m in the machine file"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Table, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let mean_c = context
            .logged
            .temperature_c
            .filter(|_| context.axis.has_mass() && has_viscous_friction(context.axis));
        mean_c.into_iter().map(Self::at_reference).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::signed(self.level_n_per_c, 0.1, 1e4),
            Coordinate::signed(self.viscous_percent_per_c, 0.1, 30.0),
            Coordinate::signed(self.sensor_late_s, 0.5, 30.0),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { level_n_per_c: x[0], viscous_percent_per_c: x[1], sensor_late_s: x[2], ..*self }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.reference_c, self.level_n_per_c, self.viscous_percent_per_c, self.sensor_late_s]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the controller does not read the temperature of the guide",
            "trace again, and load the compensation anew, at the temperature at which the machine works",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "friction depends on the temperature: relative to {}, each degree changes the sliding level by {} and the viscous friction by {}; the reading is {} behind it",
            wording.value(0),
            wording.value(1),
            wording.value(2),
            wording.value(3)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Time
    }
}
