//! Presliding: friction reverses over micrometres of travel.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence,
    Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::Settings;

/// Bristles of stiffness σ0 and damping σ1 (`LuGre`) that the table deflects before it slides, on an axis whose machine
/// file declares none. At a reversal, friction reverses over a travel in the order of Coulomb friction/σ0 instead of
/// instantaneously.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Presliding {
    /// σ0.
    pub stiffness_n_per_um: f64,
    /// σ1.
    #[serde(default)]
    pub damping_n_s_per_m: f64,
}

impl EffectModel for Presliding {
    const NAME: &'static str = "presliding";
    const SUMMARY: &'static str =
        "bristles (LuGre σ0, σ1) on an axis that declares none: friction reverses over micrometres";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("stiffness_n_per_um", Unit::NewtonPerMicrometre, Range::Positive),
        Parameter::new("damping_n_s_per_m", Unit::NewtonSecondPerMetre, Range::NotNegative),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Force];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        let is_declared = axis.mechanics.presliding_stiffness_n_per_um.is_some();
        Prerequisite::needs(!is_declared, "a machine file that declares no presliding")
            .and(Prerequisite::WITHOUT_TABLE)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        if place.axis.mechanics.presliding_stiffness_n_per_um.is_some() {
            return Some(Misplaced::name(
                "this effect only where presliding_stiffness_n_per_um is not given",
            ));
        }
        let slides = place.axis.mechanics.coulomb_n.unwrap_or(0.0) > 0.0;
        (!slides).then(|| Misplaced::name("this effect only where coulomb_n is above 0"))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_declared = context.axis.mechanics.presliding_stiffness_n_per_um.is_some();
        let slides = context.axis.mechanics.coulomb_n.is_some_and(|coulomb_n| coulomb_n > 0.0);
        let travels_um: &[f64] =
            if context.shows_friction_alone() && slides && !is_declared { &[5.0, 20.0] } else { &[] };
        let coulomb_n = context.axis.mechanics.coulomb_n.unwrap_or(0.0);
        let guess =
            |travel_um: &f64| Self { stiffness_n_per_um: coulomb_n / travel_um, damping_n_s_per_m: 0.0 };
        travels_um.iter().map(guess).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            // The derivative depends strongly on the stiffness: one step changes it by a factor of at most two.
            Coordinate::between(
                self.stiffness_n_per_um,
                0.05 * self.stiffness_n_per_um,
                0.5 * self.stiffness_n_per_um,
                2.0 * self.stiffness_n_per_um,
            )
            .stepwise(),
            Coordinate::between(self.damping_n_s_per_m, 100.0, 0.0, 2.0 * self.damping_n_s_per_m + 500.0)
                .stepwise(),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { stiffness_n_per_um: x[0], damping_n_s_per_m: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.stiffness_n_per_um, self.damping_n_s_per_m]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::FRICTION
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "before the axis slides, friction acts as a spring of stiffness {} and damping {}",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
