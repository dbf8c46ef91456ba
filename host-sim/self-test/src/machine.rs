//! The machine of the second simulator: two axes with their drives and the mode of the tool, without a controller; see
//! [`super::plant`].

use super::plant::{LocalDefect, Mechanics, STEP_S, Sinusoid, State};
use super::sensors::Sensors;
use super::servo::Settings;

/// Names of the axes.
pub const AXES: [&str; 2] = ["x", "y"];

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

/// A drive: its force follows the command with a first-order lag.
struct Drive {
    lag_s: f64,
    acting_n: f64,
}

impl Drive {
    const fn new(lag_s: f64) -> Self {
        Self { lag_s, acting_n: 0.0 }
    }

    /// Force on the motor in a step over which a force is commanded, N: with a lag, that at the start of the step.
    ///
    /// The plant moves the positions with the velocities in the middle of the steps, which the force at the start changes: with that
    /// at the end, the lag would be a step too short. Without a lag the force acts half a step early, which the tracer has to find.
    fn acting_n(&mut self, force_n: f64) -> f64 {
        if self.lag_s == 0.0 {
            return force_n;
        }
        let before_n = self.acting_n;
        let kept = (-STEP_S / self.lag_s).exp();
        self.acting_n = force_n + kept * (before_n - force_n);
        before_n
    }
}

/// An axis with its state.
struct MovingAxis<'a> {
    axis: &'a Axis,
    state: State,
    drive: Drive,
    mode_m: f64,
    mode_m_per_s: f64,
    table: DelayLine,
    tool: DelayLine,
}

impl<'a> MovingAxis<'a> {
    fn new(axis: &'a Axis, at_m: f64, time_s: f64) -> Self {
        Self {
            axis,
            state: State { time_s, ..State::resting(at_m) },
            drive: Drive::new(axis.servo.lag_s),
            mode_m: at_m,
            mode_m_per_s: 0.0,
            table: DelayLine::new(axis.table_delay_s, at_m),
            tool: DelayLine::new(axis.tool_delay_s, at_m),
        }
    }

    /// Steps the mode between table and tool. `from_m` is the position of the table before the step: it moves evenly to that
    /// after it. With either of them for the whole step, the tool would be half a step late or early.
    fn step_mode(&mut self, from_m: f64) {
        match self.axis.resonance {
            None => self.mode_m = self.state.table_m,
            Some([omega, zeta]) => {
                // The damping is that of the mean of the velocities before and after: otherwise a step h would shift the
                // frequency by ζωh/2.
                for step in 0..MODE_STEPS {
                    let fraction = f64::from(step) / f64::from(MODE_STEPS);
                    let table_m = from_m + fraction * (self.state.table_m - from_m);
                    let damping = zeta * omega * MODE_STEP_S;
                    let pull = MODE_STEP_S * omega * omega * (table_m - self.mode_m);
                    self.mode_m_per_s = (self.mode_m_per_s * (1.0 - damping) + pull) / (1.0 + damping);
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

/// Both axes, moved by forces.
pub struct TwoAxes<'a> {
    axes: [MovingAxis<'a>; 2],
    start_s: f64,
    steps: u64,
}

impl<'a> TwoAxes<'a> {
    /// At rest with the motors at `at_m`, at a time on the clock of the session.
    #[must_use]
    pub fn new(axes: &'a [Axis; 2], at_m: [f64; 2], start_s: f64) -> Self {
        let mut machine =
            Self { axes: [0, 1].map(|i| MovingAxis::new(&axes[i], at_m[i], start_s)), start_s, steps: 0 };
        // The delay lines of the tools start with the positions of the tools at rest.
        let tools_m = machine.tools_m();
        for ((moving, axis), tool_m) in machine.axes.iter_mut().zip(axes).zip(tools_m) {
            moving.tool = DelayLine::new(axis.tool_delay_s, tool_m);
        }
        machine
    }

    /// Readings of the motors' sensors in the control loops, m.
    #[must_use]
    pub fn readings_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.axis.reading_m(axis.state.motor_m))
    }

    /// Readings of the motors' sensors before they are resolved into steps, m.
    #[must_use]
    pub fn continuous_readings_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.axis.continuous_reading_m(axis.state.motor_m))
    }

    /// Positions of the tables, m.
    #[must_use]
    pub fn tables_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.state.table_m)
    }

    /// Positions of the tables with their delay in the log, m.
    #[must_use]
    pub fn logged_tables_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.table.value())
    }

    /// Positions of the tools with their delay in the log, m.
    #[must_use]
    pub fn logged_tools_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(|axis| axis.tool.value())
    }

    /// One step of the plant under commanded forces, N.
    pub fn step(&mut self, forces_n: [f64; 2]) {
        for (axis, force_n) in self.axes.iter_mut().zip(forces_n) {
            let acting_n = axis.drive.acting_n(force_n);
            let from_m = axis.state.table_m;
            axis.axis.mechanics.step(&mut axis.state, acting_n);
            axis.step_mode(from_m);
        }
        self.steps += 1;
        let tools_m = self.tools_m();
        for (axis, tool_m) in self.axes.iter_mut().zip(tools_m) {
            axis.table.push(axis.state.table_m);
            axis.tool.push(tool_m);
        }
    }

    /// Positions of the tools, m.
    fn tools_m(&self) -> [f64; 2] {
        let time_s = self.start_s + STEP_S * self.steps as f64;
        let [x, y] = &self.axes;
        [x.tool_m(&y.state, time_s), y.tool_m(&x.state, time_s)]
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

    #[test]
    fn a_lag_of_the_drive_delays_a_step_of_force_by_its_time_constant() {
        let (lag_s, commanded_n) = (0.4e-3, 500.0);
        let mut drive = Drive::new(lag_s);
        // The force at the start of each step.
        for step in 0..20 {
            let expected_n = commanded_n * -(-f64::from(step) * STEP_S / lag_s).exp_m1();
            let acting_n = drive.acting_n(commanded_n);
            assert!((acting_n - expected_n).abs() < 1e-9 * commanded_n, "{step}: {acting_n} {expected_n}");
        }
        assert!((Drive::new(0.0).acting_n(commanded_n) - commanded_n).abs() < f64::EPSILON);
    }
}
