//! Wind-up: the stiffness of the drive train is far below the declared one.

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use super::declaration::{
    Abscissa, AnyEffect, Coordinate, Draw, EffectCompensation, EffectContext, EffectModel, Misplaced,
    Neighbours, Occurrence, Parameter, Placement, Prerequisite, Range, ResidualShape, Stage, Unit, Wording,
};
use super::stiffness_map::StiffnessMap;
use crate::axis::Settings;

/// Replaces the declared stiffness k between motor and table. Without damping, motor − table = F/k for the force F that the
/// drive train transmits (Hooke's law); `plant::screw::Spring` is the simulated element.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Windup {
    /// The true stiffness.
    pub stiffness_n_per_um: f64,
}

/// A stiffness is a wind-up if it is lower than the declared one by more than this many tolerances. A smaller deviation is
/// fitted as a declared value, and reported if it exceeds the tolerance.
const MIN_TOLERANCES: f64 = 2.0;

impl Windup {
    /// The stiffness below which the deviation from the declared stiffness, with its relative tolerance, is a wind-up.
    #[must_use]
    pub fn max_stiffness(declared: f64, tolerance: f64) -> f64 {
        (1.0 - MIN_TOLERANCES * tolerance) * declared
    }
}

impl EffectModel for Windup {
    const NAME: &'static str = "windup";
    const SUMMARY: &'static str =
        "stiffness between motor and table lower than the declared one by more than twice its tolerance";
    const PARAMETERS: &'static [Parameter] =
        &[Parameter::new("stiffness_n_per_um", Unit::NewtonPerMicrometre, Range::Positive)];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table, Stage::Force];
    const DRAW_NUMBER: Option<u32> = Some(15);

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if !axis.has_mass() {
            return Prerequisite::NotApplicable;
        }
        Prerequisite::elastic(axis)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where stiffness_n_per_um is given: a rigid axis has no wind-up";
        (place.axis.is_rigid() && !place.has_structure).then(|| Misplaced::name(what))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_driven_by_force = !context.axis.has_mass() && context.has(Stage::Table);
        let declared = context.axis.mechanics.stiffness_n_per_um.filter(|_| !is_driven_by_force);
        declared.into_iter().map(|stiffness| Self { stiffness_n_per_um: 0.8 * stiffness }).collect()
    }

    /// The compliance, nm/N, as the deflection is proportional to it.
    fn coordinates(&self) -> Vec<Coordinate> {
        vec![Coordinate::scale(1e3 / self.stiffness_n_per_um, 1e-2, 1e6)]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { stiffness_n_per_um: 1e3 / x[0] }
    }

    /// A higher stiffness is fitted as a declared value.
    fn exceeds_tolerance(&self, declared: &Settings, _rates: Rates) -> bool {
        let tolerance = declared.tolerance("stiffness_n_per_um");
        declared
            .mechanics
            .stiffness_n_per_um
            .is_some_and(|stiffness| self.stiffness_n_per_um < Self::max_stiffness(stiffness, tolerance))
    }

    fn variation(&self, residual: &dyn Fn() -> ResidualShape, travel_mm: [f64; 2]) -> Option<AnyEffect> {
        residual().stiffness_knots.map(|count| AnyEffect::new(StiffnessMap::constant(travel_mm, count)))
    }

    fn values(&self) -> Vec<f64> {
        vec![self.stiffness_n_per_um]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by("the stretch under the modelled force is added to the command")
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!("the stiffness between motor and table is {}, far below the declared one", wording.value(0))
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Force
    }

    fn draw(draw: &mut Draw<'_>) -> Option<Self> {
        let declared = draw.axis.mechanics.stiffness_n_per_um.unwrap_or(100.0);
        Some(Self { stiffness_n_per_um: declared * draw.between(0.5, 0.75) })
    }
}
