//! Wind-up of an axis without declared masses: driven by the force that was measured.

use super::signals::AxisSignals;
use crate::effects::{Effect, Windup};

/// Whether an effect can show in logs at all: wind-up by the measured force needs that force in every log.
#[must_use]
pub fn can_show(effect: &Effect, force_is_logged: bool) -> bool {
    !matches!(effect, Effect::Windup(Windup { friction_n: Some(_), .. })) || force_is_logged
}

/// Adds the stretch of the drive train (µm) to table − motor: what is left is what it does not explain.
pub fn add_stretch(residual_um: &mut [f64], windup: Option<&Windup>, signals: &AxisSignals) {
    let (Some(windup), Some(force), Some(motor)) = (windup, &signals.force, &signals.motor) else { return };
    // Friction turns round with the motion, and keeps its sign while the axis stands.
    let mut way = 0.0;
    let moving = |i: usize| !signals.standing.get(i).copied().unwrap_or(false);
    let ways = motor.velocity.iter().enumerate().map(|(i, velocity)| {
        if moving(i) {
            way = velocity.signum();
        }
        way
    });
    let ways = motor.filtered(&ways.collect::<Vec<_>>());
    for ((residual, force), way) in residual_um.iter_mut().zip(&force.position).zip(ways) {
        *residual += windup.stretch_um(*force, way);
    }
}
