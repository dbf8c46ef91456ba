//! One feedback system on the massive table: how far the table is from the command, and at which gain the loop begins
//! to swing.

use crate::controller::{Format, PathBlock, PathShape};
use crate::log::Log;
use crate::machine::{Feedback, Machine};
use crate::plant::desk::Instruments;
use crate::reproduce::ReproduceError;
use crate::simulate::{Run, SimulationError, controller};

/// The machine that every system is tried on.
const MACHINE: &str = include_str!("machine.toml");

/// Of the sensors' noise.
const SEED: u64 = 1977;

/// m/s².
const ACCELERATION: f64 = 1.0;

/// Between two stops, m.
const PITCH_M: f64 = 0.023;

/// Stops each way.
const STOPS: u32 = 6;

/// At a stop, s: eight time constants of the slowest dual feedback that is tried.
const STAND_S: f64 = 1.6;

/// At the end of a stop or a shake, s: where it is looked at.
const LOOK_S: f64 = 0.3;

/// Peak to peak of the table at which a loop counts as unstable, µm: a loop at rest shows the noise of its scale, below 0.2.
const SWING_UM: f64 = 1.0;

/// A feedback system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System {
    /// Which position is fed back.
    pub feedback: Feedback,
    /// T' of dual feedback, s.
    pub shift_s: f64,
}

/// Distance from table to command, µm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Greatest.
    pub most_um: f64,
    /// Root of the mean square.
    pub rms_um: f64,
}

impl Errors {
    fn of(errors_um: &[f64]) -> Self {
        let squares = errors_um.iter().map(|error| error * error).sum::<f64>();
        Self {
            most_um: errors_um.iter().fold(0.0, |most, error| most.max(error.abs())),
            rms_um: (squares / errors_um.len().max(1) as f64).sqrt(),
        }
    }
}

/// The machine file with this system and gain (1/s).
fn machine(system: System, gain_per_s: f64) -> Result<Machine, ReproduceError> {
    let mut machine = Machine::parse(MACHINE, "machine.toml")
        .map_err(|error| ReproduceError::Numerics(error.to_string()))?;
    for axis in machine.axis.values_mut() {
        axis.feedback = system.feedback;
        axis.dual_feedback_time_constant_s = Some(system.shift_s);
        axis.position_gain_per_s = Some(gain_per_s);
    }
    Ok(machine)
}

fn log(machine: &Machine, blocks: &[PathBlock]) -> Result<Log, SimulationError> {
    let start_m = [0.0];
    let mut controller = controller(machine, Format::Fixed, &start_m)?;
    let instruments = Instruments::typical(SEED);
    let run = Run { machine, instruments, start_m: &start_m, blocks, start_s: 0.0 };
    run.log(controller.as_mut(), |_, _, _| ())
}

fn to(target_m: f64, feed_m_per_s: f64) -> PathBlock {
    PathBlock::new(PathShape::Line { to_m: vec![target_m] }, feed_m_per_s, ACCELERATION)
}

/// Command (mm) and table − command (µm), row by row.
fn errors(log: &Log) -> Vec<(f64, f64)> {
    let axis = &log.axes[0];
    let [command, table] = [&axis.command, &axis.table].map(|channel| channel.as_deref().unwrap_or(&[]));
    command.iter().zip(table).map(|(&command, &table)| (command, 1e3 * (table - command))).collect()
}

/// Places at stops from below, then from above, µm: the mean over the end of each stop.
pub fn stops_um(system: System, gain_per_s: f64) -> Result<Vec<f64>, ReproduceError> {
    let machine = machine(system, gain_per_s)?;
    let place = |stop: u32| f64::from(stop) * PITCH_M;
    let up = 1..=STOPS;
    // Beyond the last one, so that all of the way back comes from above.
    let turn = to(place(STOPS + 1), 0.1);
    let stand = |target_m| [to(target_m, 0.1), PathBlock::dwell(STAND_S)];
    let blocks: Vec<PathBlock> = (up.clone().flat_map(|stop| stand(place(stop))))
        .chain([turn])
        .chain(up.rev().flat_map(|stop| stand(place(stop))))
        .collect();
    let log = log(&machine, &blocks)?;
    let rows = |seconds: f64| seconds / log.sample_time_s;
    let mut found = Vec::new();
    for stop in errors(&log).chunk_by(|a, b| a.0.to_bits() == b.0.to_bits()) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred rows")]
        let look = rows(LOOK_S) as usize;
        if stop.len() as f64 > rows(0.5 * STAND_S) {
            let end = &stop[stop.len() - look..];
            found.push(end.iter().map(|row| row.1).sum::<f64>() / look as f64);
        }
    }
    Ok(found)
}

/// Errors at the stops.
///
/// # Errors
/// When the loop does not hold.
pub fn positioning(system: System, gain_per_s: f64) -> Result<Errors, ReproduceError> {
    Ok(Errors::of(&stops_um(system, gain_per_s)?))
}

/// Errors on a slow way up and down again, once it goes steadily.
///
/// # Errors
/// When the loop does not hold.
pub fn creeping(system: System, gain_per_s: f64) -> Result<Errors, ReproduceError> {
    const FEED_M_PER_S: f64 = 5e-3;
    const FAR_M: f64 = 0.04;
    let machine = machine(system, gain_per_s)?;
    let log = log(&machine, &[to(FAR_M, FEED_M_PER_S), to(0.0, FEED_M_PER_S)])?;
    let errors = errors(&log);
    // In the middle half of the travel it has gone steadily for a second or more, either way.
    let middle = 250.0 * FAR_M..750.0 * FAR_M;
    let steady: Vec<f64> =
        errors.iter().filter(|(command, _)| middle.contains(command)).map(|row| row.1).collect();
    Ok(Errors::of(&steady))
}

/// How much the table still swings, peak to peak, µm, some time after a jump of a millimetre; infinite where the loop
/// ran away.
pub fn swing_um(system: System, gain_per_s: f64) -> Result<f64, ReproduceError> {
    let machine = machine(system, gain_per_s)?;
    let blocks = [PathBlock::dwell(0.05), to(1e-3, 0.05), PathBlock::dwell(STAND_S)];
    let log = match log(&machine, &blocks) {
        Ok(log) => log,
        Err(SimulationError::Fault { .. }) => return Ok(f64::INFINITY),
        Err(other) => return Err(other.into()),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred rows")]
    let look = (LOOK_S / log.sample_time_s) as usize;
    let errors = errors(&log);
    let end = errors[errors.len().saturating_sub(look)..].iter().map(|row| row.1);
    Ok(end.clone().fold(f64::MIN, f64::max) - end.fold(f64::MAX, f64::min))
}

/// The gain, 1/s, up to which the loop comes to rest: found by halving, to 1 %.
///
/// # Errors
/// When a setting is refused.
pub fn highest_gain_per_s(system: System) -> Result<f64, ReproduceError> {
    let (mut calm, mut wild) = (1.0, 1000.0);
    while wild > 1.01 * calm {
        let between = f64::sqrt(calm * wild);
        if swing_um(system, between)? < SWING_UM { calm = between } else { wild = between }
    }
    Ok(calm)
}
