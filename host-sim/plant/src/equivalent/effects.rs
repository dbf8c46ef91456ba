//! The effects of an axis whose table turns late, in one lost motion.

use model::effects::{Effect, InertialWindup, LostMotion, PeriodicError, ResolverDividing};
use model::machine::Axis;

use crate::parameters::AxisParameters;

/// Friction of a table of which nothing is known, over its mass, m/s²: it does not slide in the gap by itself.
const FRICTION_M_PER_S2: f64 = 10.0;

/// Travel over which this friction reverses, µm.
const PRESLIDING_UM: f64 = 1.0;

/// Stretch of a drive train of which nothing is known, µm per m/s².
const STRETCH_UM_S2_PER_M: f64 = 5e-3;

/// The effects with everything by which the table turns late in one lost motion, behind the motor as commanded.
pub(super) fn equivalent_effects(axis: &Axis) -> Vec<Effect> {
    let parameters = AxisParameters::of(axis).with_motor_as_commanded();
    let declared = &parameters.lost_motion;
    let (width_um, stretch_um_s2_per_m) = (parameters.reversal_width_um(), stretch_um_s2_per_m(axis));
    // All of the width may be the stretch by friction, either way, and no more.
    let assumed_m_per_s2 = stretch_um_s2_per_m
        .map_or(FRICTION_M_PER_S2, |um_s2_per_m| FRICTION_M_PER_S2.min(0.5 * width_um / um_s2_per_m));
    let um_s2_per_m = stretch_um_s2_per_m.unwrap_or(STRETCH_UM_S2_PER_M);
    let lost = LostMotion {
        width_um,
        friction_m_per_s2: declared.friction_m_per_s2.or(Some(assumed_m_per_s2)),
        presliding_um: declared.presliding_um.or(Some(PRESLIDING_UM)),
    };
    let is_other = |effect: &&Effect| {
        !matches!(
            effect,
            Effect::Backlash(_)
                | Effect::LostMotion(_)
                | Effect::InertialWindup(_)
                | Effect::LoadAngle(_)
                | Effect::ForceWindup(_)
                | Effect::MicrostepError(_)
                | Effect::ResolverDividing(_)
                | Effect::EncoderEllipticity(_)
        )
    };
    let mut effects: Vec<Effect> = axis.effect.iter().filter(is_other).cloned().collect();
    effects.push(Effect::InertialWindup(InertialWindup { um_s2_per_m }));
    effects.push(Effect::LostMotion(lost));
    effects.extend(parameters.resolver.iter().map(reading_error));
    effects
}

/// Lag of the table per acceleration, of the drive train and of the rotor of a stepper motor; `None`: not known.
fn stretch_um_s2_per_m(axis: &Axis) -> Option<f64> {
    let of_effect = |effect: &Effect| match effect {
        Effect::InertialWindup(windup) => windup.um_s2_per_m,
        Effect::LoadAngle(angle) => angle.um_s2_per_m,
        _ => 0.0,
    };
    let um_s2_per_m: f64 = axis.effect.iter().map(of_effect).sum();
    (um_s2_per_m > 0.0).then_some(um_s2_per_m)
}

const fn reading_error(error: &PeriodicError) -> Effect {
    let PeriodicError { amplitude_um, period_mm, phase_rad } = *error;
    Effect::ResolverDividing(ResolverDividing { amplitude_um, period_mm, phase_rad, fitted_period_mm: None })
}
