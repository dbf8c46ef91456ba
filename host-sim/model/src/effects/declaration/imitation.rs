//! What looks like an effect in logs and is none: errors of the measuring chain, and parts of the machine that are not known.

use std::ops::RangeInclusive;

use shared::config::Rates;

use super::context::LoggedChannels;
use super::stage::Stage;
use crate::axis::{Drive, Settings};

/// Something that is not told apart from an effect by the channels that were logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Imitation {
    /// Its name among the rivals of the effect.
    pub name: &'static str,
    /// Description as a clause without a full stop.
    pub clause: &'static str,
    /// The channel, key or log that decides between both.
    pub decided_by: &'static str,
}

/// With what an effect was found.
#[derive(Clone, Debug)]
pub struct ImitationContext<'a> {
    /// Declared settings of the axis.
    pub axis: &'a Settings,
    /// Stages that were evaluated on this axis.
    pub stages: &'a [Stage],
    /// Channels of the axis in the logs.
    pub logged: LoggedChannels,
    /// Rates of the loops.
    pub rates: Rates,
    /// Half widths of the 95 % confidence intervals of the effect's parameters.
    pub half_widths: &'a [f64],
    /// Fitted masses, stiffness and friction relative to the declared ones, as far as the logs determine them.
    pub fitted_to_declared: &'a [f64],
    /// Declared relative tolerance of these values.
    pub tolerance: f64,
    /// Time from the start of the first log to the end of the last one, s.
    pub session_s: f64,
    /// Whether the tool follows the readings of the linear scale but for noise, and not for an error over its position.
    pub tool_follows_scale: bool,
    /// Displacements of the tool per acceleration of its axis, m per m/s², that a displaced reading head of the linear scale leaves as
    /// well; `None`: any, as the scale does not follow the motor as it should, or no motor was logged.
    pub head_displacement_s2: Option<RangeInclusive<f64>>,
    /// What the turned probe reads on this axis of the other tool's displacement per acceleration of the other axis, m per m/s²; zero
    /// for a probe that is not turned.
    pub turned_s2: f64,
    /// Whether rows were read at instants that jitter.
    pub jitters: bool,
    /// Whether an error that varies over the position and with the direction of motion was found on the axis.
    pub has_varying_gap: bool,
}

impl Imitation {
    /// The stretch of the drive train between motor and table, under friction and acceleration.
    pub const STRETCH: Self = Self {
        name: "windup",
        clause: "the drive train is stretched by the forces that it transmits",
        decided_by: "the readings of a linear scale",
    };

    /// An error of the scale of the logged force.
    pub const FORCE_GAIN: Self = Self {
        name: "force_gain",
        clause: "the logged force is too large or too small by this factor, as by a wrong torque constant",
        decided_by: "a force measured apart from the drive",
    };

    /// An error of the linear scale over its length, as of its mounting.
    pub const SCALE: Self = Self {
        name: "scale_cyclic",
        clause: "the linear scale reads positions with this error",
        decided_by: "a probe whose readings follow the table over the travel",
    };

    /// An offset of the logged force.
    pub const FORCE_OFFSET: Self = Self {
        name: "force_offset",
        clause: "the logged force has this offset",
        decided_by: "the motor's position and the gains of the control loop",
    };

    /// A displacement of the scale's reading head.
    pub const HEAD: Self = Self {
        name: "scale_head",
        clause: "acceleration displaces the reading head of the linear scale by this",
        decided_by: "a motor reading that the scale follows, and the masses and stiffness in the machine file",
    };

    /// The displacement of another axis's tool, read by a turned probe.
    pub const TURN: Self = Self {
        name: "probe_rotation",
        clause: "the turned probe reads a part of what that axis's own acceleration displaces the tool by",
        decided_by: "a probe that is aligned with the axes",
    };

    /// A periodic error of the screw's pitch.
    pub const SCREW_WAVE: Self = Self {
        name: "pitch_cyclic",
        clause: "the screw has a periodic error of this period",
        decided_by: Self::CLOCK.decided_by,
    };

    /// A periodic error of the motor's reading.
    pub const READING_WAVE: Self = Self {
        name: "resolver_dividing",
        clause: "the motor's reading has a periodic error of this period",
        decided_by: Self::CLOCK.decided_by,
    };

    /// A gap between screw and table that varies over the position.
    pub const VARYING_GAP: Self = Self {
        name: "pitch_map",
        clause: "the gap between screw and table varies more finely than its map: friction stretches the drive in the direction of motion as well",
        decided_by: "a log of motions with high accelerations over the travel",
    };

    /// The position gain of a loop that commands the velocity of a drive of unknown bandwidth.
    pub const POSITION_GAIN: Self = Self {
        name: "servo_mismatch",
        clause: "the position gain of the loop deviates, which a drive of another bandwidth hides",
        decided_by: Self::DRIVE_GAINS,
    };

    /// The feed-forward of such a loop.
    pub const FEEDFORWARD: Self = Self {
        name: "feedforward_mismatch",
        clause: "the velocity feed-forward of the loop deviates, which a drive of another bandwidth hides",
        decided_by: Self::DRIVE_GAINS,
    };

    const DRIVE_GAINS: &'static str = "the masses and the gains of the drive's velocity loop";

    /// Rows that were read before or after the instants of their times.
    pub const CLOCK: Self = Self {
        name: "timestamp_jitter",
        clause: "rows were read before or after the instants of their times",
        decided_by: "a log that the drive writes in its own cycle",
    };
}

impl ImitationContext<'_> {
    /// The rival of a gain of the position loop, where the bandwidth of the drive is not known: in steady motion the axis lags by
    /// v·(1 − Kf)/Kp, and the time constants of the drive follow the rest.
    #[must_use]
    pub fn rival_gain(&self, rival: Imitation) -> Vec<Imitation> {
        let is_unknown = self.axis.controller.drive == Drive::Velocity;
        is_unknown.then_some(rival).into_iter().collect()
    }

    /// Whether a stage was evaluated.
    #[must_use]
    pub fn has(&self, stage: Stage) -> bool {
        self.stages.contains(&stage)
    }

    /// The rival of a wave of table − motor. An error of the motor's reading and one of the screw differ only by the force that the
    /// loop applies. Where instants jitter, the errors of force and motor are larger than this difference.
    #[must_use]
    pub fn rival_wave(&self, rival: Imitation) -> Vec<Imitation> {
        self.jitters.then_some(rival).into_iter().collect()
    }

    /// Whether the stretch of the drive train is part of tool − motor: the tool is predicted from the motor, as no linear scale is
    /// logged.
    #[must_use]
    pub const fn hides_stretch(&self) -> bool {
        !self.logged.scale
    }

    /// The rival of a displacement of the tool by an acceleration of its own axis, m per m/s²; `None`: by that of another axis, which moves
    /// neither motor nor scale of this one.
    #[must_use]
    pub fn displaced_head(&self, own_s2: Option<f64>) -> Option<Imitation> {
        let is_allowed = match (&self.head_displacement_s2, own_s2) {
            (None, _) => self.logged.scale,
            (Some(allowed), Some(own_s2)) => allowed.contains(&own_s2),
            (Some(_), None) => false,
        };
        is_allowed.then_some(Imitation::HEAD)
    }

    /// Whether all fitted values are within their tolerance if the forces of the log are too large by a factor. The tolerance is two
    /// standard deviations; three are allowed, as the largest deviation of several values counts.
    #[must_use]
    pub fn allows_force_scale(&self, factor: f64) -> bool {
        !self.fitted_to_declared.is_empty()
            && self
                .fitted_to_declared
                .iter()
                .all(|fitted| (fitted / factor - 1.0).abs() <= 1.5 * self.tolerance)
    }

    /// Period of the position loop, s: that of the logs.
    #[must_use]
    pub fn sample_s(&self) -> f64 {
        f64::from(self.rates.position_loop_divider) / self.rates.velocity_loop_hz
    }
}
