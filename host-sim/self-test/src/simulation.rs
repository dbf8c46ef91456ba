//! Two axes with their drives, and the log of their sensors; see [`super::plant`].

use rand_chacha::ChaCha8Rng;

use super::plant::{LocalDefect, Mechanics, STEP_S, Sinusoid, State};
use super::sensors::{Sensors, rounded};
use super::servo::{SAMPLE_S, STEPS_PER_SAMPLE, STEPS_PER_VELOCITY_TICK, Servo, Settings};
use files::log::{AxisLog, Log, Unit};

/// Names of the axes.
pub const AXES: [&str; 2] = ["x", "y"];

/// Resolution of the command in the log, steps per mm.
const COMMAND_STEPS_PER_MM: f64 = 1e6;

/// Integration steps of the tool's mode per step of the plant.
const MODE_STEPS: u32 = 20;
const MODE_STEP_S: f64 = STEP_S / 20.0;

/// True values of one axis with all undeclared effects, SI units. An effect of value 0 is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Settings of the drive.
    pub servo: Settings,
    /// Masses, spring, friction, errors of the screw.
    pub mechanics: Mechanics,
    /// Noise and resolution of the log.
    pub sensors: Sensors,
    /// Resolution of the motor's sensor in the control loops, m; 0: none.
    pub encoder_step_m: f64,
    /// Error of the motor's sensor over the motor's position, m over m.
    pub resolver: Sinusoid,
    /// Tool − table per own acceleration, s².
    pub intalk_s2: f64,
    /// Tool − table per the other axis's acceleration, s².
    pub crosstalk_s2: f64,
    /// Tool − table per the other axis's position.
    pub squareness: f64,
    /// Tool − table per the other axis's position squared, 1/m.
    pub straightness_per_m: f64,
    /// Final value of the drift of tool − table, m.
    pub drift_m: f64,
    /// Time constant of the drift, s; above 0 unless the drift is 0.
    pub drift_s: f64,
    /// Delay of the table in the log, s.
    pub table_delay_s: f64,
    /// Delay of the tool in the log, s.
    pub tool_delay_s: f64,
    /// ω (1/s) and ζ of the mode between table and tool; none: rigid.
    pub resonance: Option<[f64; 2]>,
    /// Vibration of the tool over time, m over s.
    pub vibration: Sinusoid,
    /// Local error of the tool over the table's position.
    pub tool_defect: LocalDefect,
}

impl Axis {
    /// Reading of the motor's sensor before it is resolved into steps.
    fn continuous_reading_m(&self, motor_m: f64) -> f64 {
        motor_m + self.resolver.at(motor_m)
    }

    /// Reading of the motor's sensor in the control loops.
    fn reading_m(&self, motor_m: f64) -> f64 {
        let reading_m = self.continuous_reading_m(motor_m);
        if self.encoder_step_m == 0.0 {
            reading_m
        } else {
            (reading_m / self.encoder_step_m).round() * self.encoder_step_m
        }
    }
}

/// An axis with its state.
struct RunningAxis<'a> {
    axis: &'a Axis,
    state: State,
    servo: Servo,
    mode_m: f64,
    mode_m_per_s: f64,
    table: DelayLine,
    tool: DelayLine,
}

impl<'a> RunningAxis<'a> {
    fn new(axis: &'a Axis, at_m: f64, time_s: f64) -> Self {
        Self {
            axis,
            state: State { time_s, ..State::resting(at_m) },
            servo: Servo::new(axis.servo.clone(), at_m, axis.reading_m(at_m)),
            mode_m: at_m,
            mode_m_per_s: 0.0,
            table: DelayLine::new(axis.table_delay_s, at_m),
            tool: DelayLine::new(axis.tool_delay_s, at_m),
        }
    }

    fn reading_m(&self) -> f64 {
        self.axis.reading_m(self.state.motor_m)
    }

    /// Steps the mode between table and tool. `table_m` is the position of the table before the step: with the position
    /// after it, the tool would be one step early.
    fn step_mode(&mut self, table_m: f64) {
        match self.axis.resonance {
            None => self.mode_m = self.state.table_m,
            Some([omega, zeta]) => {
                // A step h of the plant would shift the frequency by ζωh/2, more than its confidence interval.
                for _ in 0..MODE_STEPS {
                    let acceleration =
                        omega * omega * (table_m - self.mode_m) - 2.0 * zeta * omega * self.mode_m_per_s;
                    self.mode_m_per_s += MODE_STEP_S * acceleration;
                    self.mode_m += MODE_STEP_S * self.mode_m_per_s;
                }
            }
        }
    }

    /// Position of the tool with the effects of the other axis and of time.
    fn tool_m(&self, other: &State, time_s: f64) -> f64 {
        let axis = self.axis;
        let drift_m =
            if axis.drift_m == 0.0 { 0.0 } else { axis.drift_m * -(-time_s / axis.drift_s).exp_m1() };
        self.mode_m
            + axis.intalk_s2 * self.state.table_m_per_s2
            + axis.crosstalk_s2 * other.table_m_per_s2
            + axis.squareness * other.table_m
            + axis.straightness_per_m * other.table_m * other.table_m
            + drift_m
            + axis.vibration.at(time_s)
            + axis.tool_defect.at(self.state.table_m)
    }
}

/// A signal delayed by a fixed time, interpolated linearly between the steps.
struct DelayLine {
    /// The last values as a ring, the newest at `newest`.
    past: Vec<f64>,
    newest: usize,
    whole_steps: usize,
    fraction: f64,
}

impl DelayLine {
    fn new(delay_s: f64, start: f64) -> Self {
        let steps = delay_s / STEP_S;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ms, not negative")]
        let whole_steps = steps.floor() as usize;
        Self { past: vec![start; whole_steps + 2], newest: 0, whole_steps, fraction: steps.fract() }
    }

    fn push(&mut self, value: f64) {
        self.newest = (self.newest + 1) % self.past.len();
        self.past[self.newest] = value;
    }

    fn value(&self) -> f64 {
        let length = self.past.len();
        let back = |steps: usize| self.past[(self.newest + length - steps) % length];
        (1.0 - self.fraction) * back(self.whole_steps) + self.fraction * back(self.whole_steps + 1)
    }
}

/// Runs both axes along commanded positions (mm, one per sample) and logs them.
#[must_use]
pub fn run(axes: &[Axis; 2], positions: &[[f64; 2]], start_s: f64, random: &mut ChaCha8Rng) -> Log {
    let first = positions.first().copied().unwrap_or_default();
    let mut running = [0, 1].map(|i| RunningAxis::new(&axes[i], 1e-3 * first[i], start_s));
    // The delay lines of the tools start with the positions of the tools at rest.
    for i in [0, 1] {
        let tool_m = running[i].tool_m(&running[1 - i].state, start_s);
        running[i].tool = DelayLine::new(axes[i].tool_delay_s, tool_m);
    }
    let mut columns = AXES.map(|_| Columns::default());
    for (sample, position) in positions.iter().enumerate() {
        let time_s = start_s + SAMPLE_S * sample as f64;
        for (i, axis) in running.iter_mut().enumerate() {
            columns[i].add(axis, position[i], random);
            axis.servo.position_tick(1e-3 * position[i], axis.reading_m(), axis.state.table_m);
        }
        for step in 0..STEPS_PER_SAMPLE {
            for axis in &mut running {
                if step % STEPS_PER_VELOCITY_TICK == 0 {
                    axis.servo.velocity_tick(axis.reading_m());
                }
                let force_n = axis.servo.acting_n();
                let table_m = axis.state.table_m;
                axis.axis.mechanics.step(&mut axis.state, force_n);
                axis.step_mode(table_m);
            }
            let now_s = time_s + STEP_S * f64::from(step + 1);
            let tools = [0, 1].map(|i| running[i].tool_m(&running[1 - i].state, now_s));
            for (axis, tool_m) in running.iter_mut().zip(tools) {
                axis.table.push(axis.state.table_m);
                axis.tool.push(tool_m);
            }
        }
    }
    let axes = AXES.iter().zip(columns).map(|(name, columns)| columns.into_log(name)).collect();
    Log { source: String::new(), start_s, sample_time_s: SAMPLE_S, axes }
}

#[derive(Default)]
struct Columns {
    command: Vec<f64>,
    motor: Vec<f64>,
    table: Vec<f64>,
    tool: Vec<f64>,
    force: Vec<f64>,
}

impl Columns {
    fn add(&mut self, axis: &RunningAxis<'_>, command_mm: f64, random: &mut ChaCha8Rng) {
        let Sensors { motor, table, tool, force } = axis.axis.sensors;
        let motor_mm = 1e3 * axis.axis.continuous_reading_m(axis.state.motor_m);
        self.command.push(rounded(command_mm, COMMAND_STEPS_PER_MM));
        self.motor.push(motor.read(motor_mm, random));
        self.table.push(table.read(1e3 * axis.table.value(), random));
        self.tool.push(tool.read(1e3 * axis.tool.value(), random));
        self.force.push(force.read(axis.servo.force_n(), random));
    }

    fn into_log(self, name: &str) -> AxisLog {
        let Self { command, motor, table, tool, force } = self;
        AxisLog {
            command: Some(command),
            motor: Some(motor),
            table: Some(table),
            tool: Some(tool),
            force: Some(force),
            ..AxisLog::new(name, Unit::Millimetre)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delayed_signal_has_its_earlier_value() {
        // A ramp of 1 per step, delayed by 2.4 steps.
        let mut delayed = DelayLine::new(2.4 * STEP_S, 0.0);
        (1..=10).for_each(|i| delayed.push(f64::from(i)));
        assert!((delayed.value() - 7.6).abs() < 1e-9, "{}", delayed.value());
        let mut undelayed = DelayLine::new(0.0, 0.0);
        undelayed.push(3.0);
        assert_eq!(undelayed.value().to_bits(), 3.0_f64.to_bits());
    }
}
