//! Gear hysteresis: a gear carries more torque while it is wound up than while it is released.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Neighbours, Occurrence,
    Parameter, Placement, Prerequisite, Range, Stage, Unit, Wording,
};
use crate::axis::{KeyNames, Settings};

/// Number of elements of the loop.
const ELEMENTS: usize = 8;

/// Stretch at which each element slips, in multiples of the travel: the quantiles 1/16, 3/16 to 15/16 of the distribution x·exp(−x), of which infinitely
/// many elements carry 1 − exp(−s/travel) of their force.
const SLIPS_AT: [f64; ELEMENTS] = [0.404, 0.79, 1.132, 1.486, 1.887, 2.381, 3.08, 4.472];

/// Adds force·z to what the elastic drive train carries. z, from −1 to 1, is the mean of eight elements in parallel that stick in proportion to the stretch, and slip
/// at ±1 (Maxwell slip; Iwan, 1966): the friction within a strain wave gear or a belt, with which the torsion over the torque is a loop. Unlike in Dahl's model,
/// which the elements approach, noise of the stretch does not make the state decay.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GearHysteresis {
    /// Half of the width of the loop, as a force.
    pub force_n: f64,
    /// Stretch of a drive train without load in which 1 − 1/e of the force is reached.
    pub travel_um: f64,
}

/// What the elements of a loop carry, −1 to 1 each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopState([f64; ELEMENTS]);

impl LoopState {
    /// Mean of the elements.
    #[must_use]
    #[inline]
    pub fn mean(self) -> f64 {
        self.0.iter().sum::<f64>() / ELEMENTS as f64
    }
}

impl GearHysteresis {
    /// Whether there is a loop.
    #[must_use]
    #[inline]
    pub fn acts(&self) -> bool {
        self.force_n != 0.0 && self.travel_um > 0.0
    }

    /// The state after the drive train has stretched by some m.
    #[must_use]
    #[inline]
    pub fn after(&self, mut state: LoopState, stretched_m: f64) -> LoopState {
        let travels = stretched_m / (1e-6 * self.travel_um);
        for (carried, slips_at) in state.0.iter_mut().zip(SLIPS_AT) {
            *carried = (*carried + travels / slips_at).clamp(-1.0, 1.0);
        }
        state
    }

    /// Force of a state, N.
    #[must_use]
    #[inline]
    pub fn carried_n(&self, state: LoopState) -> f64 {
        self.force_n * state.mean()
    }

    /// Stiffness of the elements that stick after a stretch from nothing, m; N/m.
    #[must_use]
    pub fn sticking_n_per_m(&self, stretch_m: f64) -> f64 {
        if !self.acts() {
            return 0.0;
        }
        let travels = stretch_m.abs() / (1e-6 * self.travel_um);
        let sticking =
            SLIPS_AT.iter().filter(|slips_at| travels < **slips_at).map(|slips_at| slips_at.recip());
        1e6 * self.force_n / self.travel_um * sticking.sum::<f64>() / ELEMENTS as f64
    }
}

impl EffectModel for GearHysteresis {
    const NAME: &'static str = "gear_hysteresis";
    const SUMMARY: &'static str = "loop of the force over the stretch between motor and table, of a gear or a belt: eight elements that stick and slip (Maxwell slip)";
    const PARAMETERS: &'static [Parameter] = &[
        // Where the stretch stays below 0.7 travels, force and travel are known by their ratio only: the fit has many optima along it, of which
        // each seems sharp. Of 30 gears of the second simulator, the one that was furthest off was so by 39 and 33 %.
        Parameter { model_error: 0.4, ..Parameter::new("force_n", Unit::Newton, Range::Positive) },
        Parameter { model_error: 0.4, ..Parameter::new("travel_um", Unit::Micrometre, Range::Positive) },
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Table];

    fn prerequisite(axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        if !axis.has_mass() || axis.names != KeyNames::Rotary {
            return Prerequisite::NotApplicable;
        }
        Prerequisite::elastic(axis)
    }

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        let what = "this effect only where the stiffness between motor and table is given, and not with a structure of bodies";
        (place.axis.is_rigid() || place.has_structure).then(|| Misplaced::name(what))
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Table, Stage::Force, Stage::Motor]
    }

    /// Of a rotary axis: a screw has no loop of its own. A tenth of the load that friction makes, and all of it, within the stretch under it.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let mechanics = &context.axis.mechanics;
        let may_be = context.axis.names == KeyNames::Rotary && context.axis.has_mass();
        let declared = mechanics.stiffness_n_per_um.zip(mechanics.coulomb_n).filter(|_| may_be);
        let guess = |(stiffness_n_per_um, coulomb_n): (f64, f64)| {
            let travel_um = (coulomb_n / stiffness_n_per_um).max(LEAST_TRAVEL_UM);
            [0.1, 1.0].map(|part| Self { force_n: (part * coulomb_n).max(LEAST_FORCE_N), travel_um })
        };
        declared.into_iter().flat_map(guess).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        vec![
            Coordinate::scale(self.force_n, LEAST_FORCE_N, 1e6),
            Coordinate::scale(self.travel_um, LEAST_TRAVEL_UM, 1e4),
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { force_n: x[0], travel_um: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.force_n, self.travel_um]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::not(
            "the stretch that the controller adds to the command has no loop",
            "close the loop by the encoder of the table",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the {} has hysteresis: it carries {} more while it is wound up than at the middle of the loop, and turns over within {} of stretch",
            wording.by_axis("drive train", "gear"),
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Force
    }
}

/// Smallest half of a loop of the search, N.
const LEAST_FORCE_N: f64 = 1e-3;

/// Smallest stretch of the search, µm.
const LEAST_TRAVEL_UM: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::*;

    /// After one travel from nothing 1 − 1/e of the force, within what eight elements leave of a curve; the whole force after the last has slipped. Between two
    /// stretches, the loop is closed and symmetric from the second time on, and a smaller cycle within it does not move it.
    #[test]
    fn the_loop_is_closed() {
        let gear = GearHysteresis { force_n: 10.0, travel_um: 4.0 };
        let fresh = gear.carried_n(gear.after(LoopState::default(), 4e-6));
        assert!((fresh / 10.0 / (1.0 - (-1f64).exp()) - 1.0).abs() < 0.02, "{fresh}");
        assert!((gear.carried_n(gear.after(LoopState::default(), 4.6 * 4e-6)) - 10.0).abs() < 1e-12);
        let mut state = gear.after(LoopState::default(), 6e-6);
        for _ in 0..2 {
            state = gear.after(state, -12e-6);
            let low = state;
            for _ in 0..1000 {
                state = gear.after(gear.after(state, 1e-6), -1e-6);
            }
            assert!((state.mean() - low.mean()).abs() < 1e-9);
            state = gear.after(state, 12e-6);
            assert!((state.mean() + low.mean()).abs() < 1e-9, "{state:?} {low:?}");
        }
        let slope = gear.carried_n(gear.after(LoopState::default(), 1e-9)) / 1e-9;
        assert!((slope / gear.sticking_n_per_m(0.0) - 1.0).abs() < 1e-9, "{slope}");
    }
}
