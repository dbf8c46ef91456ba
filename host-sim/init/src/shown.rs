//! Which values the logs show. The others are left unknown: a value that is not determined is worse than none.

use model::axis::{Feedback, Settings};
use model::effects::Stage;
use model::machine::rotary;
use trace::AxisIdentification;
use trace::input::signals::AxisSignals;
use trace::judge::StageResidual;
use trace::judge::declared_value::DeclaredValue;

use crate::mechanics::MOST_LEFT;
use crate::rough::Rough;

/// Part of the following error that the model of a loop may leave. One that leaves more is the model of another loop.
const MOST_OF_FOLLOWING: f64 = 0.2;

/// Half width of an interval, relative, from which a value is not determined.
const WIDEST: f64 = 0.3;

/// Velocity feed-forward below which there is none, percent.
const LEAST_FEEDFORWARD: f64 = 1.0;

/// Values that only the stretch between motor and table divides.
const OF_DIVISION: [&str; 3] = ["motor_mass_kg", "table_mass_kg", "stiffness_n_per_um"];

/// Standard deviations of what the stages have to describe, over all logs; 0 without the channels.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Command − motor, µm.
    following_um: f64,
    /// Force, N.
    force_n: f64,
}

impl Spread {
    /// The spread of an axis.
    #[must_use]
    pub fn of(logs: &[&AxisSignals]) -> Self {
        let deviation = |values: &[f64]| numerics::mean_and_deviation(values).1;
        let following = |log: &&AxisSignals| {
            let (command, motor) = log.command.as_ref().zip(log.motor.as_ref())?;
            let errors: Vec<f64> =
                command.iter().zip(&motor.raw).map(|(command, motor)| command - motor).collect();
            Some(1e6 * deviation(&errors))
        };
        let force = |log: &&AxisSignals| Some(deviation(&log.force.as_ref()?.raw));
        Self {
            following_um: numerics::rms(logs.iter().filter_map(following)),
            force_n: numerics::rms(logs.iter().filter_map(force)),
        }
    }
}

/// Leaves the values unknown that the fit of an axis does not determine; one sentence for each.
#[must_use]
pub fn keep_shown(
    rough: &mut Rough,
    axis: &AxisIdentification,
    declared: &Settings,
    spread: Spread,
) -> Vec<String> {
    let mut notes = Vec::new();
    let name = &axis.axis;
    // Without the noise of the sensors, which an acceleration multiplies.
    let excess =
        |residual: &StageResidual| (residual.after.fit.powi(2) - residual.noise.powi(2)).max(0.0).sqrt();
    let part = |stage: Stage, of: f64| axis.residual(stage).map_or(0.0, |residual| excess(residual) / of);
    let of_force = part(Stage::Force, spread.force_n);
    if of_force > MOST_LEFT {
        rough.forget_mechanics(declared);
        let percent = 100.0 * of_force;
        return vec![format!(
            "{name}: masses and friction stay unknown: a model with them does not describe {percent:.0} % of the force."
        )];
    }
    let of_following = part(Stage::Motor, spread.following_um);
    if of_following > MOST_OF_FOLLOWING {
        rough.forget_loops(declared);
        let percent = 100.0 * of_following;
        notes.push(format!(
            "{name}: the loops stay unknown: their model does not describe {percent:.0} % of the following error."
        ));
    }
    let is_wide =
        |value: &&DeclaredValue| value.half_width > WIDEST * value.fitted && !value.is_poorly_determined;
    let wide: Vec<&str> = axis.declared_values.iter().filter(is_wide).map(|value| value.key).collect();
    let is_elastic = rough.settings.mechanics.stiffness_n_per_um.is_some();
    if is_elastic && wide.iter().any(|key| ["coulomb_n", "viscous_n_s_per_m"].contains(key)) {
        // Friction is what a force shows best: a stiffness that leaves it open is one of another mechanism.
        rough.forget_mechanics(declared);
        notes.push(format!("{name}: masses and friction stay unknown: the logs do not determine them."));
        return notes;
    }
    if is_elastic && wide.iter().any(|key| OF_DIVISION.contains(key)) {
        rough.make_rigid();
        notes.push(format!(
            "{name}: one mass, as the logs do not show how it is divided between motor and table."
        ));
    } else {
        for key in wide {
            // Dual feedback needs its time constant: without it, the feedback is taken to be that of the motor.
            if key == "dual_feedback_time_constant_s" {
                if declared.sensors.feedback == Feedback::Dual {
                    continue;
                }
                rough.settings.sensors.feedback = Feedback::Motor;
            }
            rough.forget_value(key);
            let (key, _) = rotary::written(key, 1.0, axis.model.axis.settings.names);
            notes.push(format!("{name}: {key} stays unknown: the logs do not determine it."));
        }
    }
    // Friction yields over its size divided by the stiffness: without the one there is no other.
    if rough.settings.mechanics.coulomb_n.is_none() {
        rough.forget_value("presliding_stiffness_n_per_um");
        rough.forget_value("presliding_damping_n_s_per_m");
    }
    if rough.settings.controller.feedforward_percent.is_some_and(|percent| percent < LEAST_FEEDFORWARD) {
        rough.forget_value("feedforward_percent");
    }
    notes
}
