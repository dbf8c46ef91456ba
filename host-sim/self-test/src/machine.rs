//! The machine of the second simulator: two axes with their drives and the mode of the tool, without a controller; see
//! [`super::plant`].

use super::delay_line::DelayLine;
use super::drive::Drive;
use super::law::{LawTerm, Memories, displacement_m};
use super::mode::Mode;
use super::pickup::PickedUp;
use super::plant::{LocalDefect, Mechanics, STEP_S, Sinusoid, State};
use super::recording::Recording;
use super::scale::Scale;
use super::sensors::Sensors;
use super::servo::Settings;

/// Names of the axes.
pub const AXES: [&str; 2] = ["x", "y"];

/// True values of one axis with all undeclared effects, SI units. An effect of value 0 is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Settings of the drive.
    pub servo: Settings,
    /// Masses, spring, friction, errors of the screw.
    pub mechanics: Mechanics,
    /// Noise and resolution of the log.
    pub sensors: Sensors,
    /// Errors of the linear scale.
    pub scale: Scale,
    /// Errors between sensors and log.
    pub recording: Recording,
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
    /// Tool − table per product of both axes' positions, 1/m.
    pub yaw_per_m: f64,
    /// Tool − table over the other axis's position, m over m.
    pub guide_waves: Vec<Sinusoid>,
    /// Final value of the drift of tool − table, m.
    pub drift_m: f64,
    /// Time constant of the drift, s; above 0 unless the drift is 0.
    pub drift_s: f64,
    /// Final value and time constant of a second drift, m and s; none if absent.
    pub slow_drift: Option<[f64; 2]>,
    /// Drift without an end, m/s.
    pub drift_m_per_s: f64,
    /// Delay of the table in the log, s.
    pub table_delay_s: f64,
    /// Delay of the tool in the log, s.
    pub tool_delay_s: f64,
    /// ω (1/s) and ζ of the mode between table and tool; none: rigid.
    pub resonance: Option<[f64; 2]>,
    /// ω (1/s) and ζ of a second mode, whose deflection adds to that of the first.
    pub second_resonance: Option<[f64; 2]>,
    /// Whether the dampers of both modes are between table and tool, instead of between ground and tool.
    pub is_tool_damped_by_table: bool,
    /// Vibration of the tool over time, m over s.
    pub vibration: Sinusoid,
    /// Local error of the tool over the table's position.
    pub tool_defect: LocalDefect,
    /// A law of tool − table.
    pub law: Vec<LawTerm>,
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
struct MovingAxis<'a> {
    axis: &'a Axis,
    state: State,
    drive: Drive,
    modes: [Mode; 2],
    /// Motor and scale, as the position loop receives them.
    feedback: [PickedUp; 2],
    /// Reading of the motor's sensor from which the velocity is measured.
    earlier: DelayLine,
    table: DelayLine,
    tool: DelayLine,
    memories: Memories,
}

impl<'a> MovingAxis<'a> {
    fn new(axis: &'a Axis, at_m: f64, time_s: f64) -> Self {
        let state = State { time_s, ..axis.mechanics.resting(at_m) };
        let (motor_m, scale_m) = (axis.reading_m(at_m), axis.scale.reading_m(state.table_m, time_s));
        Self {
            axis,
            state,
            drive: Drive::new(&axis.servo),
            modes: [Mode::resting(at_m), Mode::resting(at_m)],
            feedback: [motor_m, scale_m].map(|start_m| PickedUp::new(axis.servo.pickup, start_m)),
            earlier: DelayLine::new(axis.servo.velocity_window_s.unwrap_or(0.0), motor_m),
            table: DelayLine::new(axis.table_delay_s, scale_m),
            tool: DelayLine::new(axis.tool_delay_s, at_m),
            memories: Memories::default(),
        }
    }

    /// One step of the plant under a commanded force.
    fn step(&mut self, force_n: f64) {
        let from_m = self.state.table_m;
        let acting_n = self.drive.acting_n(force_n);
        self.axis.mechanics.step(&mut self.state, acting_n);
        self.memories.follow(&self.axis.law, from_m, self.state.table_m);
        let Axis { resonance, second_resonance, is_tool_damped_by_table, .. } = *self.axis;
        for (mode, resonance) in self.modes.iter_mut().zip([resonance, second_resonance]) {
            mode.step([from_m, self.state.table_m], resonance, is_tool_damped_by_table);
        }
        let readings_m = [self.axis.reading_m(self.state.motor_m), self.scale_m()];
        for (feedback, reading_m) in self.feedback.iter_mut().zip(readings_m) {
            feedback.push(reading_m);
        }
        self.earlier.push(readings_m[0]);
        self.table.push(readings_m[1]);
    }

    /// Reading of the scale, m.
    fn scale_m(&self) -> f64 {
        self.axis.scale.reading_m(self.state.table_m, self.state.time_s)
    }

    /// Position of the tool with the effects of the other axis and of time.
    fn tool_m(&self, other: &State, time_s: f64) -> f64 {
        let axis = self.axis;
        let rise = |[end_m, constant_s]: [f64; 2]| end_m * -libm::expm1(-time_s / constant_s);
        let drift_m = if axis.drift_m == 0.0 { 0.0 } else { rise([axis.drift_m, axis.drift_s]) };
        let drift_m = drift_m + axis.slow_drift.map_or(0.0, rise) + axis.drift_m_per_s * time_s;
        let second_m = self.modes[1].at_m - self.state.table_m;
        self.modes[0].at_m
            + axis.intalk_s2 * self.state.table_m_per_s2
            + axis.crosstalk_s2 * other.table_m_per_s2
            + axis.squareness * other.table_m
            + axis.straightness_per_m * other.table_m * other.table_m
            + axis.yaw_per_m * self.state.table_m * other.table_m
            + axis.guide_waves.iter().map(|wave| wave.at(other.table_m)).sum::<f64>()
            + drift_m
            + axis.vibration.at(time_s)
            + axis.tool_defect.at(self.state.table_m)
            + displacement_m(&axis.law, &self.state, other, &self.memories)
            + second_m
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

    /// Readings of the scales, m.
    #[must_use]
    pub fn scales_m(&self) -> [f64; 2] {
        self.axes.each_ref().map(MovingAxis::scale_m)
    }

    /// Readings of motor and scale as the position loops receive them, m.
    #[must_use]
    pub fn feedback_m(&self) -> [[f64; 2]; 2] {
        self.axes.each_ref().map(|axis| axis.feedback.each_ref().map(PickedUp::value_m))
    }

    /// Readings of the motors' sensors from which the velocity is measured, where it is not the last one of the loop, m.
    #[must_use]
    pub fn earlier_readings_m(&self) -> [Option<f64>; 2] {
        self.axes.each_ref().map(|axis| axis.axis.servo.velocity_window_s.map(|_| axis.earlier.value()))
    }

    /// Readings of the scales with their delay in the log, m.
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
            axis.step(force_n);
        }
        self.steps += 1;
        let tools_m = self.tools_m();
        for (axis, tool_m) in self.axes.iter_mut().zip(tools_m) {
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
