//! Refusals, faults and events in words, each with what helps.

use shared::drive::NotArmed;
use shared::drive::direction_check::DirectionResult;
use shared::excitation::ExcitationProblem;
use shared::interpolate::PathError;
use shared::interpolate::following::FollowError;
use shared::link::Refusal;
use shared::link::halt::Halt;
use shared::link::history::HistoryEvent;
use shared::link::message::MAX_AXES;
use shared::link::refusal::{DirectionProblem, SettingProblem, UploadError};
use shared::link::report::{HomingFailure, SettingsReport, SettingsSource, StoredRecord};
use shared::probing::ProbeError;
use shared::safety::{Fault, FaultKind};

/// Names of the axes of a board, in its order; a board of fewer axes has the first of them.
pub const AXIS_NAMES: [&str; MAX_AXES] = ["x", "y", "z", "u"];

/// The name of an axis.
#[must_use]
pub fn axis_name(axis: u8) -> String {
    AXIS_NAMES.get(usize::from(axis)).map_or_else(|| format!("axis {axis}"), |name| (*name).to_owned())
}

/// The number of axes in words.
#[must_use]
pub fn axes(count: usize) -> String {
    if count == 1 { "1 axis".to_owned() } else { format!("{count} axes") }
}

/// A refusal in one line.
#[must_use]
pub fn text(refusal: &Refusal) -> String {
    match refusal {
        Refusal::Version { supported } => {
            format!("its link has version {supported}, this program has {}", shared::link::packet::VERSION)
        }
        Refusal::Unreadable => {
            "it cannot read the request; check that board and host have the same version".into()
        }
        Refusal::Session => "another program has opened a session since".into(),
        Refusal::Sequence { expected } => format!("it expects request {expected}"),
        Refusal::Upload(error) => upload(*error),
        Refusal::Setting { axis, name, problem } => {
            format!("{}: {name}: {}", axis_name(*axis), setting(problem))
        }
        Refusal::TickRate { board_hz } => {
            format!("velocity_loop_rate_hz: expected {board_hz}, the tick rate of the board")
        }
        Refusal::Path { block, error } => format!("block {block}: {}", path(*error)),
        Refusal::TooFast { block, axis, limit_m_per_s } => format!(
            "block {block}: {} would exceed {:.0} mm/min (90 % of fastest_mm_per_s)",
            axis_name(*axis),
            60e3 * limit_m_per_s
        ),
        Refusal::NoSuchAxis => "it has no such axis".into(),
        Refusal::Axes { board } => format!("it has {}", axes(usize::from(*board))),
        Refusal::NotArmed(NotArmed::Switch) => {
            "the enable switch is open, or was closed before the last stop: open it, then close it".into()
        }
        Refusal::NotArmed(NotArmed::EmergencyStop) => "the emergency stop is pressed".into(),
        Refusal::Faulted(fault) => format!("{}; `board clear` acknowledges it", self::fault(*fault)),
        Refusal::DrivesOff => "the drives are off; `board enable` switches them on".into(),
        Refusal::DrivesOn => "the drives are on; `board disable` switches them off".into(),
        Refusal::Moving => "the axes move or are held on a path; `board stop` ends it".into(),
        Refusal::Homing(failure) => homing(*failure),
        Refusal::Direction(problem) => direction_problem(*problem).into(),
        Refusal::NotHeld => "nothing is held".into(),
        Refusal::MotionFull { max } => format!("the motion has more than {max} blocks"),
        Refusal::BlockCount { found } => format!("it has received {found} blocks"),
        Refusal::Displaced => "the axes have moved since the motion was checked".into(),
        Refusal::NoCapture => "there is no complete recording".into(),
        Refusal::NotAvailable => "this board does not have this function".into(),
        Refusal::Storage => "the flash has not kept what was written".into(),
        Refusal::NothingToSave => "there is nothing to save: no settings were uploaded for it".into(),
        Refusal::OtherPort => "a host uses its other port, and has not been silent for long enough".into(),
        Refusal::HaltedByOther(halt) => halted_by_other(*halt).into(),
        Refusal::Override { max } => format!("the override: expected a number from 0 to {max} %"),
        Refusal::NothingMoves => "nothing moves or is held: an override applies to a motion that runs".into(),
        Refusal::Excitation(problem) => excitation_problem(*problem).into(),
        Refusal::Probe(error) => probe(*error),
        Refusal::Follow(error) => follow(*error),
        Refusal::SecondMotor { axis, first } => format!(
            "{} is the second motor of a gantry, and moves with {}",
            axis_name(*axis),
            axis_name(*first)
        ),
        Refusal::BrakesMove => "its brakes open or close, and the drives hold the axes; try again".into(),
        Refusal::Busy => "the path changes too fast; try again".into(),
    }
}

/// What somebody else has done to a motion, in words.
#[must_use]
pub const fn halted_by_other(halt: Halt) -> &'static str {
    match halt {
        Halt::Hold => {
            "another program has held the path: `board resume` continues it, `board stop` discards it"
        }
        Halt::Stop => "another program has stopped the motion; the rest of the path is discarded",
        Halt::Disable => "another program has switched the drives off",
    }
}

/// What is wrong with a block, with the name of the axis in the place of its number.
fn path(error: PathError) -> String {
    use PathError::{BeyondTravel, LimitSwitch, NotHomed, SecondMotor};

    let problem = error.to_string();
    match error {
        BeyondTravel { axis } | LimitSwitch { axis } | NotHomed { axis } | SecondMotor { axis } => {
            problem.replacen(&format!("axis {axis}"), &axis_name(axis), 1)
        }
        _ => problem,
    }
}

/// Why an axis does not follow a counter, in words.
fn follow(error: FollowError) -> String {
    match error {
        FollowError::Ratio => {
            "the ratio: expected 1 pm to 100 m for 1 to 2147483647 counts, at most 1.048 mm a count".into()
        }
        FollowError::Speed => "the speed: expected a number above 0 and up to 10 m/s".into(),
        FollowError::Acceleration => "the acceleration: expected a number above 0 and up to 1000 m/s²".into(),
        FollowError::Lag => "the lag: expected 0.001 to 100 mm".into(),
        FollowError::NoCounter => {
            "there is no counter at this input: a scale is connected there, or nothing".into()
        }
        FollowError::Engaged => "the axis follows a counter already; `board stop` ends it".into(),
        FollowError::Moving => "the axes move; `board stop` ends it".into(),
        FollowError::NoSuchAxis => "it has no such axis".into(),
        FollowError::Path(error) => path(error),
    }
}

fn upload(error: UploadError) -> String {
    match error {
        UploadError::OutOfOrder { expected } => format!("upload: it expects byte {expected}"),
        UploadError::TooLong { max } => format!("upload: more than {max} bytes"),
        UploadError::Length { found } => format!("upload: it has {found} bytes"),
        UploadError::Checksum => "upload: wrong checksum".into(),
        UploadError::Unreadable => {
            "upload: it cannot read the settings; check that board and host have the same version".into()
        }
    }
}

fn setting(problem: &SettingProblem) -> String {
    match problem {
        SettingProblem::NotFinite => "expected a finite number".into(),
        SettingProblem::NotPositive => "expected a number above 0".into(),
        SettingProblem::NotWhileRunning => "cannot be changed now".into(),
        SettingProblem::Requires { other } => format!("expected together with {other}, which is missing"),
        SettingProblem::OutOfRange { min, max } => format!("expected a number from {min} to {max}"),
        SettingProblem::Count { max } => format!("expected 2 to {max} values"),
        SettingProblem::NotAnotherAxis => "expected the number of another axis".into(),
        SettingProblem::AboveCeiling { value, ceiling } => {
            format!("{value} is above {ceiling}, the ceiling of this board")
        }
        SettingProblem::BelowFloor { value, floor } => {
            format!("{value} is below {floor}, the floor of this board")
        }
        SettingProblem::NotMonitored { ceiling } => {
            format!("it is missing; this board requires a limit of at most {ceiling}")
        }
        SettingProblem::NoScale => "the axis has no linear scale on this board".into(),
        SettingProblem::NotOfFirstMotor => "expected what the first motor of the gantry has".into(),
        SettingProblem::NoGantry => "the axis is not the second motor of a gantry on this board".into(),
    }
}

const fn direction_problem(problem: DirectionProblem) -> &'static str {
    match problem {
        DirectionProblem::NotReady => {
            "a direction check needs drives that are off without a fault, and no other check or homing"
        }
        DirectionProblem::StepDrive => "a drive with step and direction inputs has no force to check",
        DirectionProblem::Force => "the force has to be positive and at most the force limit of the axis",
        DirectionProblem::Brake => {
            "the axis has a brake: with open loops it would fall. Check the direction with the axis supported and without its brake keys"
        }
        DirectionProblem::Gantry => {
            "the axis is a motor of a gantry, and alone would bend the beam. Check the direction with the motors uncoupled and without the gantry keys"
        }
        DirectionProblem::Setting => "expected a time of at most 1 s and a distance of at most 5 mm",
    }
}

const fn excitation_problem(problem: ExcitationProblem) -> &'static str {
    match problem {
        ExcitationProblem::Force => {
            "the force has to be positive, and its amplitudes at most the force limit of the axis together"
        }
        ExcitationProblem::Period => {
            "the period of the force has to be a power of two from 256 to 8192 ticks"
        }
        ExcitationProblem::Tones => {
            "the force has to have 1 to 8 tones of ascending frequencies below half the tick rate"
        }
        ExcitationProblem::StepDrive => "a drive with step and direction inputs has no force",
    }
}

/// The result of a direction check in words.
#[must_use]
pub fn direction(axis: u8, result: DirectionResult) -> String {
    let axis = axis_name(axis);
    match result {
        DirectionResult::Ok => format!("{axis}: force, motor encoder and scale have the same direction"),
        DirectionResult::OkWithoutScale => {
            format!("{axis}: force and motor encoder have the same direction; there is no reading of a scale")
        }
        DirectionResult::Reversed => format!(
            "{axis}: a positive force moves the motor encoder in the negative direction: change the sign of the force or that \
             of the encoder"
        ),
        DirectionResult::ScaleReversed => {
            format!(
                "{axis}: motor encoder and scale move in opposite directions: change the sign of the scale"
            )
        }
        DirectionResult::ScaleWithoutMotion => {
            format!("{axis}: the motor has moved, the scale stands: check its plug and the coupling")
        }
        DirectionResult::MotorWithoutMotion => {
            format!("{axis}: the scale has moved, the motor encoder stands: check its plug")
        }
        DirectionResult::WrongAxis(other) => {
            format!("{axis}: {} has moved instead: two plugs are exchanged", axis_name(other))
        }
        DirectionResult::NoMotion => format!(
            "{axis}: nothing has moved: the force is too small, the brake is closed, the drive is not ready, or an encoder is \
             not connected"
        ),
        DirectionResult::Expired => format!(
            "{axis}: ended before the enable switch was closed: the host was silent, or another session was opened"
        ),
        DirectionResult::Aborted => format!("{axis}: ended by a fault, or by the enable switch"),
    }
}

/// Why an axis was not homed, in words.
#[must_use]
pub fn homing(failure: HomingFailure) -> String {
    match failure {
        HomingFailure::Setting => "a setting of the homing is outside its range".into(),
        HomingFailure::NotReady => "homing needs drives that are on, and axes at rest".into(),
        HomingFailure::SwitchNotFound => "no home switch within the search distance".into(),
        HomingFailure::SwitchStuck => "the home switch did not open within the back-off distance".into(),
        HomingFailure::IndexNotFound => "no index pulse after the home switch".into(),
        HomingFailure::IndexTooCloseToSwitch => {
            "the index pulse is too close to the edge of the home switch: move the switch".into()
        }
        HomingFailure::StopNotFound => "no hard stop within the search distance".into(),
        HomingFailure::StopYields => {
            "the axis moves on with the force at its limit: no hard stop, or friction that needs more force"
                .into()
        }
        HomingFailure::HeldFast => {
            "the axis does not move away from the hard stop: its friction needs more force".into()
        }
        HomingFailure::Weight => {
            "the axis carries a weight (brake_release_s or preload_n), and may fall with a limited force; it needs a home switch".into()
        }
        HomingFailure::Gantry => {
            "the axis is a motor of a gantry: its motors are homed together, and not to a hard stop".into()
        }
        HomingFailure::LimitSwitch => "a limit switch was reached".into(),
        HomingFailure::ScaleMissing => "the scale has no signal".into(),
        HomingFailure::Timeout => "the homing took too long".into(),
        HomingFailure::Stopped => "it was stopped".into(),
        HomingFailure::DrivesOff => "the drives went off".into(),
        HomingFailure::Path(error) => format!("a motion was rejected: {}", path(error)),
    }
}

/// Why nothing was probed, in words.
#[must_use]
pub fn probe(error: ProbeError) -> String {
    match error {
        ProbeError::Path(error) => format!("a motion was rejected: {}", path(error)),
        ProbeError::Stopped => "it was stopped".into(),
        ProbeError::DrivesOff => "the drives went off".into(),
        other => other.to_string(),
    }
}

/// A fault in words.
#[must_use]
pub fn fault(fault: Fault) -> String {
    match fault {
        Fault::Axis { axis, kind } => format!("{}: {}", axis_name(axis), kind_text(kind)),
        Fault::Overrun => "overrun: a tick did not end in time, or was missed".into(),
        Fault::HardwareStop => {
            "stopped by hardware: emergency stop, a fault of a power stage, or a low supply of the chip"
                .into()
        }
        Fault::EmergencyStop => "the emergency stop is pressed".into(),
        Fault::BusOvervoltage => "the bus voltage is too high".into(),
        Fault::BusUndervoltage => "the bus voltage is too low".into(),
        Fault::OverTemperature => "a power stage is too hot".into(),
        Fault::HostSilent => "the host was silent: drives off".into(),
        Fault::Watchdog => "the previous run ended by a reset of the watchdog".into(),
        Fault::StoredSettings => {
            "the settings in flash cannot be used; those of the program apply until others are uploaded"
                .into()
        }
    }
}

/// Where the settings of a board are from, and what its flash holds.
#[must_use]
pub fn settings(report: &SettingsReport) -> String {
    let source = match report.source {
        SettingsSource::Program => "of its program",
        SettingsSource::Record => "saved",
        SettingsSource::Upload => "uploaded, not saved",
    };
    let stored = match report.stored {
        StoredRecord::None => "nothing is saved in flash".to_owned(),
        StoredRecord::Valid(number) => format!("save {number} is in flash"),
        StoredRecord::Invalid([first, second]) => {
            format!("nothing in flash can be used (first slot: {first}; second slot: {second})")
        }
        StoredRecord::Refused(number) => format!("save {number} in flash is not accepted"),
    };
    format!("{source}; {stored}")
}

const fn kind_text(kind: FaultKind) -> &'static str {
    match kind {
        FaultKind::FollowingError => "following error beyond its limit",
        FaultKind::Disagreement => "motor and scale disagree",
        FaultKind::EncoderStep => "the motor reading has jumped",
        FaultKind::ForceSaturated => "the force was at its limit for too long",
        FaultKind::SoftLimit => "the command has left the travel, or was about to",
        FaultKind::GearLag => {
            "it lags behind the counter that it follows: the counter is faster than the axis may be"
        }
        FaultKind::ScaleLost => "the scale has no signal",
        FaultKind::EncoderFrozen => "the motor reading does not move",
        FaultKind::ScaleFrozen => "the motor moves and the scale reading does not",
        FaultKind::DriveFault => "the drive reports a fault",
        FaultKind::EncoderSignal => "the encoder signal is too weak or too strong",
        FaultKind::LimitSwitch => "the command moves onto an active limit switch; jog back",
        FaultKind::GantrySkew => {
            "skew of the gantry beyond its limit: one end of the beam lags, or is blocked; look at the beam"
        }
        FaultKind::Displaced => "enabled away from the start of the path",
    }
}

/// An event of the history in words.
#[must_use]
pub fn event(event: HistoryEvent) -> String {
    match event {
        HistoryEvent::Fault(fault) => format!("fault: {}", self::fault(fault)),
        HistoryEvent::Warning(fault) => format!("warning: {}", self::fault(fault)),
        HistoryEvent::HostSilentHold => "the host was silent: path held".into(),
        HistoryEvent::HostSilentOff => "the host was silent while the axes stood: drives off".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_that_is_refused_names_its_axis() {
        for (error, problem) in [
            (PathError::BeyondTravel { axis: 1 }, "y: the block leads out of the travel"),
            (PathError::LimitSwitch { axis: 1 }, "y: the block leads onto an active limit switch"),
            (PathError::NotHomed { axis: 1 }, "y: it has to be homed before a program moves it"),
            (PathError::ZeroLength, "the block ends where it starts"),
        ] {
            assert_eq!(text(&Refusal::Path { block: 3, error }), format!("block 3: {problem}"));
            assert_eq!(homing(HomingFailure::Path(error)), format!("a motion was rejected: {problem}"));
        }
    }
}
