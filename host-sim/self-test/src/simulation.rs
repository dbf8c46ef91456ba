//! A session of the second simulator: its controller moves its machine, and the sensors are logged; see [`super::plant`].

use rand_chacha::ChaCha8Rng;

use super::machine::{AXES, Axis, TwoAxes};
use super::recording::jittered;
use super::sensors::{Sensors, rounded};
use super::servo::{SAMPLE_S, STEPS_PER_SAMPLE, STEPS_PER_VELOCITY_TICK, Servo};
use files::log::{AxisLog, Log, Unit};

/// Resolution of the command in the log, steps per mm.
const COMMAND_STEPS_PER_MM: f64 = 1e6;

/// Runs both axes along commanded positions (mm, one per sample) and logs them.
#[must_use]
pub fn run(axes: &[Axis; 2], positions: &[[f64; 2]], start_s: f64, random: &mut ChaCha8Rng) -> Log {
    run_jittered(axes, positions, [start_s, 0.0], random)
}

/// Runs both axes as [`run`], with channels that are read at instants that scatter by a standard deviation around those of the samples. Both times are
/// in s, that of the start on the clock of the session.
#[must_use]
pub fn run_jittered(
    axes: &[Axis; 2],
    positions: &[[f64; 2]],
    [start_s, jitter_s]: [f64; 2],
    random: &mut ChaCha8Rng,
) -> Log {
    let first_m = positions.first().copied().unwrap_or_default().map(|mm| 1e-3 * mm);
    let mut machine = TwoAxes::new(axes, first_m, start_s);
    let readings_m = machine.readings_m();
    let mut servos = [0, 1].map(|i| Servo::new(axes[i].servo.clone(), first_m[i], readings_m[i]));
    let mut columns = AXES.map(|_| Columns::default());
    let mut before = measured(&machine, axes);
    for (sample, position_mm) in positions.iter().enumerate() {
        let readings = jittered(measured(&machine, axes), before, jitter_s, random);
        for (i, columns) in columns.iter_mut().enumerate() {
            let Axis { recording, sensors, .. } = &axes[i];
            let command_mm = recording.command_mm(positions, sample, i);
            let [motor_mm, table_mm, tool_mm] = readings[i];
            let force_n = (1.0 + recording.force_gain) * servos[i].force_n();
            columns.add(*sensors, [command_mm, motor_mm, table_mm, tool_mm, force_n], random);
            if let Some(warming) = axes[i].mechanics.warming {
                let time_s = start_s + SAMPLE_S * sample as f64;
                columns.temperature.push(warming.read_c(time_s, random));
            }
        }
        for ((servo, [motor_m, table_m]), command_mm) in
            servos.iter_mut().zip(machine.feedback_m()).zip(position_mm)
        {
            servo.position_tick(1e-3 * command_mm, motor_m, table_m);
        }
        for step in 0..STEPS_PER_SAMPLE {
            if step % STEPS_PER_VELOCITY_TICK == 0 {
                let readings_m = machine.readings_m().into_iter().zip(machine.earlier_readings_m());
                for (servo, (reading_m, earlier_m)) in servos.iter_mut().zip(readings_m) {
                    servo.velocity_tick(reading_m, earlier_m);
                }
            }
            if step + 1 == STEPS_PER_SAMPLE {
                before = measured(&machine, axes);
            }
            machine.step(servos.each_ref().map(Servo::force_n));
        }
    }
    let axes = AXES.iter().zip(columns).map(|(name, columns)| columns.into_log(name));
    Log::new("", start_s, SAMPLE_S, axes)
}

/// What the sensors of motor, table and tool read without noise, mm.
fn measured(machine: &TwoAxes<'_>, axes: &[Axis; 2]) -> [[f64; 3]; 2] {
    let motors_m = machine.continuous_readings_m();
    let (tables_m, tools_m) = (machine.logged_tables_m(), machine.logged_tools_m());
    [0, 1].map(|i| {
        let tool_m = axes[i].recording.probed_m(tools_m[i], tools_m[1 - i]);
        [1e3 * motors_m[i], 1e3 * tables_m[i], 1e3 * tool_m]
    })
}

#[derive(Default)]
struct Columns {
    command: Vec<f64>,
    motor: Vec<f64>,
    table: Vec<f64>,
    tool: Vec<f64>,
    force: Vec<f64>,
    /// Empty where it is not measured.
    temperature: Vec<f64>,
}

impl Columns {
    fn add(&mut self, sensors: Sensors, row: [f64; 5], random: &mut ChaCha8Rng) {
        let Sensors { motor, table, tool, force } = sensors;
        let [command_mm, motor_mm, table_mm, tool_mm, force_n] = row;
        self.command.push(rounded(command_mm, COMMAND_STEPS_PER_MM));
        self.motor.push(motor.read(motor_mm, random));
        self.table.push(table.read(table_mm, random));
        self.tool.push(tool.read(tool_mm, random));
        self.force.push(force.read(force_n, random));
    }

    fn into_log(self, name: &str) -> AxisLog {
        let Self { command, motor, table, tool, force, temperature } = self;
        AxisLog {
            command: Some(command),
            motor: Some(motor),
            table: Some(table),
            tool: Some(tool),
            force: Some(force),
            temperature: (!temperature.is_empty()).then_some(temperature),
            ..AxisLog::new(name, Unit::Millimetre)
        }
    }
}
