//! Wind-up computed from the measured force, for an axis without declared masses.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence,
    Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Lowest compliance, of a practically rigid drive train, µm/N.
const MIN_COMPLIANCE: f64 = 1e-6;

/// Highest compliance, µm/N: no drive train deflects by 1 mm/N.
const MAX_COMPLIANCE: f64 = 1e3;

/// Deflection of the drive train = (drive force − friction·direction) / stiffness. In machine files the name is `windup`
/// as well; the key `friction_n` distinguishes this effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceWindup {
    /// Stiffness between motor and table.
    pub stiffness_n_per_um: f64,
    /// Friction of the motor and of all parts before the gear. It does not deflect the drive train.
    pub friction_n: f64,
    /// Travel constant with which that friction reverses (Dahl, 1968). Absent: it reverses with the direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub presliding_mm: Option<f64>,
}

impl ForceWindup {
    /// Lag of the table behind the motor, µm, at a measured force. The direction of travel is from −1 to 1.
    #[must_use]
    pub fn deflection_um(&self, force_n: f64, direction: f64) -> f64 {
        (force_n - self.friction_n * direction) / self.stiffness_n_per_um
    }
}

impl EffectModel for ForceWindup {
    const NAME: &'static str = "windup";
    const DISTINGUISHING_KEY: Option<&'static str> = Some("friction_n");
    const SUMMARY: &'static str =
        "deflection of the drive train by the measured force less the friction before the drive train";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("stiffness_n_per_um", Unit::NewtonPerMicrometre, Range::Positive),
        Parameter::new("friction_n", Unit::Newton, Range::NotNegative),
        Parameter::new("presliding_mm", Unit::Millimetre, Range::Positive),
    ];
    const NEEDS_FORCE: bool = true;
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if axis.has_mass() {
            return Prerequisite::NotApplicable;
        }
        Prerequisite::Needs("a force channel in every log that is fitted")
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let expected = "no such key, as masses are given".to_owned();
        place.axis.has_mass().then_some(Misplaced { key: "friction_n", expected })
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        if context.axis.has_mass() || !context.has(Stage::Table) {
            return Vec::new();
        }
        let guess =
            |presliding_mm| Self { stiffness_n_per_um: 1.0 / MIN_COMPLIANCE, friction_n: 0.0, presliding_mm };
        [None, Some(0.03), Some(0.3)].map(guess).to_vec()
    }

    /// The compliance, µm/N, and friction times compliance, µm: the model is linear in both. Then the travel constant of a
    /// reversal, mm.
    fn coordinates(&self) -> Vec<Coordinate> {
        let per_um = 1.0 / self.stiffness_n_per_um;
        let reversal = self.presliding_mm.map(|mm| Coordinate::scale(mm, 1e-3, 10.0));
        // The lower bound is not a limit of the search: at zero compliance there is no effect.
        let per_um = Coordinate::between(per_um, 0.01, MIN_COMPLIANCE, MAX_COMPLIANCE);
        [
            Coordinate { limits: [f64::NEG_INFINITY, MAX_COMPLIANCE], ..per_um },
            Coordinate::between(self.friction_n * per_um.value, 0.1, 0.0, 1e4),
        ]
        .into_iter()
        .chain(reversal)
        .collect()
    }

    fn at(&self, x: &[f64]) -> Self {
        Self {
            stiffness_n_per_um: 1.0 / x[0],
            friction_n: x[1] / x[0],
            presliding_mm: self.presliding_mm.and_then(|_| x.get(2).copied()),
        }
    }

    /// At a compliance near the lower bound, the fitted effect is friction rather than wind-up.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        1.0 / self.stiffness_n_per_um > 10.0 * MIN_COMPLIANCE
    }

    fn values(&self) -> Vec<f64> {
        [self.stiffness_n_per_um, self.friction_n].into_iter().chain(self.presliding_mm).collect()
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the stretch follows the measured force, for which the model has no masses",
            "declare the masses and trace again",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        let reversal = self
            .presliding_mm
            .map_or_else(String::new, |_| format!(" and reverses over {}", wording.value(2)));
        format!(
            "the drive {} deflects the drive train, whose stiffness is {} between motor and table; friction before the \
             drive train is {}{reversal}",
            wording.by_axis("force", "torque"),
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Force
    }
}
