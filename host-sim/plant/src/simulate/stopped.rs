//! Why a simulation did not reach the end of its motion, in words.

use shared::config::AxisSettings;
use shared::interpolate::PathError;
use shared::safety::{Fault, FaultKind};

use super::LONGEST_S;
use crate::parameters::AxisParameters;
use link::controller::ControllerError;
use model::bodies::StructureError;
use model::machine::Machine;
use model::servo;

/// Why a simulation stopped.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The controller refused the machine or the motion, or the link broke.
    #[error(transparent)]
    Controller(#[from] ControllerError),
    /// A block of the path was refused.
    #[error("block {index}: {error}")]
    Block {
        /// Counted from 0.
        index: usize,
        /// What is wrong with it.
        error: PathError,
    },
    /// The machine file lacks what a simulation needs.
    #[error("axis.{axis}: a simulation needs the key {key}")]
    Lacks {
        /// Axis.
        axis: String,
        /// Key.
        key: &'static str,
    },
    /// A step of the plant cannot be short enough for this axis.
    #[error("axis.{axis}: {key} asks for steps of {step_s:.1e} s")]
    TooFast {
        /// Axis.
        axis: String,
        /// Key.
        key: &'static str,
        /// What it asks for.
        step_s: f64,
    },
    /// The controller switched the drives off, or what it drives is no longer a machine.
    #[error("{what}: stopped after {time_s:.4} s{hint}")]
    Fault {
        /// Fault and axis.
        what: String,
        /// When.
        time_s: f64,
        /// What may be behind it.
        hint: &'static str,
    },
    /// The machine's bodies cannot be put together.
    #[error("structure: {0}")]
    Structure(#[from] StructureError),
    /// The path did not end.
    #[error("the motion did not end within {LONGEST_S} s of machine time")]
    Endless,
    /// A row of the log could not be kept.
    #[error("log: {0}")]
    Log(#[from] std::io::Error),
}

const UNSTABLE: &str = ": is the loop unstable, or the motion too fast for it?";

/// A fault of the controller with the limit that it is about.
pub(super) fn fault(machine: &Machine, fault: Fault, time_s: f64) -> SimulationError {
    let (what, hint) = match fault {
        Fault::Overrun => ("a tick took longer than its period".to_owned(), ""),
        Fault::HardwareStop => ("the power stages were cut in hardware".to_owned(), ""),
        Fault::Watchdog => ("the board was reset by its watchdog".to_owned(), ""),
        Fault::Axis { axis, kind } => match machine.axis.get_index(usize::from(axis)) {
            None => (format!("axis {axis}: {kind:?}"), ""),
            Some((name, axis)) => {
                let settings =
                    servo::settings(&axis.settings, &AxisParameters::of(axis).servo).unwrap_or_default();
                let (what, hint) = said(kind, &settings);
                (format!("axis.{name}: {what}"), hint)
            }
        },
    };
    SimulationError::Fault { what, time_s, hint }
}

/// A row that no log may hold.
pub(super) fn not_finite(time_s: f64) -> SimulationError {
    SimulationError::Fault { what: "a reading is no finite number".to_owned(), time_s, hint: UNSTABLE }
}

fn said(kind: FaultKind, settings: &AxisSettings) -> (String, &'static str) {
    let mm = |m: Option<f64>| 1e3 * m.unwrap_or(f64::NAN);
    match kind {
        FaultKind::FollowingError => {
            let limit_mm = 1e3 * settings.following_error_limit_m;
            (format!("following error beyond its limit of {limit_mm} mm"), UNSTABLE)
        }
        FaultKind::Disagreement => {
            let limit_mm = mm(settings.scale_disagreement_limit_m);
            (format!("motor and linear scale further apart than their limit of {limit_mm} mm"), "")
        }
        FaultKind::EncoderStep => {
            let limit = mm(settings.fastest_m_per_s);
            (format!("the motor reading moves faster than {limit} mm/s, which the motor cannot"), UNSTABLE)
        }
        FaultKind::ForceSaturated => (
            format!(
                "the force stands at its limit of {} N, for {} s in all",
                settings.force_limit_n, settings.saturation_time_s
            ),
            ": is the loop unstable, or does the motion ask for more than the drive can give?",
        ),
        FaultKind::SoftLimit => {
            let [least, greatest] = settings.travel_m.unwrap_or([f64::NAN; 2]).map(|m| 1e3 * m);
            (format!("the command leaves the travel from {least} to {greatest} mm"), "")
        }
        FaultKind::ScaleLost => ("no reading of the linear scale".to_owned(), ""),
        FaultKind::EncoderFrozen => {
            let limit_mm = mm(settings.frozen_encoder_limit_m);
            (format!("the motor reading stands while the command moves by more than {limit_mm} mm"), "")
        }
        FaultKind::Displaced => ("the axis does not stand where its motion begins".to_owned(), ""),
    }
}
