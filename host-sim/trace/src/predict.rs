//! What the model gives for each stage, driven by the measured signal upstream of it.

use super::follow::{self, delayed};
use super::last_tick::LastTick;
use super::motor_path::MotorPath;
use super::signals::{AxisSignals, Signals, Smooth};
use model::effects::Channel;
use plant::driven::{DrivenStep, DrivenTable, Prescribed};
use plant::parameters::AxisParameters;
use plant::structure::{self, Tables};

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
/// wobbles do not, and pass the same filter afterwards. Of the force, `added_n` (as logged and filtered) is not the
/// controller's.
#[must_use]
pub fn driven(
    parameters: &AxisParameters,
    motor: &Smooth,
    path: &MotorPath,
    sample_s: f64,
    last_tick: LastTick,
    added_n: Option<&[f64]>,
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
    let mass = parameters.motor_mass_kg + parameters.table_mass_kg;
    // Over the tick that ends at the sample: half of one old, and as late as the log is.
    let late = parameters.late_s(Channel::Force) / sample_s;
    let age = 0.5 + late;
    let (force_n, acceleration) = (aged(&result.force_n, age), aged(&motor.acceleration, age));
    let table_m =
        linear(&motor.filtered(&result.table_m), |i| motor.position[i] - give * motor.acceleration[i]);
    let mut force_n = linear(&motor.filtered(&force_n), |i| mass * acceleration[i]);
    let growth = aged(&motor.acceleration, last_tick.growth_age + late);
    add(&mut force_n, added_n, -1.0);
    last_tick.of_means(&mut force_n, &growth, sample_s);
    add(&mut force_n, added_n, 1.0);
    Driven { table_m: delayed(table_m, parameters.late_s(Channel::Table), sample_s), force_n }
}

/// Adds a force, where there is one, times a sign.
fn add(force_n: &mut [f64], added_n: Option<&[f64]>, sign: f64) {
    for (force_n, added_n) in force_n.iter_mut().zip(added_n.unwrap_or_default()) {
        *force_n += sign * added_n;
    }
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
    use super::super::in_loop::{Start, closed_loop};
    use super::*;
    use model::effects::{Effect, PitchCyclic, ResolverDividing};
    use model::machine::Machine;
    use model::servo;

    /// A loop is simulated with the plant's own integrator; its motor then drives the table through the
    /// implicit one. Both must tell the same table and the same force.
    #[test]
    fn the_driven_table_is_that_of_the_free_plant() {
        driven_is_free(None);
    }

    /// Errors of screw and sensor have rates and accelerations of their own: 5 µm over 10 mm at 63 mm/s move the
    /// table's 150 kg by 8 mm/s², and a damper of 1.5e4 N·s/m by 3 N: 6 and 15 nm that must not be missed.
    #[test]
    fn so_it_is_with_errors_of_the_screw_and_of_the_sensor() {
        driven_is_free(Some(Effect::PitchCyclic(PitchCyclic {
            amplitude_um: 5.0,
            period_mm: 10.0,
            phase_rad: 0.3,
        })));
        driven_is_free(Some(Effect::ResolverDividing(ResolverDividing {
            amplitude_um: 3.0,
            period_mm: 5.0,
            phase_rad: 0.3,
        })));
    }

    fn driven_is_free(effect: Option<Effect>) {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let axis = &mut machine.axis["x"].clone();
        axis.effect.extend(effect);
        let parameters = AxisParameters::of(axis);
        let settings = servo::settings(axis, &parameters.servo).unwrap();
        let rates = servo::rates(&machine);
        // ±20 mm at 0.5 Hz: 63 mm/s, 0.2 m/s², three reversals.
        let command: Vec<f64> =
            (0..4000).map(|i| 0.02 * (1.0 - (std::f64::consts::PI * 1e-3 * f64::from(i)).cos())).collect();
        let start = Start { motor_m: command[0], velocity: 0.0, table_m: None, is_settled: true };
        let simulated = closed_loop(&parameters, &settings, rates, &command, &[], start).unwrap();
        let motor = Smooth::new(simulated.motor_m.clone(), 1e-3, 5);
        let driven = driven(
            &parameters,
            &motor,
            &MotorPath::new(&motor, 1e-3),
            1e-3,
            LastTick::new(axis, rates),
            None,
        );
        let table = Smooth::new(simulated.table_m.clone(), 1e-3, 5);
        let off: Vec<f64> =
            table.position.iter().zip(&driven.table_m).skip(300).map(|(a, b)| 1e9 * (a - b)).collect();
        let rms = numerics::rms(off.iter().copied());
        // The stretch under 200 N is 1 µm: 10 nm of it is a hundredth, and half the scale's noise.
        assert!(rms < 10.0, "{rms} nm");
        assert!(off.iter().all(|d| d.abs() < 150.0), "{:?}", numerics::max_abs(off));
        // At the fastest point: friction of 180 + 30 N, 1000 N·s/m · 62.8 mm/s, no acceleration.
        let fastest = 2500;
        let velocity = motor.velocity[fastest];
        let expected = 210.0f64.copysign(velocity) + 1000.0 * velocity;
        assert!((driven.force_n[fastest] - expected).abs() < 3.0, "{} {expected}", driven.force_n[fastest]);
    }
}
