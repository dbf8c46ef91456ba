//! Two axes in their loops, and what the instruments beside them write down; see [`super::plant`].

use numerics::noise::box_muller;
use rand_chacha::ChaCha8Rng;

use super::plant::{Bump, Mechanics, STEP_S, State, Wave};
use super::servo::{SAMPLE_S, STEPS_A_SAMPLE, STEPS_A_VELOCITY_TICK, Servo, Settings};
use files::log::{AxisLog, Log, Unit};

/// Names of the axes.
pub const AXES: [&str; 2] = ["x", "y"];

/// Standard deviations of the instruments, mm and N, as they are in the blind cases while those stand still.
const NOISE: Noise = Noise { motor_mm: 10e-6, table_mm: 20e-6, tool_mm: 80e-6, force_n: 2.0 };
/// Steps of the log, 1/mm and 1/N.
const POSITION_STEPS_A_MM: f64 = 1e5;
const COMMAND_STEPS_A_MM: f64 = 1e6;
const FORCE_STEPS_A_N: f64 = 10.0;

/// Steps that a mode of the tool takes in one of the plant's.
const MODE_STEPS: u32 = 20;
const MODE_STEP_S: f64 = STEP_S / 20.0;

struct Noise {
    motor_mm: f64,
    table_mm: f64,
    tool_mm: f64,
    force_n: f64,
}

/// One axis as it is, with all that its declaration lacks, SI. What is 0 is not there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Drive.
    pub servo: Settings,
    /// Masses, spring, friction.
    pub mechanics: Mechanics,
    /// Error of the motor's reading over its position, m over m.
    pub resolver: Wave,
    /// Tool − table per own acceleration, s².
    pub intalk_s2: f64,
    /// Tool − table per the other axis's acceleration, s².
    pub crosstalk_s2: f64,
    /// Tool − table per the other axis's position.
    pub squareness: f64,
    /// Tool − table per the other axis's position squared, 1/m.
    pub straightness_per_m: f64,
    /// Tool − table in the end, m.
    pub drift_m: f64,
    /// Over 0 where there is a drift.
    pub drift_s: f64,
    /// Of the table in the log.
    pub table_late_s: f64,
    /// Of the tool in the log.
    pub tool_late_s: f64,
    /// ω (1/s) and ζ with which the tool follows the table; none: rigidly.
    pub resonance: Option<[f64; 2]>,
    /// Of the tool over time, m over s.
    pub vibration: Wave,
    /// Of the tool over the table's position.
    pub tool_bump: Bump,
}

/// An axis that moves.
struct Moving<'a> {
    axis: &'a Axis,
    state: State,
    servo: Servo,
    swing_m: f64,
    swing_m_per_s: f64,
    table: Late,
    tool: Late,
}

impl<'a> Moving<'a> {
    fn new(axis: &'a Axis, at_m: f64) -> Self {
        Self {
            axis,
            state: State::resting(at_m),
            servo: Servo::new(axis.servo.clone(), at_m, at_m + axis.resolver.at(at_m)),
            swing_m: at_m,
            swing_m_per_s: 0.0,
            table: Late::new(axis.table_late_s, at_m),
            tool: Late::new(axis.tool_late_s, at_m),
        }
    }

    fn reading_m(&self) -> f64 {
        self.state.motor_m + self.axis.resolver.at(self.state.motor_m)
    }

    /// The tool as it follows its own table over a step: pulled to where that stands before the step, which keeps the
    /// scheme centred; pulled to where it stands after it, the tool would be one step early.
    fn follow(&mut self, table_m: f64) {
        match self.axis.resonance {
            None => self.swing_m = self.state.table_m,
            Some([omega, zeta]) => {
                // A step of the plant's would shift the frequency by ζωh/2, more than the trace is uncertain of it.
                for _ in 0..MODE_STEPS {
                    let pull =
                        omega * omega * (table_m - self.swing_m) - 2.0 * zeta * omega * self.swing_m_per_s;
                    self.swing_m_per_s += MODE_STEP_S * pull;
                    self.swing_m += MODE_STEP_S * self.swing_m_per_s;
                }
            }
        }
    }

    /// The tool with what the other axis and the time do to it.
    fn tool_m(&self, other: &State, time_s: f64) -> f64 {
        let axis = self.axis;
        let drift_m =
            if axis.drift_m == 0.0 { 0.0 } else { axis.drift_m * -(-time_s / axis.drift_s).exp_m1() };
        self.swing_m
            + axis.intalk_s2 * self.state.table_m_per_s2
            + axis.crosstalk_s2 * other.table_m_per_s2
            + axis.squareness * other.table_m
            + axis.straightness_per_m * other.table_m * other.table_m
            + drift_m
            + axis.vibration.at(time_s)
            + axis.tool_bump.at(self.state.table_m)
    }
}

/// A signal as it was some time ago, straight between the steps.
struct Late {
    /// The last ones, the newest at `newest`.
    past: Vec<f64>,
    newest: usize,
    whole: usize,
    part: f64,
}

impl Late {
    fn new(late_s: f64, start: f64) -> Self {
        let steps = late_s / STEP_S;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some ms, not negative")]
        let whole = steps.floor() as usize;
        Self { past: vec![start; whole + 2], newest: 0, whole, part: steps.fract() }
    }

    fn push(&mut self, value: f64) {
        self.newest = (self.newest + 1) % self.past.len();
        self.past[self.newest] = value;
    }

    fn value(&self) -> f64 {
        let length = self.past.len();
        let back = |steps: usize| self.past[(self.newest + length - steps) % length];
        (1.0 - self.part) * back(self.whole) + self.part * back(self.whole + 1)
    }
}

/// Runs both axes along commanded places (mm, one a sample) and logs them.
#[must_use]
pub fn run(axes: &[Axis; 2], places: &[[f64; 2]], start_s: f64, random: &mut ChaCha8Rng) -> Log {
    let first = places.first().copied().unwrap_or_default();
    let mut moving = [0, 1].map(|i| Moving::new(&axes[i], 1e-3 * first[i]));
    // What the probes showed before.
    for i in [0, 1] {
        let tool_m = moving[i].tool_m(&moving[1 - i].state, start_s);
        moving[i].tool = Late::new(axes[i].tool_late_s, tool_m);
    }
    let mut written = AXES.map(|_| Columns::default());
    for (sample, place) in places.iter().enumerate() {
        let time_s = start_s + SAMPLE_S * sample as f64;
        for (i, axis) in moving.iter_mut().enumerate() {
            written[i].add(axis, place[i], random);
            axis.servo.position_tick(1e-3 * place[i], axis.reading_m(), axis.state.table_m);
        }
        for step in 0..STEPS_A_SAMPLE {
            for axis in &mut moving {
                if step % STEPS_A_VELOCITY_TICK == 0 {
                    axis.servo.velocity_tick(axis.reading_m());
                }
                let force_n = axis.servo.force_n();
                let table_m = axis.state.table_m;
                axis.axis.mechanics.step(&mut axis.state, force_n);
                axis.follow(table_m);
            }
            let now_s = time_s + STEP_S * f64::from(step + 1);
            let tools = [0, 1].map(|i| moving[i].tool_m(&moving[1 - i].state, now_s));
            for (axis, tool_m) in moving.iter_mut().zip(tools) {
                axis.table.push(axis.state.table_m);
                axis.tool.push(tool_m);
            }
        }
    }
    let axes = AXES.iter().zip(written).map(|(name, columns)| columns.into_log(name)).collect();
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
    fn add(&mut self, axis: &Moving<'_>, command_mm: f64, random: &mut ChaCha8Rng) {
        let mut read =
            |value: f64, noise: f64, steps: f64| rounded(value + noise * box_muller(random), steps);
        self.command.push(rounded(command_mm, COMMAND_STEPS_A_MM));
        self.motor.push(read(1e3 * axis.reading_m(), NOISE.motor_mm, POSITION_STEPS_A_MM));
        self.table.push(read(1e3 * axis.table.value(), NOISE.table_mm, POSITION_STEPS_A_MM));
        self.tool.push(read(1e3 * axis.tool.value(), NOISE.tool_mm, POSITION_STEPS_A_MM));
        self.force.push(read(axis.servo.force_n(), NOISE.force_n, FORCE_STEPS_A_N));
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

/// To whole steps: the very number that the decimals of the file read as.
fn rounded(value: f64, steps_a_unit: f64) -> f64 {
    // The sum makes 0 of −0, which the file would say as "-0.0".
    (value * steps_a_unit).round() / steps_a_unit + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_late_signal_is_what_it_was() {
        // A ramp of 1 a step, 2.4 steps late.
        let mut late = Late::new(2.4 * STEP_S, 0.0);
        (1..=10).for_each(|i| late.push(f64::from(i)));
        assert!((late.value() - 7.6).abs() < 1e-9, "{}", late.value());
        let mut prompt = Late::new(0.0, 0.0);
        prompt.push(3.0);
        assert_eq!(prompt.value().to_bits(), 3.0_f64.to_bits());
    }

    #[test]
    fn steps_read_as_their_decimals_and_zero_has_no_sign() {
        assert_eq!(rounded(0.123_456_7, POSITION_STEPS_A_MM).to_bits(), 0.12346_f64.to_bits());
        assert_eq!(rounded(-0.04, FORCE_STEPS_A_N).to_bits(), 0.0_f64.to_bits());
    }
}
