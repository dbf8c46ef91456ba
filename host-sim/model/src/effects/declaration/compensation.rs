//! What is done about an effect.

/// What is done about an effect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EffectCompensation {
    /// The controller compensates it.
    Compensated {
        /// What the controller does.
        does: &'static str,
        /// What to set against the part that this leaves; may be empty.
        also: String,
    },
    /// The controller cannot compensate it.
    Not {
        /// Why.
        why: &'static str,
        /// What to do instead.
        instead: &'static str,
    },
}

impl EffectCompensation {
    /// Compensation of an effect by its part in the force feed-forward.
    pub const FRICTION: Self = Self::by("its friction is part of the force feed-forward");

    /// An error over the position of the axis itself.
    pub const OVER_POSITION: Self = Self::by("the error over the position is subtracted from the command");

    /// Travel of the motor after a reversal in which the table does not follow.
    pub const REVERSAL: Self =
        Self::by("half of the width is added to the command in the direction of motion");

    /// A periodic error of the motor's reading.
    pub const READING_WAVE: Self = Self::by("the periodic error is subtracted from the motor reading");

    /// A load on the table.
    pub const LOAD: Self = Self::by("the load over the position is part of the force feed-forward");

    /// An error over the position of the other axis.
    pub const OVER_OTHER_POSITION: Self =
        Self::by("the displacement over the other axis's position is subtracted from the command");

    /// A delay of the drive's velocity.
    pub const VELOCITY_READING: Self = Self::not(
        "the delay is in the drive's own velocity reading",
        "reduce the averaging of the velocity in the drive",
    );

    /// Friction of a lubricant that depends on more than the load.
    pub const LUBRICANT: Self = Self::not(
        "the force feed-forward has no friction that falls towards standstill or depends on the past speed",
        "check the lubricant, or move at speeds at which its film carries",
    );

    /// A delay outside the controller's settings.
    pub const DELAY: Self = Self::not(
        "the delay is in the computation, the bus or the drive",
        "shorten the cycle of the controller, or read the sensors later in it",
    );

    /// An error of the probe.
    pub const PROBE: Self = Self::not(
        "it is the alignment of the probe, not the machine",
        "align the probe, or correct its readings",
    );

    /// An error of the scale.
    pub const SCALE: Self = Self::not(
        "only the scale reads it; the controller has no table for the error of a scale",
        "correct it in the electronics of the scale, or close the loop by the motor",
    );

    /// The controller compensates the effect and leaves nothing to do.
    #[must_use]
    pub const fn by(does: &'static str) -> Self {
        Self::Compensated { does, also: String::new() }
    }

    /// The controller cannot compensate the effect.
    #[must_use]
    pub const fn not(why: &'static str, instead: &'static str) -> Self {
        Self::Not { why, instead }
    }

    /// Whether the controller compensates the effect.
    #[must_use]
    pub const fn is_compensated(&self) -> bool {
        matches!(self, Self::Compensated { .. })
    }

    /// What to do about the effect: the compensation, or what to do at the machine.
    #[must_use]
    pub fn remedy(&self) -> String {
        match self {
            Self::Compensated { .. } => format!("compensate: {}", self.description()),
            Self::Not { instead, .. } => (*instead).to_owned(),
        }
    }

    /// What the controller does about the effect, and what to set against what it leaves; empty if it does nothing.
    #[must_use]
    pub fn description(&self) -> String {
        match self {
            Self::Compensated { does, also } if also.is_empty() => (*does).to_owned(),
            Self::Compensated { does, also } => format!("{does}; {also}"),
            Self::Not { .. } => String::new(),
        }
    }
}
