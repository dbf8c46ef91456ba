//! What the model gives for each stage, driven by the measured signal upstream of it.

use shared::axis::{AxisState, Reading};
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::units::Position;

use super::follow::{self, delayed};
use super::motor_path::MotorPath;
use super::signals::{AxisSignals, Signals, Smooth};
use crate::effects::Channel;
use crate::machine::Axis;
use crate::plant::driven::{DrivenStep, DrivenTable, Prescribed};
use crate::plant::mechanics::Stepper;
use crate::plant::motion::AxisMotion;
use crate::plant::parameters::AxisParameters;
use crate::plant::structure::{self, Tables};

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
/// `hold_n_s2_per_m` is what the logged force lacks per acceleration because the velocity command is
/// held while the velocity goes on: see [`hold`].
///
#[must_use]
pub fn driven(
    parameters: &AxisParameters,
    motor: &Smooth,
    path: &MotorPath,
    sample_s: f64,
    hold_n_s2_per_m: f64,
) -> Driven {
    let n = motor.position.len();
    let mut result = Driven { table_m: Vec::with_capacity(n), force_n: Vec::with_capacity(n) };
    let Some(first) = path.points.first() else { return result };
    let truth = |reading: f64| reading - parameters.dividing_m(reading);
    // Stretch of the spring per acceleration of the table.
    let give =
        parameters.spring.as_ref().map_or(0.0, |spring| parameters.table_mass_kg / spring.stiffness_n_per_m);

    let mut motor_m = truth(first.reading_m);
    let nominal_m = parameters.screw.nominal_m(motor_m);
    let mut screw =
        Prescribed { nominal_m, velocity: motor.velocity[0], acceleration: motor.acceleration[0] };
    let mut table = DrivenTable::settled(parameters, screw);
    let step = DrivenStep::new(parameters, path.step_s);
    let per_step = path.step_s.recip();
    let mut steps = path.points[1..].chunks_exact(path.steps);
    for i in 0..n {
        for point in if i == 0 { &[][..] } else { steps.next().unwrap_or(&[]) } {
            motor_m = truth(point.reading_m);
            let nominal_m = parameters.screw.nominal_m(motor_m);
            let velocity = (nominal_m - screw.nominal_m) * per_step;
            screw = Prescribed { nominal_m, velocity, acceleration: point.acceleration };
            table.step(&step, screw);
        }
        let table_m = table.position_m(parameters, screw);
        let force = parameters.motor_coulomb_n * path.sign[i] - parameters.ripple_n(motor_m)
            + table.transmitted_n
            - parameters.table_mass_kg * motor.acceleration[i];
        let held_back_m = path.held_back_m[i];
        result.table_m.push(table_m + held_back_m - motor.position[i] + give * motor.acceleration[i]);
        result.force_n.push(force);
    }
    let mass = parameters.motor_mass_kg + parameters.table_mass_kg - hold_n_s2_per_m;
    let acceleration = |i: usize| motor.acceleration[i];
    // Over the tick that ends at the sample: half of one old, and as late as the log is.
    let age = 0.5 + parameters.late_s(Channel::Force) / sample_s;
    let force_n: Vec<f64> = (0..n).map(|i| at_age(|i| result.force_n[i], n, i, age)).collect();
    let table_m = linear(&motor.filtered(&result.table_m), |i| motor.position[i] - give * acceleration(i));
    Driven {
        table_m: delayed(table_m, parameters.late_s(Channel::Table), sample_s),
        force_n: linear(&motor.filtered(&force_n), |i| mass * at_age(acceleration, n, i, age)),
    }
}

/// Of `n` values the one that was `age` samples ago at sample `i` (negative: is to come), straight between
/// samples; before the first and behind the last they stand.
pub(super) fn at_age(value: impl Fn(usize) -> f64, n: usize, i: usize, age: f64) -> f64 {
    let whole = age.floor();
    let part = age - whole;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within 0 and n")]
    let at = |age: f64| value((i as f64 - age).clamp(0.0, n as f64 - 1.0) as usize);
    (1.0 - part) * at(whole) + part * at(whole + 1.0)
}

/// Values with a part added that follows the filtered motor linearly.
fn linear(values: &[f64], part: impl Fn(usize) -> f64) -> Vec<f64> {
    values.iter().enumerate().map(|(i, value)| value + part(i)).collect()
}

/// Difference between the mean force of a sample's interval and the force of its last velocity tick,
/// which is the one that is logged, per acceleration (N per m/s²).
///
/// The velocity command stands for D ticks of T while the velocity grows by a·T each: the last tick's
/// velocity error lies a·T·(D − 1)/2 below the mean, and its force Kv times that.
#[must_use]
pub fn hold(axis: &Axis, rates: Rates) -> f64 {
    let ticks = f64::from(rates.position_loop_divider) - 1.0;
    axis.velocity_gain_n_s_per_m.unwrap_or(0.0) * 0.5 * ticks / rates.velocity_loop_hz
}

/// Closes the loop in simulation on the measured command. Gives the motor reading, m, or `None` when
/// the settings are refused.
#[must_use]
pub fn closed_loop(
    parameters: &AxisParameters,
    settings: &AxisSettings,
    rates: Rates,
    command: &[f64],
    start: Option<&Smooth>,
) -> Option<Loop> {
    let config = AxisConfig::<f64>::new(settings, rates).ok()?;
    let tick_s = 1.0 / rates.velocity_loop_hz;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, a handful")]
    let substeps = (tick_s / parameters.step_s()).ceil() as u32;
    if substeps > MOST_SUBSTEPS {
        return None;
    }
    let stepper = Stepper::new(parameters, 0.0, tick_s / f64::from(substeps));
    let position = |m: f64| Position::from_m(m).unwrap_or_default();

    let (&first, &second) = (command.first()?, command.get(1)?);
    let (motor, velocity) = start.map_or((first, 0.0), |motor| (motor.position[0], motor.velocity[0]));
    let mut motion = in_motion(parameters, motor - parameters.dividing_m(motor), velocity);
    let read = |motion: &AxisMotion| Reading {
        motor: position(motion.motor_m + parameters.dividing_m(motion.motor_m)),
        table: Some(position(motion.table_m)),
    };
    let before = |m: f64, velocity: f64| position(m - velocity * tick_s);
    let command_before = position(first - (second - first));
    let reading_before =
        Reading { motor: before(motor, velocity), table: Some(before(motion.table_m, velocity)) };
    let mut state = AxisState::<f64>::at_rest(command_before, reading_before);

    let mut result =
        Loop { motor_m: Vec::with_capacity(command.len()), table_m: Vec::with_capacity(command.len()) };
    for &command in command {
        let reading = read(&motion);
        result.motor_m.push(reading.motor.to_m());
        result.table_m.push(motion.table_m);
        state.position_tick(&config, position(command), 0, reading);
        for tick in 0..rates.position_loop_divider {
            let reading = if tick == 0 { reading } else { read(&motion) };
            let (force, _) = state.velocity_tick(&config, reading, 0.0);
            for _ in 0..substeps {
                stepper.step(parameters, &mut motion, force);
            }
        }
    }
    Some(result)
}

/// An axis that moves steadily with its motor at a place, m.
pub(super) fn in_motion(parameters: &AxisParameters, motor_m: f64, velocity: f64) -> AxisMotion {
    let screw = Prescribed { nominal_m: parameters.screw.nominal_m(motor_m), velocity, acceleration: 0.0 };
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

/// A simulated closed loop.
#[derive(Clone, Debug)]
pub struct Loop {
    /// Motor reading, m.
    pub motor_m: Vec<f64>,
    /// Table, m.
    pub table_m: Vec<f64>,
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
        let simulated = closed_loop(&parameters, &settings, rates, &command, None).unwrap();
        let motor = Smooth::new(simulated.motor_m.clone(), 1e-3, 5);
        let driven = driven(&parameters, &motor, &MotorPath::new(&motor, 1e-3), 1e-3, hold(axis, rates));
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
