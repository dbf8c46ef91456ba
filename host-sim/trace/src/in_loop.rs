//! The model in its loop behind a measured command.

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::control::hpc::Hpc;
use shared::units::Position;

use super::signals::AxisSignals;
use model::servo::ServoParameters;
use plant::driven::{DrivenTable, Prescribed};
use plant::mechanics::Stepper;
use plant::motion::AxisMotion;
use plant::parameters::AxisParameters;

/// How much longer the steps of a loop may be than those of a simulation: nanometres are asked for, not their hundredths.
const COARSER: f64 = 2.0;

/// A spring that needs more steps a tick is taken for a slip of the unit: its loop is not run.
const MOST_SUBSTEPS: u32 = 500;

/// Closes the loop in simulation on the measured command, with a force (N) that is added to the controller's from each
/// sample to the next; where that is shorter than the command, nothing is added. Gives the motor reading, m, or `None`
/// when the settings are refused.
#[must_use]
pub fn closed_loop(
    parameters: &AxisParameters,
    settings: &AxisSettings,
    rates: Rates,
    command: &[f64],
    added_n: &[f64],
    start: Start,
) -> Option<Loop> {
    let mut config = AxisConfig::<f64>::new(settings, rates).ok()?;
    let ServoParameters { drive_late_s, filter_step_s, .. } = parameters.servo;
    if let Some(hpc) = &mut config.position.hpc {
        let gain = settings.position_gain_per_s;
        let sample_s = f64::from(rates.position_loop_divider) / rates.velocity_loop_hz;
        *hpc = Hpc::stepped(gain * sample_s, gain * filter_step_s);
    }
    let tick_s = 1.0 / rates.velocity_loop_hz;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, a handful")]
    let substeps = (tick_s / (COARSER * parameters.step_s())).ceil() as u32;
    if substeps > MOST_SUBSTEPS {
        return None;
    }
    let stepper = Stepper::new(parameters, 0.0, tick_s / f64::from(substeps));
    let position = |m: f64| Position::from_m(m).unwrap_or_default();

    let (&first, &second) = (command.first()?, command.get(1)?);
    let Start { motor_m: motor, velocity, table_m, is_settled } = start;
    let mut motion = in_motion(parameters, motor - parameters.dividing_m(motor), velocity);
    motion.table_m = table_m.unwrap_or(motion.table_m);
    // A force that acts late is one before which the sensors are read early.
    let read = |motion: &AxisMotion| {
        let motor_m = motion.motor_m - drive_late_s * motion.motor_m_per_s;
        let table_m = motion.table_m - drive_late_s * motion.table_m_per_s;
        Reading { motor: position(motor_m + parameters.dividing_m(motor_m)), table: Some(position(table_m)) }
    };
    let before = |m: f64, velocity: f64| position(m - velocity * tick_s);
    let command_before = position(first - (second - first));
    let seen_m = if is_settled { motion.table_m } else { motor };
    let reading_before = Reading { motor: before(motor, velocity), table: Some(before(seen_m, velocity)) };
    let mut state = AxisState::<f64>::at_rest(command_before, reading_before);

    let mut result = Loop::default();
    let mut last_n = 0.0;
    for (i, &command) in command.iter().enumerate() {
        let added_n = added_n.get(i).copied().unwrap_or(0.0);
        let reading = read(&motion);
        result.motor_m.push(reading.motor.to_m());
        result.table_m.push(reading.table.map_or(0.0, Position::to_m));
        result.force_n.push(last_n);
        state.position_tick(&config, position(command), 0, reading);
        for tick in 0..rates.position_loop_divider {
            let reading = if tick == 0 { reading } else { read(&motion) };
            let (force, _) = state.velocity_tick(&config, reading, added_n);
            last_n = force;
            for _ in 0..substeps {
                stepper.step(parameters, &mut motion, force);
            }
        }
    }
    Some(result)
}

/// Where and how a closed loop starts.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// What the motor's sensor reads, m.
    pub motor_m: f64,
    /// m/s.
    pub velocity: f64,
    /// Where the table is, m; `None`: where the motor would have it.
    pub table_m: Option<f64>,
    /// Whether the loop has been closed for long: what it knows of the table is what the table is.
    pub is_settled: bool,
}

impl Start {
    /// As a log begins, with the linear scale's zero, m.
    ///
    /// A motor that moves while its command stands has just been switched on. Its table is wherever it is: the spring
    /// may be strained, and the machine then begins with a jolt.
    #[must_use]
    pub fn of(command: &[f64], signals: &AxisSignals, zero_m: f64) -> Option<Self> {
        /// Samples over which the command must stand.
        const STANDS: usize = 20;
        /// Standard deviations of the motor's noise.
        const NOISE: f64 = 6.0;
        let motor = signals.motor.as_ref()?;
        let first = motor.raw[0];
        let stands = command.len() > STANDS
            && command[..STANDS].windows(2).all(|two| two[0].to_bits() == two[1].to_bits());
        let moves = |later: &[f64]| {
            let way = numerics::mean(later.iter().copied()) - first;
            way.abs() > NOISE * motor.noise
        };
        if stands && motor.raw[1..STANDS].chunks(5).any(moves) {
            let table_m = signals.table.as_ref().map(|table| table.raw[0] - zero_m);
            return Some(Self { motor_m: first, velocity: 0.0, table_m, is_settled: false });
        }
        let velocity = if stands { 0.0 } else { motor.velocity[0] };
        Some(Self { motor_m: motor.position[0], velocity, table_m: None, is_settled: true })
    }
}

/// An axis that moves steadily with its motor at a place, m.
pub(super) fn in_motion(parameters: &AxisParameters, motor_m: f64, velocity: f64) -> AxisMotion {
    let nominal_m = parameters.screw.nominal_m(motor_m);
    let screw = Prescribed { nominal_m, velocity, ..Prescribed::default() };
    let table = DrivenTable::settled(parameters, screw);
    AxisMotion {
        motor_m,
        motor_m_per_s: velocity,
        table_m: table.position_m(parameters, screw),
        table_m_per_s: velocity,
        bristle_m: table.bristle_m(),
        lately_m_per_s: table.lately_m_per_s(),
        friction_n: parameters.friction.bristle_stiffness_n_per_m * table.bristle_m(),
        ..AxisMotion::default()
    }
}

/// A simulated closed loop, at its samples.
#[derive(Clone, Debug, Default)]
pub struct Loop {
    /// Motor reading, m.
    pub motor_m: Vec<f64>,
    /// Table, m.
    pub table_m: Vec<f64>,
    /// Force of the last velocity tick, N.
    pub force_n: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::Signals;
    use files::log::{AxisLog, Log, Unit};
    use model::machine::Machine;
    use model::servo;

    /// A second of a motor that stands, or goes by 1 µm within the first 10 ms, while its command stands.
    fn start(way_mm: f64) -> Start {
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        let place = |i: u32| 5.0 + way_mm * (f64::from(i) / 10.0).min(1.0);
        // ±10 nm of noise, alternating.
        let noise = |i: u32| if i.is_multiple_of(2) { 1e-5 } else { -1e-5 };
        axis.command = Some(vec![5.0; 1000]);
        axis.motor = Some((0..1000).map(|i| place(i) + noise(i)).collect());
        axis.table = Some((0..1000).map(|i| place(i) + 2e-3 + noise(i)).collect());
        let log = Log { source: String::new(), start_s: 0.0, sample_time_s: 1e-3, axes: vec![axis] };
        let signals = &Signals::new(&log, &["x".to_owned()]).axes[0];
        Start::of(signals.command.as_ref().unwrap(), signals, 0.5e-6).unwrap()
    }

    #[test]
    fn a_motor_that_moves_behind_a_standing_command_was_just_switched_on() {
        let resting = start(0.0);
        assert!(resting.is_settled && resting.table_m.is_none(), "{resting:?}");
        let switched_on = start(1e-3);
        assert!(!switched_on.is_settled, "{switched_on:?}");
        // 2 µm beside the motor, of which half a micrometre is the scale's zero; 10 nm of noise either way.
        let strain_m = switched_on.table_m.unwrap() - switched_on.motor_m;
        assert!((strain_m - 1.5e-6).abs() < 1e-9, "{strain_m:e}");
        assert!((switched_on.motor_m - 5e-3 - 1e-8).abs() < 1e-12);
    }

    /// Half a second at rest, pushed by an added force from the first sample on: the greatest force either way.
    fn greatest_n(limit_n: f64, added_n: f64) -> f64 {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let parameters = AxisParameters::of(&machine.axis["x"]);
        let settings = servo::settings(&machine.axis["x"], &parameters.servo).unwrap();
        let settings = AxisSettings { force_limit_n: limit_n, ..settings };
        let start = Start { motor_m: 0.0, velocity: 0.0, table_m: None, is_settled: true };
        let command = [0.0; 500];
        let rates = servo::rates(&machine);
        let pushed = closed_loop(&parameters, &settings, rates, &command, &[added_n; 500], start).unwrap();
        numerics::max_abs(pushed.force_n)
    }

    /// The drive gives what controller and added force ask for together, within its limit.
    #[test]
    fn an_added_force_is_within_the_limit_of_the_drive() {
        assert!((greatest_n(300.0, 1000.0) - 300.0).abs() < 1e-9);
        // The motor's 90 kg under Kv = 6e4 N·s/m follow with 1.5 ms. In the last of the four ticks of the first sample,
        // 0.75 ms behind the first, the controller has taken back what brings 1000 N to e^(−0.5) of it, at the most; it
        // knows a velocity that is half a tick old of a tick ago, and friction and spring help: e^(−0.25) at the least.
        let free = greatest_n(20_000.0, 1000.0);
        assert!((606.0..779.0).contains(&free), "{free}");
    }
}
