//! What the model gives for each stage, driven by the measured signal upstream of it.

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::control::hpc::Hpc;
use shared::units::Position;

use super::follow::{self, delayed};
use super::motor_path::MotorPath;
use super::signals::{AxisSignals, Signals, Smooth};
use crate::effects::Channel;
use crate::machine::Axis;
use crate::plant::driven::{DrivenStep, DrivenTable, Prescribed};
use crate::plant::mechanics::Stepper;
use crate::plant::motion::AxisMotion;
use crate::plant::parameters::{AxisParameters, ServoParameters};
use crate::plant::structure::{self, Tables};

/// How much longer the steps of a loop may be than those of a simulation: nanometres are asked for, not their hundredths.
const COARSER: f64 = 2.0;

/// A spring that needs more steps a tick is taken for a slip of the unit: its loop is not run.
const MOST_SUBSTEPS: u32 = 500;

/// Table and force stage of one log.
#[derive(Clone, Debug, Default)]
pub struct Driven {
    /// Linear scale, m.
    pub table_m: Vec<f64>,
    /// Force of the velocity tick that ends at the sample, N.
    pub force_n: Vec<f64>,
}

/// Drives the mechanics with the measured motor.
///
/// The measured motor is filtered, and what follows it linearly is so with it; friction, gaps and
/// wobbles do not, and pass the same filter afterwards.
///
#[must_use]
pub fn driven(
    parameters: &AxisParameters,
    motor: &Smooth,
    path: &MotorPath,
    sample_s: f64,
    last_tick: LastTick,
) -> Driven {
    let n = motor.position.len();
    let mut result = Driven { table_m: Vec::with_capacity(n), force_n: Vec::with_capacity(n) };
    let Some(first) = path.points.first() else { return result };
    // The error hangs on the place, and the reading is as far from that as the error.
    let truth = |reading: f64| reading - parameters.dividing_m(reading - parameters.dividing_m(reading));
    // Stretch of the spring per acceleration of the table.
    let give =
        parameters.spring.as_ref().map_or(0.0, |spring| parameters.table_mass_kg / spring.stiffness_n_per_m);

    let mut motor_m = truth(first.reading_m);
    let nominal_m = parameters.screw.nominal_m(motor_m);
    let mut screw = Prescribed {
        nominal_m,
        velocity: motor.velocity[0],
        acceleration: motor.acceleration[0],
        ..Prescribed::default()
    };
    let mut dividing = Change::new(motor_m - first.reading_m);
    let mut errors = Change::new(nominal_m - motor_m);
    let mut table = DrivenTable::settled(parameters, screw);
    let step = DrivenStep::new(parameters, path.step_s);
    let per_step = path.step_s.recip();
    let mut steps = path.points[1..].chunks_exact(path.steps);
    let mut point = first;
    for i in 0..n {
        for next in if i == 0 { &[][..] } else { steps.next().unwrap_or(&[]) } {
            point = next;
            motor_m = truth(point.reading_m);
            let nominal_m = parameters.screw.nominal_m(motor_m);
            let velocity = (nominal_m - screw.nominal_m) * per_step;
            dividing.go_on(motor_m - point.reading_m, per_step);
            errors.go_on(nominal_m - motor_m, per_step);
            screw = Prescribed {
                nominal_m,
                velocity,
                acceleration: point.acceleration + dividing.acceleration + errors.acceleration,
                of_errors: errors.rate,
            };
            table.step(&step, screw);
        }
        let table_m = table.position_m(parameters, screw);
        let force = parameters.motor_coulomb_n * path.sign[i] - parameters.ripple_n(motor_m)
            + table.transmitted_n
            + parameters.motor_mass_kg * dividing.acceleration
            - parameters.table_mass_kg * point.acceleration;
        result.table_m.push(table_m - point.reading_m + give * point.acceleration);
        result.force_n.push(force);
    }
    let mass = parameters.motor_mass_kg + parameters.table_mass_kg - last_tick.less_n_s2_per_m;
    // Over the tick that ends at the sample: half of one old, and as late as the log is.
    let age = 0.5 + parameters.late_s(Channel::Force) / sample_s;
    let (force_n, acceleration) = (aged(&result.force_n, age), aged(&motor.acceleration, age));
    let table_m =
        linear(&motor.filtered(&result.table_m), |i| motor.position[i] - give * motor.acceleration[i]);
    let mut force_n = linear(&motor.filtered(&force_n), |i| mass * acceleration[i]);
    last_tick.let_integral_go_on(&mut force_n, sample_s);
    Driven { table_m: delayed(table_m, parameters.late_s(Channel::Table), sample_s), force_n }
}

/// A quantity that changes from step to step, with its rates.
struct Change {
    value: f64,
    rate: f64,
    acceleration: f64,
}

impl Change {
    fn new(value: f64) -> Self {
        Self { value, rate: 0.0, acceleration: 0.0 }
    }

    fn go_on(&mut self, value: f64, per_step: f64) {
        let rate = (value - self.value) * per_step;
        self.acceleration = (rate - self.rate) * per_step;
        (self.value, self.rate) = (value, rate);
    }
}

/// Values as they were `age` samples ago (negative: as they will be), straight between samples; before the first and
/// behind the last they stand.
pub(super) fn aged(values: &[f64], age: f64) -> Vec<f64> {
    let n = values.len();
    let part = age - age.floor();
    #[expect(clippy::cast_possible_truncation, reason = "within the values")]
    let whole = age.floor().clamp(-(n as f64), n as f64) as isize;
    let mix = |newer: f64, older: f64| (1.0 - part) * newer + part * older;
    let at = |i: isize| values[i.clamp(0, n.cast_signed() - 1).cast_unsigned()];
    (0..n.cast_signed()).map(|i| mix(at(i - whole), at(i - whole - 1))).collect()
}

/// Values with a part added that follows the filtered motor linearly.
fn linear(values: &[f64], part: impl Fn(usize) -> f64) -> Vec<f64> {
    values.iter().enumerate().map(|(i, value)| value + part(i)).collect()
}

/// By what the force of the last velocity tick of a sample, which is the one that is logged, differs from the mean of
/// the sample's D ticks of T, which is the one that moved the axis.
///
/// The velocity command stands for them while the velocity grows by a·T each: the last tick's velocity error lies
/// a·T·(D − 1)/2 below the mean, and its force Kv times that. The integral part meanwhile goes on by its slope, the
/// proportional part over Ti, and is ahead of its mean by T·(D − 1)/2 of that. The proportional part is what the force
/// is without its low-pass of Ti.
#[derive(Clone, Copy, Debug, Default)]
pub struct LastTick {
    /// Less force per acceleration, N per m/s².
    pub less_n_s2_per_m: f64,
    /// Middle of the ticks to the last of them, s.
    ahead_s: f64,
    /// Ti, s; infinite without an integral part.
    integral_s: f64,
}

impl LastTick {
    /// Of an axis.
    #[must_use]
    pub fn new(axis: &Axis, rates: Rates) -> Self {
        let ticks = f64::from(rates.position_loop_divider) - 1.0;
        let ahead_s = 0.5 * ticks / rates.velocity_loop_hz;
        Self {
            less_n_s2_per_m: axis.velocity_gain_n_s_per_m.unwrap_or(0.0) * ahead_s,
            ahead_s,
            integral_s: axis.velocity_integral_time_s.unwrap_or(f64::INFINITY),
        }
    }

    fn let_integral_go_on(&self, force_n: &mut [f64], sample_s: f64) {
        let (share, takes) = (self.ahead_s / self.integral_s, -(-sample_s / self.integral_s).exp_m1());
        let mut of_integral_n = force_n.first().copied().unwrap_or(0.0);
        for force_n in force_n {
            of_integral_n += takes * (*force_n - of_integral_n);
            *force_n += share * (*force_n - of_integral_n);
        }
    }
}

/// Closes the loop in simulation on the measured command. Gives the motor reading, m, or `None` when
/// the settings are refused.
#[must_use]
pub fn closed_loop(
    parameters: &AxisParameters,
    settings: &AxisSettings,
    rates: Rates,
    command: &[f64],
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
    for &command in command {
        let reading = read(&motion);
        result.motor_m.push(reading.motor.to_m());
        result.table_m.push(reading.table.map_or(0.0, |table| table.to_m()));
        result.force_n.push(last_n);
        state.position_tick(&config, position(command), 0, reading);
        for tick in 0..rates.position_loop_divider {
            let reading = if tick == 0 { reading } else { read(&motion) };
            let (force, _) = state.velocity_tick(&config, reading, 0.0);
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
        let stands = command.len() > STANDS && command[..STANDS].iter().all(|place| *place == command[0]);
        let moves = |later: &[f64]| {
            let way = later.iter().sum::<f64>() / later.len() as f64 - first;
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

/// Tool point of one axis from the measured tables, m. `None` where the axis has no table channel.
///
/// A table that is logged late stands where it was: the tool goes on ahead of its reading.
#[must_use]
pub fn tool(
    parameters: &AxisParameters,
    axis: usize,
    names: &[String],
    signals: &Signals,
) -> Option<Vec<f64>> {
    let tables: Vec<Option<&Smooth>> = signals.axes.iter().map(AxisSignals::table_or_motor).collect();
    let own = tables.get(axis).copied().flatten()?;
    let mut places = match &parameters.tool.resonance {
        Some(resonance) => follow::swinging(own, resonance, signals.sample_s),
        None => own.position.clone(),
    };
    let mut positions = vec![0.0; names.len()];
    let mut accelerations = vec![0.0; names.len()];
    for (i, place) in places.iter_mut().enumerate() {
        for (other, table) in tables.iter().enumerate() {
            positions[other] = table.map_or(0.0, |table| table.position[i]);
            accelerations[other] = table.map_or(0.0, |table| table.acceleration[i]);
        }
        let all = Tables { names, position_m: &positions, acceleration: &accelerations };
        let time_s = signals.start_s + i as f64 * signals.sample_s;
        *place += structure::offset_m(&parameters.tool, axis, &all, time_s);
    }
    let of_table_s = signals.axes[axis].table.as_ref().map_or(0.0, |_| parameters.late_s(Channel::Table));
    Some(delayed(places, parameters.late_s(Channel::Tool) - of_table_s, signals.sample_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use crate::servo;

    /// A loop is simulated with the plant's own integrator; its motor then drives the table through the
    /// implicit one. Both must tell the same table and the same force.
    #[test]
    fn the_driven_table_is_that_of_the_free_plant() {
        let machine = Machine::parse(crate::demo::MACHINE, "demo.toml").unwrap();
        let axis = &machine.axis["x"];
        let parameters = AxisParameters::of(axis);
        let settings = servo::settings(axis, &parameters.servo).unwrap();
        let rates = servo::rates(&machine);
        // ±20 mm at 0.5 Hz: 63 mm/s, 0.2 m/s², three reversals.
        let command: Vec<f64> =
            (0..4000).map(|i| 0.02 * (1.0 - (std::f64::consts::PI * 1e-3 * f64::from(i)).cos())).collect();
        let start = Start { motor_m: command[0], velocity: 0.0, table_m: None, is_settled: true };
        let simulated = closed_loop(&parameters, &settings, rates, &command, start).unwrap();
        let motor = Smooth::new(simulated.motor_m.clone(), 1e-3, 5);
        let driven =
            driven(&parameters, &motor, &MotorPath::new(&motor, 1e-3), 1e-3, LastTick::new(axis, rates));
        let table = Smooth::new(simulated.table_m.clone(), 1e-3, 5);
        let off: Vec<f64> =
            table.position.iter().zip(&driven.table_m).skip(300).map(|(a, b)| 1e9 * (a - b)).collect();
        let rms = (off.iter().map(|d| d * d).sum::<f64>() / off.len() as f64).sqrt();
        // The stretch under 200 N is 1 µm: 10 nm of it is a hundredth, and half the scale's noise.
        assert!(rms < 10.0, "{rms} nm");
        assert!(off.iter().all(|d| d.abs() < 150.0), "{:?}", off.iter().fold(0.0f64, |a, b| a.max(b.abs())));
        // At the fastest point: friction of 180 + 30 N, 1000 N·s/m · 62.8 mm/s, no acceleration.
        let fastest = 2500;
        let velocity = motor.velocity[fastest];
        let expected = 210.0f64.copysign(velocity) + 1000.0 * velocity;
        assert!((driven.force_n[fastest] - expected).abs() < 3.0, "{} {expected}", driven.force_n[fastest]);
    }
}
