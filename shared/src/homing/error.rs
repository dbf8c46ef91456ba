//! Why an axis was not homed.

use crate::interpolate::PathError;

/// Why an axis was not homed. It has stopped, and its positions are relative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HomingError {
    /// A setting is not in its range.
    Setting(&'static str),
    /// A homing needs drives that are on and an axis at rest, with no other homing running.
    NotReady,
    /// No home switch within the search distance.
    SwitchNotFound,
    /// The home switch did not open within the back-off distance.
    SwitchStuck,
    /// No index pulse within one spacing after the switch.
    IndexNotFound,
    /// The index pulse is within a sixteenth of the spacing from the edge of the switch: the next homing could find the
    /// neighbouring pulse. The switch has to be moved by about a quarter of the spacing.
    IndexTooCloseToSwitch,
    /// The force has not reached its limit, or the axis has not stood at it, within the search distance: there is no hard stop.
    StopNotFound,
    /// The axis moves on with the force at its limit: what it pushes gives way, or its friction needs more force.
    StopYields,
    /// The axis does not move away from the hard stop: the force limit is below its friction.
    HeldFast,
    /// The axis carries a weight, as its brake or its preload says: with a force limit it may fall.
    Weight,
    /// The axis is a motor of a gantry, whose motors are homed together, and not to a hard stop.
    Gantry,
    /// A limit switch that does not belong to this part of the homing.
    LimitSwitch,
    /// There is no reading of the scale that the axis uses.
    ScaleMissing,
    /// The homing took too long.
    Timeout,
    /// It was stopped by the user.
    Stopped,
    /// The drives were switched off, or a fault stopped the path.
    DrivesOff,
    /// The path rejected a motion.
    Path(PathError),
}

impl core::fmt::Display for HomingError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let text = match self {
            Self::Setting(name) => return write!(f, "{name}: outside its range"),
            Self::Path(error) => return write!(f, "a motion of the homing was rejected: {error}"),
            Self::NotReady => "homing needs drives that are on, and axes at rest",
            Self::SwitchNotFound => "no home switch within the search distance",
            Self::SwitchStuck => "the home switch did not open within the back-off distance",
            Self::IndexNotFound => "no index pulse within one spacing after the home switch",
            Self::IndexTooCloseToSwitch => {
                "the index pulse is too close to the edge of the home switch: move the switch by a quarter of the spacing"
            }
            Self::StopNotFound => "no hard stop within the search distance",
            Self::StopYields => {
                "the axis moves on at the force limit: there is no hard stop, or friction needs more force"
            }
            Self::HeldFast => "the axis does not move away from the hard stop: friction needs more force",
            Self::Weight => {
                "the axis carries a weight, and may fall with a limited force: it needs a home switch"
            }
            Self::Gantry => {
                "the axis is a motor of a gantry, whose motors are homed together, and not to a hard stop"
            }
            Self::LimitSwitch => "a limit switch was reached",
            Self::ScaleMissing => "the linear scale has no reading",
            Self::Timeout => "the homing took longer than its time limit",
            Self::Stopped => "the homing was stopped",
            Self::DrivesOff => "the drives went off, or a fault stopped the axis",
        };
        f.write_str(text)
    }
}

impl core::error::Error for HomingError {}
