//! What is done about each effect of the catalogue.

use model::effects::Effect;

/// What is done about an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Treatment {
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
pub const fn of(effect: &Effect) -> Treatment {
    use Treatment::{Compensated, Not};
    match effect {
        Effect::Backlash(_) => {
            Compensated("half of the gap is added to the command in the direction of motion")
        }
        Effect::PitchProgressive(_) | Effect::PitchMap(_) => {
            Compensated("the error over the position is subtracted from the command")
        }
        Effect::PitchCyclic(_) => Compensated("the periodic error is subtracted from the command"),
        Effect::ResolverDividing(_) | Effect::EncoderEllipticity(_) => {
            Compensated("the periodic error is subtracted from the motor reading")
        }
        Effect::Windup(_) => Compensated("the stretch under the modelled force is added to the command"),
        Effect::ForceWindup(_) => Not {
            why: "the stretch follows the measured force, for which the model has no masses",
            instead: "declare the masses and trace again",
        },
        Effect::Stribeck(_)
        | Effect::FrictionAsymmetry(_)
        | Effect::FrictionMap(_)
        | Effect::FrictionWarmUp(_)
        | Effect::MotorStribeck(_)
        | Effect::Presliding(_)
        | Effect::PreloadVariation(_)
        | Effect::FrictionRipple(_) => Compensated("its friction is part of the force feed-forward"),
        Effect::ShearThinning(_) | Effect::FrictionMemory(_) => Not {
            why: "the force feed-forward has no friction that depends on the past speed or that falls near standstill",
            instead: "check the lubricant, or move at speeds at which its film carries",
        },
        Effect::TorqueRipple(_) => Compensated("the periodic force is subtracted from the force"),
        Effect::ConstantLoad(_) | Effect::PositionLoad(_) => {
            Compensated("the load over the position is part of the force feed-forward")
        }
        Effect::ServoMismatch(_) => {
            Compensated("the setting of Kp is changed so that the drive has the declared one")
        }
        Effect::FeedforwardMismatch(_) => {
            Compensated("the setting of Kf is changed so that the drive has the declared one")
        }
        Effect::VelocityGainMismatch(_) => {
            Compensated("the setting of Kv is changed so that the drive has the declared one")
        }
        Effect::IntegralTimeMismatch(_) => {
            Compensated("the setting of Ti is changed so that the drive has the declared one")
        }
        Effect::VelocityLag(_) => Not {
            why: "the delay is in the drive's own velocity reading",
            instead: "reduce the averaging of the velocity in the drive",
        },
        Effect::DriveLag(_) => Not {
            why: "the lag is in the drive's current loop",
            instead: "tune the current loop of the drive",
        },
        Effect::Intalk(_) => Compensated("the displacement by the commanded acceleration is subtracted"),
        Effect::Crosstalk(_) => {
            Compensated("the displacement by the other axis's commanded acceleration is subtracted")
        }
        Effect::Squareness(_) | Effect::Straightness(_) => {
            Compensated("the displacement over the other axis's position is subtracted from the command")
        }
        Effect::ThermalDrift(_) => {
            Compensated("the drift over the time of the session is subtracted from the command")
        }
        Effect::Latency(_) => Not {
            why: "only the log is late, the machine is not",
            instead: "read the channels at the same instant, or shift the channel in the log",
        },
        Effect::Resonance(_) => Not {
            why: "the controller does not see the oscillation of the tool",
            instead: "limit the jerk, or set a moving average of one period of the oscillation (smoothing_s) on all axes",
        },
    }
}
