//! The motor stage: the model simulated in closed loop with the logged command.

use shared::axis::{AxisState, Reading};
use shared::compensate::Correction;
use shared::config::{AxisConfig, AxisSettings, Rates};
use shared::control::hpc::Hpc;
use shared::units::Position;

use super::controller_readings::ControllerReadings;
use super::initial_state::{InitialState, steady_motion};
use model::servo::ServoParameters;
use numerics::resample::delayed_cubic;
use plant::axis_motion::AxisMotion;
use plant::delay::ForcePath;
use plant::mechanics::Stepper;
use plant::parameters::AxisParameters;
use plant::tool_point::Modes;

/// Ratio of the steps to those of the simulator. Longer steps suffice, as an accuracy of nanometres is sufficient.
const STEP_FACTOR: f64 = 2.0;

/// Largest number of steps per tick. A stiffness that requires more is regarded as a wrong unit, and its loop is not
/// simulated.
const MAX_SUBSTEPS: u32 = 500;

/// Signals of a simulated closed loop at the samples.
#[derive(Clone, Debug, Default)]
pub struct ClosedLoopRun {
    /// Motor encoder, m.
    pub motor_m: Vec<f64>,
    /// Linear scale without its zero, m.
    pub table_m: Vec<f64>,
    /// Force of the last velocity tick, N.
    pub force_n: Vec<f64>,
    /// The table, and the tool that it carries.
    pub table: Vec<TableMotion>,
}

/// A table and the modes of its tool at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct TableMotion {
    /// Position, m.
    pub position_m: f64,
    /// Acceleration, m/s².
    pub m_per_s2: f64,
    /// Tool − table by the modes of the tool, m; 0 without one.
    pub oscillation_m: f64,
}

impl TableMotion {
    fn of(motion: &AxisMotion, modes: &Modes, parameters: &AxisParameters) -> Self {
        Self {
            position_m: motion.table_m,
            m_per_s2: motion.table_m_per_s2(parameters),
            oscillation_m: modes.offset_m(),
        }
    }

    /// A fraction of the way to a later instant.
    fn towards(self, later: Self, fraction: f64) -> Self {
        let between = |from: f64, to: f64| from + fraction * (to - from);
        Self {
            position_m: between(self.position_m, later.position_m),
            m_per_s2: between(self.m_per_s2, later.m_per_s2),
            oscillation_m: between(self.oscillation_m, later.oscillation_m),
        }
    }
}

/// The controller of a closed loop.
#[derive(Clone, Copy, Debug)]
pub struct Controlled<'a> {
    /// Settings of the axis.
    pub settings: &'a AxisSettings,
    /// Rates of the loops.
    pub rates: Rates,
}

/// Simulates the closed loop with the command, m, and with a force (N) that is added to the controller's force from each
/// sample to the next; beyond the end of `added_n` the added force is zero. `None` if the settings are invalid or the
/// simulation would take too many steps.
#[must_use]
pub fn closed_loop(
    parameters: &AxisParameters,
    controlled: Controlled<'_>,
    command: &[f64],
    added_n: &[f64],
    start: InitialState,
) -> Option<ClosedLoopRun> {
    let rates = controlled.rates;
    let ServoParameters { drive_late_s, filter_step_s, .. } = parameters.servo;
    let config = configured(controlled, filter_step_s)?;
    let tick_s = 1.0 / rates.velocity_loop_hz;
    let substeps = substeps(parameters, tick_s)?;
    let step_s = tick_s / f64::from(substeps);
    let stepper =
        Stepper::new(parameters, parameters.servo.drive_time_constant_s(drive_late_s.max(0.0)), step_s);
    let mut modes = Modes::at_rest(&parameters.tool.resonances, step_s);
    let position = |m: f64| Position::from_m(m).unwrap_or_default();

    // The output of the position loop is late if both of its inputs are: the readings are delayed by [`ControllerReadings`].
    let sample_s = f64::from(rates.position_loop_divider) * tick_s;
    let command = delayed_cubic(command.to_vec(), parameters.servo.loop_delay.seconds(), sample_s);
    let (&first, &second) = (command.first()?, command.get(1)?);
    let InitialState { motor_m: motor, velocity, table_m, is_settled, table_zero_m, time_s } = start;
    let true_motor_m = motor - parameters.resolver_error_m(motor);
    let mut motion = steady_motion(parameters, true_motor_m, velocity, time_s);
    motion.table_m = table_m.unwrap_or(motion.table_m);
    // A force that acts early, relative to the reading of the sensors, is equivalent to a later reading.
    let early_s = (-drive_late_s).max(0.0);
    let read = |motion: &AxisMotion, sample: usize| {
        let now_s = time_s + sample as f64 * sample_s;
        reading_after(motion, early_s, parameters, (table_zero_m, now_s))
    };
    let before = |m: f64, velocity: f64| position(m - velocity * tick_s);
    let command_before = position(first - (second - first));
    let known_table_m = if is_settled { motion.table_m + table_zero_m } else { motor };
    let reading_before =
        Reading { motor: before(motor, velocity), table: Some(before(known_table_m, velocity)) };
    let mut state = AxisState::<f64>::at_rest(command_before, reading_before).moving(velocity);
    let mut readings = ControllerReadings::new(&parameters.servo, tick_s, read(&motion, 0), &motion);
    let mut force_path = ForcePath::new(&parameters.servo, tick_s, motion.drive_n);

    let (mut result, mut last_n) = (ClosedLoopRun::default(), 0.0);
    for (i, &command) in command.iter().enumerate() {
        let added_n = added_n.get(i).copied().unwrap_or(0.0);
        let reading = read(&motion, i);
        result.motor_m.push(reading.motor.to_m());
        result.table_m.push(reading.table.map_or(0.0, Position::to_m) - table_zero_m);
        result.force_n.push(last_n);
        let table = TableMotion::of(&motion, &modes, parameters);
        for tick in 0..rates.position_loop_divider {
            let reading = if tick == 0 { reading } else { read(&motion, i) };
            let [for_position, for_velocity] = readings.at_tick(reading, &motion);
            if tick == 0 {
                state.position_tick(&config, position(command), Correction::NONE, for_position);
            }
            let (force, _) = state.velocity_tick(&config, for_velocity, added_n);
            let [output_n, delayed_n] = force_path.output_and_acting_n(force);
            last_n = output_n;
            let acting_n = parameters.drive_asymmetry.acting_n(delayed_n);
            for step in 0..substeps {
                let before = motion.table_m_per_s;
                stepper.step(parameters, &mut motion, acting_n);
                modes.step((motion.table_m_per_s - before) / step_s, motion.table_m_per_s);
                if (tick, step) == (0, 0) {
                    // The sensors are read after the force has begun to act, if it acts early.
                    let stepped = TableMotion::of(&motion, &modes, parameters);
                    result.table.push(table.towards(stepped, early_s / step_s));
                }
            }
        }
    }
    Some(result)
}

/// Number of steps of a tick (s); `None` if they are too many.
fn substeps(parameters: &AxisParameters, tick_s: f64) -> Option<u32> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1, a handful")]
    let substeps = (tick_s / (STEP_FACTOR * parameters.max_step_s())).ceil() as u32;
    (substeps <= MAX_SUBSTEPS).then_some(substeps)
}

/// The configuration of a controller whose high-order filter has steps of a length (s); `None` if its settings are invalid.
fn configured(Controlled { settings, rates }: Controlled<'_>, filter_step_s: f64) -> Option<AxisConfig<f64>> {
    let mut config = AxisConfig::<f64>::new(settings, rates).ok()?;
    if let Some(hpc) = &mut config.position.hpc {
        let gain = settings.position_gain_per_s;
        let sample_s = f64::from(rates.position_loop_divider) / rates.velocity_loop_hz;
        *hpc = Hpc::stepped(gain * sample_s, gain * filter_step_s);
    }
    Some(config)
}

/// The readings of the sensors some time after a motion was as given. The scale has its zero at a position (m); the time is that of
/// the session (s).
fn reading_after(
    motion: &AxisMotion,
    seconds: f64,
    parameters: &AxisParameters,
    (table_zero_m, time_s): (f64, f64),
) -> Reading {
    let position = |m: f64| Position::from_m(m).unwrap_or_default();
    let motor_m = motion.motor_m + seconds * motion.motor_m_per_s;
    let table_m = motion.table_m + seconds * motion.table_m_per_s;
    Reading {
        motor: position(motor_m + parameters.resolver_error_m(motor_m)),
        table: Some(position(table_m + parameters.scale.error_m(table_m, time_s) + table_zero_m)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::smoothing::Smooth;
    use crate::prediction::resonant_response::resonant_response;
    use model::effects::Resonance;
    use model::machine::Machine;
    use model::servo;

    /// A closed loop of axis x of the demo machine from rest at 0, with changed parameters and settings.
    fn demo_loop(
        change: impl FnOnce(&mut AxisParameters, &mut AxisSettings),
        command: &[f64],
        added_n: &[f64],
    ) -> ClosedLoopRun {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let mut parameters = AxisParameters::of(&machine.axis["x"]);
        let mut settings = servo::settings(&machine.axis["x"].settings, &parameters.servo).unwrap();
        change(&mut parameters, &mut settings);
        let start = InitialState {
            motor_m: 0.0,
            velocity: 0.0,
            table_m: None,
            is_settled: true,
            table_zero_m: 0.0,
            time_s: 0.0,
        };
        let controlled = Controlled { settings: &settings, rates: machine.rates() };
        closed_loop(&parameters, controlled, command, added_n, start).unwrap()
    }

    /// Change of the motor's position by changed parameters, µm, in steady motion at 100 mm/s and, from 2 s on, under a constant
    /// acceleration of 0.5 m/s²: at the end of each.
    fn change_um(change: impl FnOnce(&mut AxisParameters)) -> [f64; 2] {
        let position_m = |i: u32| {
            let t = 1e-3 * f64::from(i);
            0.1 * t + 0.25 * (t - 2.0).max(0.0).powi(2)
        };
        let command: Vec<f64> = (0..3000).map(position_m).collect();
        let [plain, changed] =
            [demo_loop(|_, _| {}, &command, &[]), demo_loop(|p, _| change(p), &command, &[])];
        [1990, 2990].map(|i| 1e6 * (changed.motor_m[i] - plain.motor_m[i]))
    }

    /// Kp and Kf of axis x of the demo machine, 1/s and as a fraction.
    fn demo_gains() -> [f64; 2] {
        let machine = Machine::parse(model::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let controller = &machine.axis["x"].settings.controller;
        [controller.position_gain_per_s.unwrap(), 0.01 * controller.feedforward_percent.unwrap()]
    }

    /// A position that is d old hides v·d of the motion, by which the motor leads; under the acceleration a, v = 595 mm/s at the end.
    /// The loop settles with Kp = 40 1/s or more: e^(−40) of the change is left after 1 s.
    #[test]
    fn a_late_position_lets_the_motor_lead_by_its_way() {
        let [steady, accelerating] = change_um(|parameters| parameters.servo.position_delay.ms = 2.0);
        assert!((steady / 200.0 - 1.0).abs() < 1e-3, "{steady}");
        // The motor is slower than its command by a·(1 − Kf)/Kp, and the loop follows the growing lead v·d with the lag a·d/Kp; a·d²,
        // 2 µm, is neglected.
        let [kp, kf] = demo_gains();
        let expected = (595.0 - 500.0 * (1.0 - kf) / kp) * 2.0 - 500.0 * 2.0 / kp;
        assert!((accelerating / expected - 1.0).abs() < 3e-3, "{accelerating} {expected}");
    }

    /// A velocity command that is d old is low by a·d, a velocity behind a filter low by a·τ: displacements of −a·d/Kp and +a·τ/Kp.
    #[test]
    fn a_late_velocity_command_and_a_filtered_velocity_displace_under_acceleration() {
        let [steady, accelerating] = change_um(|parameters| parameters.servo.loop_delay.ms = 1.0);
        let expected = 500.0 / demo_gains()[0];
        assert!(
            steady.abs() < 0.05 && (accelerating / -expected - 1.0).abs() < 0.05,
            "{steady} {accelerating}"
        );
        let [steady, accelerating] =
            change_um(|parameters| parameters.servo.velocity_filter.time_constant_ms = 0.6);
        // y += (1 − e^(−T/τ))·(x − y) is T·e^(−T/τ)/(1 − e^(−T/τ)) old, 0.483 ms with T = 0.25 ms.
        let left = (-0.25f64 / 0.6).exp();
        let expected = 0.25 * left / (1.0 - left) * expected;
        assert!(
            steady.abs() < 0.05 && (accelerating / expected - 1.0).abs() < 0.02,
            "{steady} {accelerating}"
        );
    }

    /// Largest magnitude of the force in half a second at rest with an added force from the first sample on.
    fn greatest_n(limit_n: f64, added_n: f64) -> f64 {
        let pushed = demo_loop(|_, settings| settings.force_limit_n = limit_n, &[0.0; 500], &[added_n; 500]);
        numerics::max_abs(pushed.force_n)
    }

    /// The tool follows the table by the mode, of 70 Hz, when the force acts 50 µs early, too, and both are read with the scale. The offset
    /// of the tool moves with up to 2 mm·(2π·7 Hz)·|H − 1|, |H − 1| = 0.021 at 7 Hz: 1.8 mm/s, and faster after a reversal of the friction; a table of
    /// 50 µs before would be off by the rms of this speed times 50 µs, at least 65 nm.
    #[test]
    fn the_tool_belongs_to_the_table_at_the_instant_of_the_reading() {
        let resonance = Resonance::of_tool(70.0, 0.09);
        let command: Vec<f64> =
            (0..2000).map(|i| 2e-3 * (1.0 - (std::f64::consts::TAU * 7e-3 * f64::from(i)).cos())).collect();
        let run = demo_loop(
            |parameters, _| {
                parameters.tool.resonances = vec![resonance.clone()];
                parameters.servo.drive_late_s = -50e-6;
            },
            &command,
            &[],
        );
        // Deviation of the tool from the response of the mode to a table, nm rms, after the start.
        let deviation_nm = |table_m: &[f64]| {
            let mode = model::effects::EffectModel::mode(&resonance).unwrap();
            let response = resonant_response(&Smooth::new(table_m.to_vec(), 1e-3, 2), mode, 1e-3);
            let tool = table_m.iter().zip(&run.table).map(|(table_m, table)| table_m + table.oscillation_m);
            1e9 * numerics::rms(tool.zip(response).skip(500).map(|(tool, response)| tool - response))
        };
        // The interpolation between the samples leaves 18 nm, mostly after the reversals.
        let of_tool: Vec<f64> = run.table.iter().map(|table| table.position_m).collect();
        let earlier = delayed_cubic(run.table_m.clone(), 50e-6, 1e-3);
        let [of_scale, of_tool, earlier] = [&run.table_m, &of_tool, &earlier].map(|m| deviation_nm(m));
        assert!(of_scale < 25.0 && of_tool < 25.0, "{of_scale} {of_tool}");
        let rates = run.table.windows(3).skip(500).map(|w| (w[2].oscillation_m - w[0].oscillation_m) / 2e-3);
        let expected = 1e9 * 50e-6 * numerics::rms(rates);
        assert!(expected > 65.0 && (earlier - expected).abs() < 25.0, "{earlier} {expected}");
    }

    #[test]
    fn the_force_limit_applies_to_the_sum_with_an_added_force() {
        assert!((greatest_n(300.0, 1000.0) - 300.0).abs() < 1e-9);
        // The motor's 90 kg with Kv = 6e4 N·s/m have a time constant of 1.5 ms. In the last of the four ticks of the first
        // sample, 0.75 ms after the first, the controller has reduced 1000 N at most by the factor e^(−0.5). As its velocity
        // is delayed by half a tick and one tick, and friction and spring also reduce the motion, the factor is at most
        // e^(−0.25).
        let free = greatest_n(20_000.0, 1000.0);
        assert!((606.0..779.0).contains(&free), "{free}");
    }
}
