//! Errors that end a simulation before the end of its motion.

use shared::config::AxisSettings;
use shared::interpolate::PathError;
use shared::safety::{Fault, FaultKind};

use crate::controller::ControllerError;
use crate::parameters::AxisParameters;
use model::bodies::StructureError;
use model::machine::Machine;
use model::servo;

/// Maximum duration of a run, s of machine time; a longer path ends with [`SimulationError::Endless`].
pub const MAX_RUN_S: f64 = 3600.0;

/// Errors of a simulation.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The controller refused the machine or the motion, or the link broke.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// A block of the path was refused.
    #[error("block {index}: {error}")]
    Block {
        /// Its number, from 0.
        index: usize,
        /// The reason.
        error: PathError,
    },
    /// The machine file lacks a key that a simulation needs.
    #[error("axis.{axis}: a simulation needs the key {key}")]
    Lacks {
        /// Axis.
        axis: String,
        /// Key.
        key: &'static str,
    },
    /// The machine file contains an effect that lies within the controller and that this program's controller does not have.
    #[error("axis.{axis}: the effect {effect} is in the machine's own controller and cannot be simulated")]
    NotSimulated {
        /// Axis.
        axis: String,
        /// What it is, as in the machine file.
        effect: &'static str,
    },
    /// The axis is the second motor of a gantry.
    #[error(
        "axis.{axis}.gantry_with: a gantry is not simulated; the emulated board has one (`board bench add-beam`)"
    )]
    Gantry {
        /// Axis.
        axis: String,
    },
    /// An axis needs shorter steps than the simulation takes.
    #[error("axis.{axis}: {key} requires steps of {step_s:.1e} s")]
    TooFast {
        /// Axis.
        axis: String,
        /// The key whose value needs them.
        key: &'static str,
        /// The longest step that it allows, s.
        step_s: f64,
    },
    /// The controller switched the drives off, or a value of the machine is not finite.
    #[error("{what}: stopped after {time_s:.4} s{hint}")]
    Fault {
        /// The fault, with its axis.
        what: String,
        /// Time since the start, s.
        time_s: f64,
        /// A possible cause; may be empty.
        hint: &'static str,
    },
    /// The machine's structure is impossible.
    #[error("structure: {0}")]
    Structure(#[from] StructureError),
    /// The path did not end in time.
    #[error("the motion did not end within {limit_s} s of machine time")]
    Endless {
        /// Maximum duration, s of machine time.
        limit_s: f64,
    },
    /// A row of the log could not be written.
    #[error("log: {0}")]
    Log(#[from] std::io::Error),
}

const UNSTABLE: &str = ": is the loop unstable, or the motion too fast for it?";

/// The error of a fault of the controller, with the limit that was exceeded.
pub(super) fn fault(machine: &Machine, fault: Fault, time_s: f64) -> SimulationError {
    let (what, hint) = match fault {
        Fault::Overrun => ("a tick took longer than its period".to_owned(), ""),
        Fault::HardwareStop => ("the power stages were switched off by hardware".to_owned(), ""),
        Fault::Watchdog => ("the board was reset by its watchdog".to_owned(), ""),
        Fault::StoredSettings => ("the settings in the flash of the board cannot be used".to_owned(), ""),
        Fault::EmergencyStop => ("the emergency stop is pressed".to_owned(), ""),
        Fault::BusOvervoltage => ("the bus voltage is too high".to_owned(), ""),
        Fault::BusUndervoltage => ("the bus voltage is too low".to_owned(), ""),
        Fault::OverTemperature => ("a power stage is too hot".to_owned(), ""),
        Fault::HostSilent => ("the board has not heard from the host".to_owned(), ""),
        Fault::Axis { axis, kind } => match machine.axis.get_index(usize::from(axis)) {
            None => (format!("axis {axis}: {kind:?}"), ""),
            Some((name, axis)) => {
                let settings =
                    servo::settings(&axis.settings, &AxisParameters::of(axis).servo).unwrap_or_default();
                let (what, hint) = described(kind, &settings);
                (format!("axis.{name}: {what}"), hint)
            }
        },
    };
    SimulationError::Fault { what, time_s, hint }
}

/// The error of a row with a value that is not finite.
pub(super) fn not_finite(time_s: f64) -> SimulationError {
    SimulationError::Fault { what: "a reading is not a finite number".to_owned(), time_s, hint: UNSTABLE }
}

/// A fault of an axis in words, and a possible cause.
fn described(kind: FaultKind, settings: &AxisSettings) -> (String, &'static str) {
    let mm = |m: Option<f64>| 1e3 * m.unwrap_or(f64::NAN);
    match kind {
        FaultKind::FollowingError => {
            let limit_mm = 1e3 * settings.following_error_limit_m;
            (format!("following error beyond its limit of {limit_mm} mm"), UNSTABLE)
        }
        FaultKind::Disagreement => {
            let limit_mm = mm(settings.sensors.scale_disagreement_limit_m());
            (format!("difference between motor and linear scale beyond its limit of {limit_mm} mm"), "")
        }
        FaultKind::EncoderStep => {
            let limit = mm(settings.fastest_m_per_s);
            (format!("motor reading faster than {limit} mm/s, which the motor cannot reach"), UNSTABLE)
        }
        FaultKind::ForceSaturated => (
            format!(
                "force at its limit of {} N for {} s in total",
                settings.force_limit_n, settings.saturation_time_s
            ),
            ": is the loop unstable, or does the motion require more force than the drive can provide?",
        ),
        FaultKind::SoftLimit => {
            let [min, max] = settings.travel_m.unwrap_or([f64::NAN; 2]).map(|m| 1e3 * m);
            (format!("the command leaves the travel from {min} to {max} mm"), "")
        }
        FaultKind::ScaleLost => ("no reading of the linear scale".to_owned(), ""),
        FaultKind::EncoderFrozen => {
            let limit_mm = mm(settings.sensors.frozen_encoder_limit_m());
            (
                format!(
                    "the motor reading does not change while the command or the scale moves by more than {limit_mm} mm"
                ),
                "",
            )
        }
        FaultKind::ScaleFrozen => {
            let limit_mm = mm(settings.sensors.frozen_encoder_limit_m());
            (
                format!(
                    "the reading of the linear scale does not change while the motor moves by more than {limit_mm} mm"
                ),
                "",
            )
        }
        FaultKind::DriveFault => ("the drive reports a fault".to_owned(), ""),
        FaultKind::EncoderSignal => ("the signals of the motor encoder are out of range".to_owned(), ""),
        FaultKind::LimitSwitch => ("a limit switch was reached".to_owned(), ""),
        FaultKind::GearLag => ("the axis lags behind a counter that it follows".to_owned(), ""),
        FaultKind::GantrySkew => ("the skew of the gantry exceeds its limit".to_owned(), ""),
        FaultKind::Displaced => ("the axis is not at the start of its motion".to_owned(), ""),
    }
}
