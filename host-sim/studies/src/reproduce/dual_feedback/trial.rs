//! One feedback system on the massive table: how far the table is from the command, and at which gain the loop begins
//! to swing.

use crate::reproduce::ReproduceError;
use files::log::Log;
use link::controller::{Format, PathBlock, PathShape};
use model::machine::{Feedback, Machine};
use plant::instruments::Instruments;
use plant::simulate::{Run, SimulationError, controller};

/// The machine that every system is tried on.
const MACHINE: &str = include_str!("machine.toml");

/// Of the sensors' noise.
const SEED: u64 = 1977;

/// m/s².
const ACCELERATION: f64 = 1.0;

/// Of the slow ways, m/s²: they are to show the errors of the way, not of its beginning.
const SLOW_ACCELERATION: f64 = 0.02;

/// Between two stops, m.
const PITCH_M: f64 = 0.023;

/// Stops each way.
const STOPS: u32 = 6;

/// At a stop, s: eight time constants of the slowest dual feedback that is tried.
const STAND_S: f64 = 1.6;

/// At the end of a stop or a shake, s: where it is looked at.
const LOOK_S: f64 = 0.3;

/// Peak to peak of the table at which a loop counts as unstable, µm: a loop at rest shows the noise of its
/// scale, below 0.2, and the way itself 4 of pitch error.
const SWING_UM: f64 = 5.0;

/// A feedback system on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct System {
    /// Which position is fed back.
    pub feedback: Feedback,
    /// T' of dual feedback, s.
    pub shift_s: f64,
    /// Of the drive, times that of the machine file.
    pub stiffness: f64,
}

impl System {
    /// On the machine as it is.
    pub const fn new(feedback: Feedback, shift_s: f64) -> Self {
        Self { feedback, shift_s, stiffness: 1.0 }
    }
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
        Self {
            most_um: numerics::max_abs(errors_um.iter().copied()),
            rms_um: numerics::rms(errors_um.iter().copied()),
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
        axis.stiffness_n_per_um = axis.stiffness_n_per_um.map(|stiffness| system.stiffness * stiffness);
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

/// A row of the log.
#[derive(Clone, Copy, Debug)]
struct Row {
    command_mm: f64,
    /// Motor − command.
    motor_um: f64,
    /// Table − command.
    table_um: f64,
}

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

/// Places at stops from below, then from above, µm: the mean over the end of each stop.
fn stops_um(system: System, gain_per_s: f64) -> Result<Vec<f64>, ReproduceError> {
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
    let count = |seconds: f64| seconds / log.sample_time_s;
    let mut found = Vec::new();
    for stop in rows(&log).chunk_by(|a, b| a.command_mm.to_bits() == b.command_mm.to_bits()) {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred rows")]
        let look = count(LOOK_S) as usize;
        if stop.len() as f64 > count(0.5 * STAND_S) {
            let end = &stop[stop.len() - look..];
            found.push(numerics::mean(end.iter().map(|row| row.table_um)));
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

/// How far a slow way goes, mm.
pub const FAR_MM: f64 = 40.0;

/// Command (mm) and table − command (µm) on a slow way up and down again.
///
/// # Errors
/// When the loop does not hold.
pub fn creep(system: System, gain_per_s: f64) -> Result<Vec<(f64, f64)>, ReproduceError> {
    const FEED_M_PER_S: f64 = 5e-3;
    let machine = machine(system, gain_per_s)?;
    let slow =
        |target_m| PathBlock { acceleration_m_per_s2: SLOW_ACCELERATION, ..to(target_m, FEED_M_PER_S) };
    let log = log(&machine, &[slow(1e-3 * FAR_MM), slow(0.0)])?;
    Ok(rows(&log).iter().map(|row| (row.command_mm, row.table_um)).collect())
}

/// Errors on that way in the middle half of the travel, where it has gone steadily for two seconds, either way.
pub fn steady(creep: &[(f64, f64)]) -> Errors {
    let middle = 0.25 * FAR_MM..0.75 * FAR_MM;
    let steady: Vec<f64> = creep.iter().filter(|row| middle.contains(&row.0)).map(|row| row.1).collect();
    Errors::of(&steady)
}

/// How much motor or table swings about the command, peak to peak, µm, on a creeping way that begins with a jump;
/// infinite where the loop ran away.
///
/// At rest friction would hold a table that a moving one shows to be unstable, and a motor would swing in the gap
/// unseen.
fn swing_um(system: System, gain_per_s: f64) -> Result<f64, ReproduceError> {
    let machine = machine(system, gain_per_s)?;
    let blocks = [PathBlock::dwell(0.05), to(1e-3, 0.05), to(7e-3, 2e-3)];
    let log = match log(&machine, &blocks) {
        Ok(log) => log,
        Err(SimulationError::Fault { .. }) => return Ok(f64::INFINITY),
        Err(other) => return Err(other.into()),
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred rows")]
    let look = (LOOK_S / log.sample_time_s) as usize;
    let rows = rows(&log);
    let end = &rows[rows.len().saturating_sub(look)..];
    let swing = |of: fn(&Row) -> f64| numerics::peak_to_peak(end.iter().map(of));
    Ok(swing(|row| row.motor_um).max(swing(|row| row.table_um)))
}

/// The gain, 1/s, up to which the loop comes to rest: found by halving, to 1 %.
///
/// # Errors
/// When a setting is refused.
pub fn highest_gain_per_s(system: System) -> Result<f64, ReproduceError> {
    // Below, a jump has not settled in time; above, the position loop at 2 kHz has no gain.
    let (mut calm, mut wild) = (4.0, 2000.0);
    while wild > 1.01 * calm {
        let between = f64::sqrt(calm * wild);
        if swing_um(system, between)? < SWING_UM { calm = between } else { wild = between }
    }
    Ok(calm)
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

    /// Greatest real part of the eigenvalues of the loop in motion at a gain, 1/s: the gap stays closed under friction,
    /// whose bristles are bent through, so that its force stands but for the viscous part.
    ///
    /// The position loop's hold and the velocity loop's (half a tick each, and half a tick more of its difference of
    /// positions) are lags of the first order.
    fn growth(system: System, gain_per_s: f64) -> f64 {
        let machine = machine(system, gain_per_s).unwrap();
        let axis = &machine.axis["x"];
        let [m, table_kg] = [axis.motor_mass_kg.unwrap(), axis.table_mass_kg.unwrap()];
        let (k, c) = (1e6 * axis.stiffness_n_per_um.unwrap(), axis.damping_n_s_per_m.unwrap());
        let b = axis.viscous_n_s_per_m.unwrap();
        let (kv, ti) = (axis.velocity_gain_n_s_per_m.unwrap(), axis.velocity_integral_time_s.unwrap());
        let omega = std::f64::consts::TAU * axis.low_pass_frequency_hz.unwrap();
        let zeta = axis.low_pass_damping_ratio.unwrap();
        let position_hold_s = 0.5 / machine.sample_rate_hz;
        let velocity_hold_s = 1.0 / machine.velocity_rate_hz();
        let drive_s = Instruments::typical(0).drive_time_constant_s;
        // Shares of motor, table and shift in the feedback.
        let (of_motor, of_table, of_shift) = match system.feedback {
            Feedback::Motor => (1.0, 0.0, 0.0),
            Feedback::Table => (0.0, 1.0, 0.0),
            Feedback::Dual => (1.0, 0.0, 1.0),
        };
        // 0 motor, 1 its velocity, 2 table, 3 its velocity, 4 shift, 5 feedback as held, 6 integral of the velocity's
        // error, 7 force behind the low-pass, 8 its rate, 9 force as held, 10 force of the drive.
        let mut a = SMatrix::<f64, 11, 11>::zeros();
        a[(0, 1)] = 1.0;
        a[(2, 3)] = 1.0;
        for (column, force) in [(0, k), (1, c), (2, -k), (3, -c)] {
            a[(1, column)] -= force / m;
            a[(3, column)] += force / table_kg;
        }
        a[(3, 3)] -= b / table_kg;
        a[(1, 10)] = 1.0 / m;
        for (column, share) in [(2, 1.0), (0, -1.0), (4, -1.0)] {
            a[(4, column)] = share / system.shift_s;
        }
        for (column, share) in [(0, of_motor), (2, of_table), (4, of_shift), (5, -1.0)] {
            a[(5, column)] += share / position_hold_s;
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

    /// Where the machine begins to swing, its linear loop is at its limit: within a tenth, for lags in place of ticks
    /// and for what a swing has to grow to.
    #[test]
    fn the_highest_gain_is_the_limit_of_the_linear_loop() {
        for system in SYSTEMS {
            let (mut calm, mut wild) = (4.0, 2000.0);
            while wild > 1.001 * calm {
                let between = f64::sqrt(calm * wild);
                if growth(system, between) < 1e-9 { calm = between } else { wild = between }
            }
            let found = highest_gain_per_s(system).unwrap();
            println!("{:?}: {found:.1} on the machine, {calm:.1} of the linear loop, 1/s", system.feedback);
            assert!((found / calm - 1.0).abs() < 0.1, "{system:?}: {found} for {calm}");
        }
    }

    /// Semi-closed, the same stop from above and from below is apart by the backlash, and by no more than the wind-up
    /// under friction either way on top, 2·300 N/(50 N/µm); the other two reach it from both sides.
    #[test]
    fn stops_are_apart_by_the_backlash() {
        for system in SYSTEMS {
            let stops = stops_um(system, 50.0).unwrap();
            assert_eq!(stops.len(), 2 * STOPS as usize);
            let (up, down) = stops.split_at(STOPS as usize);
            for (below, above) in up.iter().zip(down.iter().rev()) {
                let apart = above - below;
                let expected = if system.feedback == Feedback::Motor { 20.0..32.0 } else { -1.0..1.0 };
                assert!(expected.contains(&apart), "{system:?}: {apart}");
            }
        }
    }
}
