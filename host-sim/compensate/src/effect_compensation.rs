//! What is done about each effect of the catalogue.

use model::effects::Effect;

/// What is done about an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EffectCompensation {
    /// The controller compensates it; what it does.
    Compensated(&'static str),
    /// The controller cannot compensate it.
    Not {
        /// Why.
        why: &'static str,
        /// What to do instead.
        instead: &'static str,
    },
}

/// What is done about an effect.
#[must_use]
pub const fn of(effect: &Effect) -> EffectCompensation {
    if let Some(does) = done(effect) {
        return EffectCompensation::Compensated(does);
    }
    let (why, instead) = not_done(effect);
    EffectCompensation::Not { why, instead }
}

/// What the controller does about an effect, and what to set against what it leaves; empty if it does nothing.
#[must_use]
pub fn description(effect: &Effect) -> String {
    match (of(effect), effect) {
        (EffectCompensation::Compensated(does), Effect::Resonance(resonance)) => format!(
            "{does}; against the oscillation that steps of the acceleration excite, limit the jerk, or set smoothing_s = {:.4}, \
             one period, on all axes of the machine file",
            resonance.frequency_hz.recip()
        ),
        (EffectCompensation::Compensated(does), _) => does.to_owned(),
        (EffectCompensation::Not { .. }, _) => String::new(),
    }
}

/// What the controller does about an effect, if it can.
const fn done(effect: &Effect) -> Option<&'static str> {
    Some(match effect {
        Effect::Backlash(_) => "half of the gap is added to the command in the direction of motion",
        Effect::PitchProgressive(_) | Effect::PitchMap(_) => {
            "the error over the position is subtracted from the command"
        }
        Effect::PitchCyclic(_) => "the periodic error is subtracted from the command",
        Effect::ResolverDividing(_) | Effect::EncoderEllipticity(_) => {
            "the periodic error is subtracted from the motor reading"
        }
        Effect::Windup(_) => "the stretch under the modelled force is added to the command",
        Effect::Stribeck(_)
        | Effect::FrictionAsymmetry(_)
        | Effect::FrictionMap(_)
        | Effect::FrictionWarmUp(_)
        | Effect::MotorStribeck(_)
        | Effect::Presliding(_)
        | Effect::PreloadVariation(_)
        | Effect::FrictionRipple(_) => "its friction is part of the force feed-forward",
        Effect::TorqueRipple(_) => "the periodic force is subtracted from the force",
        Effect::ConstantLoad(_) | Effect::PositionLoad(_) => {
            "the load over the position is part of the force feed-forward"
        }
        Effect::ServoMismatch(_) => "the setting of Kp is changed so that the drive has the declared one",
        Effect::FeedforwardMismatch(_) => {
            "the setting of Kf is changed so that the drive has the declared one"
        }
        Effect::VelocityGainMismatch(_) => {
            "the setting of Kv is changed so that the drive has the declared one"
        }
        Effect::IntegralTimeMismatch(_) => {
            "the setting of Ti is changed so that the drive has the declared one"
        }
        Effect::Intalk(_) => "the displacement by the commanded acceleration is subtracted",
        Effect::Crosstalk(_) => "the displacement by the other axis's commanded acceleration is subtracted",
        Effect::Squareness(_) | Effect::Straightness(_) => {
            "the displacement over the other axis's position is subtracted from the command"
        }
        Effect::Resonance(_) => {
            "the command leads by the lag of the tool, 2·ζ/ω (Kf) and 1/ω² per commanded acceleration"
        }
        Effect::ThermalDrift(_) => "the drift over the time of the session is subtracted from the command",
        Effect::ForceWindup(_)
        | Effect::ShearThinning(_)
        | Effect::FrictionMemory(_)
        | Effect::VelocityLag(_)
        | Effect::VelocityFilter(_)
        | Effect::DriveLag(_)
        | Effect::DriveAsymmetry(_)
        | Effect::DriveDeadTime(_)
        | Effect::ComputationDelay(_)
        | Effect::LoopDelay(_)
        | Effect::PositionDelay(_)
        | Effect::ScaleGain(_)
        | Effect::ScaleCyclic(_)
        | Effect::ThermalGrowth(_)
        | Effect::ProbeRotation(_)
        | Effect::ProbeGain(_)
        | Effect::ThermalRate(_)
        | Effect::Latency(_) => return None,
    })
}

/// Why the controller cannot compensate an effect, and what to do instead.
const fn not_done(effect: &Effect) -> (&'static str, &'static str) {
    match effect {
        Effect::ForceWindup(_) => (
            "the stretch follows the measured force, for which the model has no masses",
            "declare the masses and trace again",
        ),
        Effect::ShearThinning(_) | Effect::FrictionMemory(_) => (
            "the force feed-forward has no friction that falls towards standstill or depends on the past speed",
            "check the lubricant, or move at speeds at which its film carries",
        ),
        Effect::VelocityLag(_) | Effect::VelocityFilter(_) => (
            "the delay is in the drive's own velocity reading",
            "reduce the averaging of the velocity in the drive",
        ),
        Effect::DriveAsymmetry(_) => (
            "the gains of the drive differ between both directions",
            "adjust the current measurement of the drive",
        ),
        Effect::DriveDeadTime(_)
        | Effect::ComputationDelay(_)
        | Effect::LoopDelay(_)
        | Effect::PositionDelay(_) => (
            "the delay is in the computation, the bus or the drive",
            "shorten the cycle of the controller, or read the sensors later in it",
        ),
        Effect::DriveLag(_) => {
            ("the lag is in the drive's current loop", "tune the current loop of the drive")
        }
        Effect::ProbeRotation(_) | Effect::ProbeGain(_) => {
            ("it is the alignment of the probe, not the machine", "align the probe, or correct its readings")
        }
        Effect::ScaleGain(_) | Effect::ScaleCyclic(_) => (
            "only the scale reads it; the controller has no table for the error of a scale",
            "correct it in the electronics of the scale, or close the loop by the motor",
        ),
        Effect::ThermalGrowth(_) => (
            "the controller has no table of the position that changes with time",
            "warm the machine up, close the loop by the scale, or correct the scale by its temperature",
        ),
        Effect::ThermalRate(_) => (
            "the logs show neither the time constant nor the end of the drift, so that it cannot be continued",
            "record until the drift ends, or warm the machine up",
        ),
        Effect::Latency(_) => (
            "only the log is late, the machine is not",
            "read the channels at the same instant; this program moves the channel back where it evaluates logs",
        ),
        _ => ("no compensation is known", "remove its cause at the machine"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{DriveLag, Intalk, Latency, Resonance};

    #[test]
    fn an_effect_is_compensated_or_has_its_reason() {
        let intalk = of(&Effect::Intalk(Intalk::default()));
        assert!(matches!(intalk, EffectCompensation::Compensated(does) if does.contains("acceleration")));
        let resonance = Resonance::of_tool(62.5, 0.02);
        assert!(description(&Effect::Resonance(resonance)).contains("smoothing_s = 0.0160,"));
        let latency = Latency { channel: model::effects::Channel::Tool, ms: 1.0 };
        for effect in [Effect::DriveLag(DriveLag::default()), Effect::Latency(latency)] {
            let EffectCompensation::Not { why, .. } = of(&effect) else {
                panic!("{effect:?} is compensated")
            };
            assert!(why != "no compensation is known");
        }
    }
}
