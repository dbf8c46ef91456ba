//! One feedback system on the massive table: position errors of the table, and the maximum stable gain.

use crate::reproduce::study::ReproduceError;
use files::log::Log;
use model::axis::Feedback;
use model::machine::Machine;
use motion::{PathBlock, PathShape};
use plant::instruments::Instruments;
use plant::simulate::{Run, SimulationError, controller};
use shared::scalar::Format;

/// The machine that all systems run on.
const MACHINE: &str = include_str!("machine.toml");

/// Seed of the sensor noise.
const SEED: u64 = 1977;

/// Acceleration of all other movements, m/s².
const ACCELERATION: f64 = 1.0;

/// Acceleration of the slow traverse, m/s²: low, so that the start contributes no error.
const SLOW_ACCELERATION: f64 = 0.02;

/// Distance between two stops, m.
const STOP_PITCH_M: f64 = 0.023;

/// Stops per direction.
const STOPS: u32 = 6;

/// Dwell at a stop, s: eight times the largest T' that is run.
const DWELL_S: f64 = 1.6;

/// Duration at the end of a dwell or a stability test that is evaluated, s.
const EVALUATED_S: f64 = 0.3;

/// Peak-to-peak position error above which a loop counts as unstable, µm. A stable loop shows 0.2 µm of scale noise, and
/// about 4 µm of pitch error along the path.
const OSCILLATION_LIMIT_UM: f64 = 5.0;

/// A feedback system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System {
    /// Which position is fed back.
    pub feedback: Feedback,
    /// Time constant T' of dual feedback, s.
    pub dual_s: f64,
    /// Stiffness of the drive over that of the machine file.
    pub stiffness_factor: f64,
}

impl System {
    /// A system with the stiffness of the machine file.
    pub const fn new(feedback: Feedback, dual_s: f64) -> Self {
        Self { feedback, dual_s, stiffness_factor: 1.0 }
    }
}

/// Size of the position errors (table − command).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Maximum absolute error, µm.
    pub max_um: f64,
    /// Rms error, µm.
    pub rms_um: f64,
}

impl Errors {
    fn from_um(errors_um: &[f64]) -> Self {
        Self {
            max_um: numerics::max_abs(errors_um.iter().copied()),
            rms_um: numerics::rms(errors_um.iter().copied()),
        }
    }
}

/// The machine file with a feedback system and a gain (1/s).
fn machine(system: System, gain_per_s: f64) -> Result<Machine, ReproduceError> {
    let mut machine = Machine::parse(MACHINE, "machine.toml")
        .map_err(|error| ReproduceError::Numerics(error.to_string()))?;
    for axis in machine.axis.values_mut() {
        axis.settings.sensors.feedback = system.feedback;
        axis.settings.sensors.dual_feedback_time_constant_s = Some(system.dual_s);
        axis.settings.controller.position_gain_per_s = Some(gain_per_s);
        axis.settings.mechanics.stiffness_n_per_um =
            axis.settings.mechanics.stiffness_n_per_um.map(|stiffness| system.stiffness_factor * stiffness);
    }
    Ok(machine)
}

/// Runs a path from 0.
fn log(machine: &Machine, blocks: &[PathBlock]) -> Result<Log, SimulationError> {
    let start_m = [0.0];
    let mut controller = controller(machine, Format::Fixed, &start_m)?;
    let instruments = Instruments::typical(SEED);
    let run = Run { machine, instruments, start_m: &start_m, blocks, start_s: 0.0 };
    run.log(controller.as_mut(), |_, _, _| ())
}

/// A line to a position.
fn line_to(target_m: f64, feed_m_per_s: f64) -> PathBlock {
    PathBlock::new(PathShape::Line { to_m: vec![target_m] }, feed_m_per_s, ACCELERATION)
}

/// One row of the log.
#[derive(Clone, Copy, Debug)]
struct Row {
    /// Commanded position.
    command_mm: f64,
    /// Motor − command.
    motor_um: f64,
    /// Table − command.
    table_um: f64,
}

/// Errors over the log.
fn rows(log: &Log) -> Vec<Row> {
    let axis = &log.axes[0];
    let [command, motor, table] =
        [&axis.command, &axis.motor, &axis.table].map(|channel| channel.as_deref().unwrap_or(&[]));
    let row = |((&command_mm, &motor), &table): ((&f64, &f64), &f64)| Row {
        command_mm,
        motor_um: 1e3 * (motor - command_mm),
        table_um: 1e3 * (table - command_mm),
    };
    command.iter().zip(motor).zip(table).map(row).collect()
}

/// Errors at the stops, approached from below, then from above, µm: mean over the end of each dwell.
fn stop_errors_um(system: System, gain_per_s: f64) -> Result<Vec<f64>, ReproduceError> {
    let machine = machine(system, gain_per_s)?;
    let position = |stop: u32| f64::from(stop) * STOP_PITCH_M;
    let up = 1..=STOPS;
    // Beyond the last stop, so that all stops on the way back are approached from above.
    let overrun = line_to(position(STOPS + 1), 0.1);
    let stop_at = |target_m| [line_to(target_m, 0.1), PathBlock::dwell(DWELL_S)];
    let blocks: Vec<PathBlock> = (up.clone().flat_map(|stop| stop_at(position(stop))))
        .chain([overrun])
        .chain(up.rev().flat_map(|stop| stop_at(position(stop))))
        .collect();
    let log = log(&machine, &blocks)?;
    let count = |seconds: f64| seconds / log.sample_time_s;
    let mut found = Vec::new();
    for stop in rows(&log).chunk_by(|a, b| a.command_mm.to_bits() == b.command_mm.to_bits()) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "several hundred rows")]
        let evaluated = count(EVALUATED_S) as usize;
        if stop.len() as f64 > count(0.5 * DWELL_S) {
            let end = &stop[stop.len() - evaluated..];
            found.push(numerics::mean(end.iter().map(|row| row.table_um)));
        }
    }
    Ok(found)
}

/// Errors at stops approached from both sides.
///
/// # Errors
/// If the simulation fails.
pub fn positioning_errors(system: System, gain_per_s: f64) -> Result<Errors, ReproduceError> {
    Ok(Errors::from_um(&stop_errors_um(system, gain_per_s)?))
}

/// Length of the slow traverse, mm.
pub const TRAVERSE_MM: f64 = 40.0;

/// Command (mm) and table − command (µm) on a slow traverse back and forth.
///
/// # Errors
/// If the simulation fails.
pub fn slow_traverse(system: System, gain_per_s: f64) -> Result<Vec<(f64, f64)>, ReproduceError> {
    const FEED_M_PER_S: f64 = 5e-3;
    let machine = machine(system, gain_per_s)?;
    let slow =
        |target_m| PathBlock { acceleration_m_per_s2: SLOW_ACCELERATION, ..line_to(target_m, FEED_M_PER_S) };
    let log = log(&machine, &[slow(1e-3 * TRAVERSE_MM), slow(0.0)])?;
    Ok(rows(&log).iter().map(|row| (row.command_mm, row.table_um)).collect())
}

/// Errors on the slow traverse, in the middle half of the travel: 2 s after each start.
pub fn steady_errors(traverse: &[(f64, f64)]) -> Errors {
    let middle = 0.25 * TRAVERSE_MM..0.75 * TRAVERSE_MM;
    let steady: Vec<f64> = traverse.iter().filter(|row| middle.contains(&row.0)).map(|row| row.1).collect();
    Errors::from_um(&steady)
}

/// Oscillation of motor or table about the command, peak to peak, µm, on a slow movement after a jump; infinite if the
/// controller faults.
///
/// The axis must move: at rest, friction can hold an unstable table, and the motor can oscillate within the backlash
/// without an effect on the table.
fn oscillation_um(system: System, gain_per_s: f64) -> Result<f64, ReproduceError> {
    let machine = machine(system, gain_per_s)?;
    let blocks = [PathBlock::dwell(0.05), line_to(1e-3, 0.05), line_to(7e-3, 2e-3)];
    let log = match log(&machine, &blocks) {
        Ok(log) => log,
        Err(SimulationError::Fault { .. }) => return Ok(f64::INFINITY),
        Err(other) => return Err(other.into()),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "several hundred rows")]
    let evaluated = (EVALUATED_S / log.sample_time_s) as usize;
    let rows = rows(&log);
    let end = &rows[rows.len().saturating_sub(evaluated)..];
    let peak_to_peak = |of: fn(&Row) -> f64| numerics::peak_to_peak(end.iter().map(of));
    Ok(peak_to_peak(|row| row.motor_um).max(peak_to_peak(|row| row.table_um)))
}

/// Maximum position gain, 1/s, at which the loop does not oscillate; by bisection to 1 %.
///
/// # Errors
/// If a setting is rejected.
pub fn max_gain_per_s(system: System) -> Result<f64, ReproduceError> {
    // Lower: the jump would not settle in time. Upper: the limit of a position loop at 2 kHz.
    let (mut stable, mut unstable) = (4.0, 2000.0);
    while unstable > 1.01 * stable {
        let middle = f64::sqrt(stable * unstable);
        if oscillation_um(system, middle)? < OSCILLATION_LIMIT_UM {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    Ok(stable)
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    const SYSTEMS: [System; 3] = [
        System::new(Feedback::Motor, 0.2),
        System::new(Feedback::Table, 0.2),
        System::new(Feedback::Dual, 0.2),
    ];

    /// Maximum real part of the eigenvalues of the linear loop in motion, 1/s: backlash closed by friction, presliding
    /// saturated, so that only the viscous friction varies.
    ///
    /// The holds of position and velocity loop (half a tick each, and another half for the velocity from the position
    /// difference) are first-order lags.
    fn max_real_part(system: System, gain_per_s: f64) -> f64 {
        let machine = machine(system, gain_per_s).unwrap();
        let axis = &machine.axis["x"];
        let [m, table_kg] =
            [axis.settings.mechanics.motor_mass_kg.unwrap(), axis.settings.mechanics.table_mass_kg.unwrap()];
        let (k, c) = (
            1e6 * axis.settings.mechanics.stiffness_n_per_um.unwrap(),
            axis.settings.mechanics.damping_n_s_per_m.unwrap(),
        );
        let b = axis.settings.mechanics.viscous_n_s_per_m.unwrap();
        let (kv, ti) = (
            axis.settings.controller.velocity_gain_n_s_per_m.unwrap(),
            axis.settings.controller.velocity_integral_time_s.unwrap(),
        );
        let omega = std::f64::consts::TAU * axis.settings.filters.low_pass_frequency_hz.unwrap();
        let zeta = axis.settings.filters.low_pass_damping_ratio.unwrap();
        let position_hold_s = 0.5 / machine.sample_rate_hz;
        let velocity_hold_s = 1.0 / machine.velocity_rate_hz();
        let drive_s = Instruments::typical(0).drive_time_constant_s;
        // Weights of motor, table and shift in the feedback.
        let (of_motor, of_table, of_shift) = match system.feedback {
            Feedback::Motor => (1.0, 0.0, 0.0),
            Feedback::Table => (0.0, 1.0, 0.0),
            Feedback::Dual => (1.0, 0.0, 1.0),
        };
        // 0 motor, 1 its velocity, 2 table, 3 its velocity, 4 shift, 5 held feedback, 6 integral of the velocity error,
        // 7 force after the low-pass, 8 its rate, 9 held force, 10 force of the drive.
        let mut a = SMatrix::<f64, 11, 11>::zeros();
        a[(0, 1)] = 1.0;
        a[(2, 3)] = 1.0;
        for (column, force) in [(0, k), (1, c), (2, -k), (3, -c)] {
            a[(1, column)] -= force / m;
            a[(3, column)] += force / table_kg;
        }
        a[(3, 3)] -= b / table_kg;
        a[(1, 10)] = 1.0 / m;
        for (column, weight) in [(2, 1.0), (0, -1.0), (4, -1.0)] {
            a[(4, column)] = weight / system.dual_s;
        }
        for (column, weight) in [(0, of_motor), (2, of_table), (4, of_shift), (5, -1.0)] {
            a[(5, column)] += weight / position_hold_s;
        }
        a[(6, 5)] = -gain_per_s;
        a[(6, 1)] = -1.0;
        a[(7, 8)] = 1.0;
        for (column, force) in [(5, -kv * gain_per_s), (1, -kv), (6, kv / ti), (7, -1.0)] {
            a[(8, column)] += omega * omega * force;
        }
        a[(8, 8)] = -2.0 * zeta * omega;
        for (row, from, lag_s) in [(9, 7, velocity_hold_s), (10, 9, drive_s)] {
            a[(row, from)] = 1.0 / lag_s;
            a[(row, row)] = -1.0 / lag_s;
        }
        let matrix = nalgebra::DMatrix::from_fn(11, 11, |row, column| a[(row, column)]);
        numerics::max(matrix.complex_eigenvalues().iter().map(|value| value.re))
    }

    /// The maximum gain is the stability limit of the linear loop, to 10 %: first-order lags replace the sampling, and an
    /// oscillation counts only above its limit.
    #[test]
    fn the_maximum_gain_is_the_limit_of_the_linear_loop() {
        for system in SYSTEMS {
            let (mut stable, mut unstable) = (4.0, 2000.0);
            while unstable > 1.001 * stable {
                let middle = f64::sqrt(stable * unstable);
                if max_real_part(system, middle) < 1e-9 { stable = middle } else { unstable = middle }
            }
            let found = max_gain_per_s(system).unwrap();
            println!("{:?}: {found:.1} on the machine, {stable:.1} of the linear loop, 1/s", system.feedback);
            assert!((found / stable - 1.0).abs() < 0.1, "{system:?}: {found} for {stable}");
        }
    }

    /// Semi-closed, a stop from above and from below differs by the backlash plus at most the wind-up by friction,
    /// 2·300 N/(50 N/µm). The other two systems reach the same position from both sides.
    #[test]
    fn semi_closed_stops_differ_by_the_backlash() {
        for system in SYSTEMS {
            let stops = stop_errors_um(system, 50.0).unwrap();
            assert_eq!(stops.len(), 2 * STOPS as usize);
            let (up, down) = stops.split_at(STOPS as usize);
            for (below, above) in up.iter().zip(down.iter().rev()) {
                let difference = above - below;
                let expected = if system.feedback == Feedback::Motor { 20.0..32.0 } else { -1.0..1.0 };
                assert!(expected.contains(&difference), "{system:?}: {difference}");
            }
        }
    }
}
