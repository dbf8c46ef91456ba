//! The machining centre of the paper under control by `shared`: the corner of figure 3, circles, and a rapid move.

use crate::reproduce::study::ReproduceError;
use files::log::{AxisLog, Log};
use model::axis::Law;
use model::effects::Effect;
use model::machine::Machine;
use motion::{PathBlock, PathShape};
use plant::instruments::Instruments;
use plant::simulate::{self, Run};
use shared::scalar::Format;

/// The plant. It has effects that the prediction does not have.
const MACHINE: &str = include_str!("machine.toml");

/// Printed with figure 3: 3000 mm/min.
pub const FEED_M_PER_S: f64 = 3.0 / 60.0;

/// Printed in table 1: 48 m/min.
pub const RAPID_M_PER_S: f64 = 48.0 / 60.0;

/// Distance of a rapid move, m: more than half of it is at full speed.
pub const RAPID_M: f64 = 0.2;

/// Printed in table 1: acceleration of X and Y.
pub const ACCELERATION_M_PER_S2: [f64; 2] = [9.4, 7.3];

/// Length of each of the two lines along X and Y, m. At the corner the transient of the start has decayed:
/// (0.4 s)·(2 · 33 1/s) = 26 time constants.
const LINE_M: f64 = 14e-3;

/// Radius of the circles, m.
pub const RADIUS_M: f64 = 10e-3;

/// Start position of both axes: middle of the stroke, m.
const START_M: [f64; 2] = [0.2805, 0.2155];

/// Dwell before and after a motion.
const DWELL_S: f64 = 0.2;

/// Law and gains of both axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuning {
    /// Law of the position loop.
    pub law: Law,
    /// Position gain Kp.
    pub gain_per_s: f64,
    /// Feed-forward Kf.
    pub feedforward_percent: f64,
}

/// One channel of both axes, m.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// First axis.
    pub x_m: Vec<f64>,
    /// Second axis.
    pub y_m: Vec<f64>,
}

impl Track {
    /// Points of X and Y, m.
    pub fn points(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.x_m.iter().zip(&self.y_m).map(|(&x, &y)| [x, y])
    }
}

/// The log of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Sampling time.
    pub sample_s: f64,
    /// Command before feed-forward.
    pub command: Track,
    /// Motor encoders, as positions of the axis.
    pub motor: Track,
    /// Tool point, as measured by a grid encoder.
    pub tool: Track,
}

/// The machine with a tuning.
///
/// # Errors
/// If `machine.toml` is invalid.
pub fn tuned(tuning: Tuning) -> Result<Machine, ReproduceError> {
    let mut machine = Machine::parse(MACHINE, "the corner's machine")
        .map_err(|error| ReproduceError::Numerics(error.to_string()))?;
    for axis in machine.axis.values_mut() {
        axis.settings.controller.law = Some(tuning.law);
        axis.settings.controller.position_gain_per_s = Some(tuning.gain_per_s);
        axis.settings.controller.feedforward_percent = Some(tuning.feedforward_percent);
    }
    Ok(machine)
}

/// The corner, where the two lines meet, m.
#[must_use]
pub fn corner_m() -> [f64; 2] {
    START_M.map(|m| m + LINE_M)
}

/// Runs the corner: two 45° lines, X continuing and Y reversing, with the structural frequencies multiplied by
/// `frequency_ratio`.
///
/// # Errors
/// If the simulation fails.
pub fn corner(tuning: Tuning, frequency_ratio: f64) -> Result<Motion, ReproduceError> {
    let mut machine = tuned(tuning)?;
    for effect in machine.axis.values_mut().flat_map(|axis| &mut axis.effect) {
        if let Effect::Resonance(resonance) = effect {
            resonance.frequency_hz *= frequency_ratio;
        }
    }
    let [x, y] = START_M;
    // Along the path √2 times the printed acceleration of the slower axis, so that Y accelerates at 7.3 m/s².
    let along = std::f64::consts::SQRT_2 * ACCELERATION_M_PER_S2[1];
    let line = |to_m: [f64; 2]| PathBlock::new(PathShape::Line { to_m: to_m.to_vec() }, FEED_M_PER_S, along);
    run(&machine, &[line(corner_m()), line([x + 2.0 * LINE_M, y])])
}

/// Centre of the circles, m.
#[must_use]
pub fn centre_m() -> [f64; 2] {
    [START_M[0] - RADIUS_M, START_M[1]]
}

/// Runs two turns of a circle.
///
/// # Errors
/// If the simulation fails.
pub fn circle(tuning: Tuning) -> Result<Motion, ReproduceError> {
    let shape = PathShape::Arc { plane: [0, 1], centre_m: centre_m(), turns: 2.0 };
    run(&tuned(tuning)?, &[PathBlock::new(shape, FEED_M_PER_S, 1.0)])
}

/// Runs one axis at rapid speed with its printed acceleration.
///
/// # Errors
/// If the simulation fails.
pub fn rapid(tuning: Tuning, axis: usize) -> Result<Motion, ReproduceError> {
    let mut to_m = START_M.to_vec();
    to_m[axis] += RAPID_M;
    let shape = PathShape::Line { to_m };
    run(&tuned(tuning)?, &[PathBlock::new(shape, RAPID_M_PER_S, ACCELERATION_M_PER_S2[axis])])
}

/// Runs a path between two dwells.
fn run(machine: &Machine, path: &[PathBlock]) -> Result<Motion, ReproduceError> {
    let dwell = [PathBlock::dwell(DWELL_S)];
    let blocks = [&dwell[..], path, &dwell[..]].concat();
    let run = Run {
        machine,
        instruments: Instruments::typical(1),
        start_m: &START_M,
        blocks: &blocks,
        start_s: 0.0,
    };
    let mut controller = simulate::controller(machine, Format::Fixed, &START_M)?;
    let log = run.log(&mut *controller, |_, _, _| {})?;
    let track = |channel: fn(&AxisLog) -> &Option<Vec<f64>>| channel_of(&log, channel);
    Ok(Motion {
        sample_s: log.sample_time_s,
        command: track(|axis| &axis.command),
        motor: track(|axis| &axis.motor),
        tool: track(|axis| &axis.tool),
    })
}

/// One channel of both axes.
fn channel_of(log: &Log, channel: fn(&AxisLog) -> &Option<Vec<f64>>) -> Track {
    let metres =
        |axis: usize| -> Vec<f64> { channel(&log.axes[axis]).iter().flatten().map(|mm| 1e-3 * mm).collect() };
    Track { x_m: metres(0), y_m: metres(1) }
}
