//! Thermal growth: screw or scale become longer while the machine warms up.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, EffectCompensation, EffectContext, EffectModel, Occurrence, Parameter,
    Range, Stage, Unit, Wording,
};

/// The part that grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GrowingPart {
    /// The screw: the table moves further than the motor says.
    Screw,
    /// The linear scale: it reads less than the table moves.
    Scale,
}

/// Length of the part = (1 + growth·(1 − exp(−t/τ))) times its length at time zero of the session clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThermalGrowth {
    /// The part that grows.
    pub part: GrowingPart,
    /// Final relative growth.
    pub um_per_m: f64,
    /// τ.
    pub time_constant_s: f64,
}

impl ThermalGrowth {
    /// Growth over a distance, m, until a time of the session (s).
    fn over_m(&self, table_m: f64, time_s: f64) -> f64 {
        -1e-6 * self.um_per_m * libm::expm1(-time_s / self.time_constant_s) * table_m
    }

    /// Change of the scale's reading at a position of the table without growth, m, at a time of the session (s).
    #[must_use]
    pub fn reading_m(&self, table_m: f64, time_s: f64) -> f64 {
        match self.part {
            GrowingPart::Screw => self.over_m(table_m, time_s),
            GrowingPart::Scale => -self.over_m(table_m, time_s),
        }
    }

    /// Displacement of the table and the tool on it, m.
    #[must_use]
    pub fn displacement_m(&self, table_m: f64, time_s: f64) -> f64 {
        match self.part {
            GrowingPart::Screw => self.over_m(table_m, time_s),
            GrowingPart::Scale => 0.0,
        }
    }

    /// The growth of the other part that the scale reads alike.
    #[must_use]
    const fn as_growth_of_scale(&self) -> Self {
        Self { part: GrowingPart::Scale, um_per_m: -self.um_per_m, time_constant_s: self.time_constant_s }
    }
}

impl EffectModel for ThermalGrowth {
    const NAME: &'static str = "thermal_growth";
    const SUMMARY: &'static str =
        "screw or scale grow by growth·(1 − exp(−t/τ)), t on the session clock; the probe tells which";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("um_per_m", Unit::MicrometrePerMetre, Range::Signed),
        Parameter::new("time_constant_s", Unit::Second, Range::Positive),
    ];
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[("part", "`screw` or `scale`")];
    const CONTAINS: &'static [&'static str] = &["pitch_progressive"];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Tool]
    }

    /// A growth of the scale is the same in the table stage; the tool stage decides between them.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let start = |time_constant_s| Self { part: GrowingPart::Screw, um_per_m: 0.0, time_constant_s };
        if context.has(Stage::Table) { [20.0, 200.0].map(start).to_vec() } else { Vec::new() }
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::signed(self.um_per_m, 5.0, 1e5), Coordinate::scale(self.time_constant_s, 0.5, 5e3)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { part: self.part, um_per_m: x[0], time_constant_s: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.um_per_m, self.time_constant_s]
    }

    fn of_scale(&self) -> Option<AnyEffect> {
        (self.part == GrowingPart::Screw).then(|| AnyEffect::new(self.as_growth_of_scale()))
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the controller has no table of the position that changes with time",
            "warm the machine up, close the loop by the scale, or correct the scale by its temperature",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let part = match self.part {
            GrowingPart::Screw => wording.by_axis("screw", "gear"),
            GrowingPart::Scale => "linear scale",
        };
        format!(
            "the {part} {} by {} while the machine warms up, with a time constant of {}",
            wording.by_sign("grows", "shrinks"),
            wording.size(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Time
    }
}
