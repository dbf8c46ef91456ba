//! Load angle: friction and inertia turn the rotor of a stepper motor away from its command.

use serde::{Deserialize, Serialize};

use super::declaration::{
    Abscissa, Coordinate, EffectCompensation, EffectContext, EffectModel, Misplaced, Occurrence, Parameter,
    Placement, Range, Stage, Unit, Wording,
};
use crate::axis::Drive;

/// The field of the motor is a spring between command and rotor: sliding friction stretches it against the motion, to the other side
/// after a reversal; acceleration stretches it by inertia over stiffness.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadAngle {
    /// Displacement under sliding friction.
    pub friction_um: f64,
    /// Displacement per acceleration.
    #[serde(default)]
    pub um_s2_per_m: f64,
}

impl EffectModel for LoadAngle {
    const NAME: &'static str = "load_angle";
    const SUMMARY: &'static str =
        "lag of a stepper motor behind its command, by sliding friction and by acceleration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new("friction_um", Unit::Micrometre, Range::NotNegative),
        Parameter::new("um_s2_per_m", Unit::MicrometrePerAcceleration, Range::NotNegative),
    ];
    const OCCURRENCE: Occurrence = Occurrence::Once;
    const SHOWN_IN: &'static [Stage] = &[Stage::Motor];
    const DRIVES: &'static [Drive] = &[Drive::Stepper];

    fn misplaced(&self, place: &Placement<'_>) -> Option<Misplaced> {
        Misplaced::unless_stepper(place)
    }

    fn stages(&self) -> &'static [Stage] {
        &[Stage::Motor]
    }

    /// Only the motor's own reading parts it from the lost motion behind it.
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self> {
        let is_read = context.has(Stage::Motor) && context.logged.motor;
        let sizes: &[f64] = if is_read { &[1.0, 4.0, 16.0, 64.0] } else { &[] };
        sizes.iter().map(|&friction_um| Self { friction_um, um_s2_per_m: 0.0 }).collect()
    }

    fn coordinates(&self) -> Vec<Coordinate> {
        let inertia = Coordinate::between(self.um_s2_per_m, 0.05, 0.0, 1e5);
        vec![
            Coordinate::between(self.friction_um, 0.1, 0.0, 1000.0),
            // Zero is no limit of the search: a light motor has next to none.
            Coordinate { limits: [f64::NEG_INFINITY, 1e5], ..inertia },
        ]
    }

    fn at(&self, x: &[f64]) -> Self {
        Self { friction_um: x[0], um_s2_per_m: x[1] }
    }

    fn values(&self) -> Vec<f64> {
        vec![self.friction_um, self.um_s2_per_m]
    }

    fn compensation(&self) -> EffectCompensation {
        EffectCompensation::by(
            "the displacement under friction is added to the command in the direction of motion; a higher current of the driver lowers it",
        )
    }

    fn sentence(&self, wording: &Wording) -> String {
        format!(
            "the stepper motor lags its command by {} under friction, and by {} under acceleration",
            wording.value(0),
            wording.value(1)
        )
    }

    fn abscissa(&self) -> Abscissa {
        Abscissa::Velocity
    }
}
