//! The loops of an axis with other settings, from a measured frequency response.
//!
//! The response was measured with the settings of the machine file. With others, only the controllers of the loops change, and what a
//! controller does is known: the model has it exactly. With the open velocity loop V, the closed one T = V/(1 + V), the open position
//! loop P, the index m for the model and the primes for the other settings:
//!
//! ```text
//! V' = V·Vm'/Vm        P' = P·(T'/T)·(Pm'/Tm')/(Pm/Tm)
//! ```
//!
//! The mechanics cancel in each quotient, as long as the sensor that closes the position loop is the one with which it was measured.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;
use serde_json::{Value, json};
use shared::config::Notch;

use super::error::TuningError;
use crate::margins::axis_margins::AxisLoops;
use crate::margins::sampled::Sampled;
use crate::margins::{Condition, MarginLimits};
use crate::response::ResponseFile;
use crate::response::file::{Conditions, NotchKeys, Tone};
use crate::response::margins::{LEAST_COHERENCE, MeasuredMargins};
use model::axis::{Feedback, Settings};
use model::machine::Machine;
use plant::instruments::Instruments;

/// Relative difference of two values that are the same, but for the digits of a file.
const SAME: f64 = 1e-6;

/// The loops of a measured axis with other settings.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredLoops {
    /// Name of the axis.
    pub axis: String,
    /// The velocity loop.
    pub velocity: MeasuredLoop,
    /// The position loop.
    pub position: MeasuredLoop,
}

/// A measured loop with other settings: its margins, and what lies above the measured frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredLoop {
    /// Crossover and margins within the measured frequencies.
    pub margins: MeasuredMargins,
    /// Gain at the highest measured frequency, dB.
    pub last_db: f64,
}

impl MeasuredLoop {
    fn of(responses: &[(f64, Complex<f64>)]) -> Self {
        let last = responses.last().map_or(f64::INFINITY, |(_, response)| response.norm());
        Self {
            margins: MeasuredMargins::of_responses(responses.iter().copied()),
            last_db: 20.0 * libm::log10(last),
        }
    }

    /// Whether the loop has these margins wherever it was measured, and a gain above the measured frequencies that leaves the gain margin.
    /// A crossover below them is judged by the model alone.
    #[must_use]
    pub fn meets(&self, limits: MarginLimits) -> bool {
        let MeasuredMargins { phase_deg, gain_db, .. } = self.margins;
        phase_deg.is_none_or(|at| at.value >= limits.phase_deg)
            && gain_db.is_none_or(|at| at.value >= limits.gain_db)
            && self.last_db <= -limits.gain_db
    }
}

/// A frequency at which an axis was measured, with its loops, measured and of the model.
#[derive(Clone, Copy, Debug)]
struct Line {
    frequency_hz: f64,
    velocity: Complex<f64>,
    position: Complex<f64>,
    model: Model,
}

impl Line {
    /// The velocity loop with the settings of a model.
    fn velocity_with(&self, model: Model) -> Complex<f64> {
        self.velocity * model.velocity / self.model.velocity
    }

    /// The position loop with the settings of a model; `None`: half of its sample rate is below the frequency.
    fn position_with(&self, model: Model) -> Option<Complex<f64>> {
        let changed = closed(self.velocity_with(model)) / closed(self.velocity);
        Some(self.position * changed * model.of_position()? / self.model.of_position()?)
    }
}

/// Loops of the model at a frequency.
#[derive(Clone, Copy, Debug)]
struct Model {
    velocity: Complex<f64>,
    /// `None`: half of its sample rate is below the frequency.
    position: Option<Complex<f64>>,
}

impl Model {
    /// The velocity command over the velocity: the position loop without the velocity loop within it.
    fn of_position(self) -> Option<Complex<f64>> {
        Some(self.position? / closed(self.velocity))
    }
}

fn closed(open: Complex<f64>) -> Complex<f64> {
    open / (1.0 + open)
}

/// A measured axis of a machine.
#[derive(Clone, Debug)]
pub struct MeasuredAxis {
    /// Name of the axis.
    pub axis: String,
    /// Its number in the machine.
    pub index: usize,
    /// The sensor that closed the position loop.
    pub feedback: Feedback,
    /// The notches that were proposed for its highest resonances, the highest first.
    pub notches: Vec<Notch>,
    lines: Vec<Line>,
}

impl MeasuredAxis {
    /// The axis of a file that `board response` wrote, with the machine file whose settings it had.
    ///
    /// # Errors
    /// If the machine does not have the axis, has other settings, or the loops could not be told apart.
    pub fn of(
        file: &ResponseFile,
        machine: &Machine,
        instruments: &Instruments,
    ) -> Result<Self, TuningError> {
        let axis = &file.conditions.axis;
        let refused = |problem: String| TuningError::Measured { axis: axis.clone(), problem };
        let index = machine.axis.get_index_of(axis.as_str());
        let index = index.ok_or_else(|| refused("the machine file has no such axis".to_owned()))?;
        let loops = AxisLoops::of_machine(machine, instruments)?.swap_remove(index);
        let settings = &machine.axis[index].settings;
        check_controller(&file.conditions, machine, settings).map_err(refused)?;
        let linear = Linear::of(&loops);
        let lines: Vec<Line> = file.tones.iter().filter_map(|tone| linear.line(tone)).collect();
        if lines.len() < 2 {
            return Err(refused(
                "expected two tones with velocity and position loop and a coherence of 0.8, found fewer: measure with P and one sensor, or with more force"
                    .to_owned(),
            ));
        }
        Ok(Self {
            axis: axis.clone(),
            index,
            feedback: settings.sensors.feedback,
            notches: file.notch.as_ref().map(NotchKeys::notches).unwrap_or_default(),
            lines,
        })
    }

    /// Both loops with the settings of other loops of the axis.
    #[must_use]
    pub fn loops(&self, other: &AxisLoops) -> MeasuredLoops {
        MeasuredLoops {
            axis: self.axis.clone(),
            velocity: self.velocity(other),
            position: self.position(other),
        }
    }

    /// The velocity loop with the settings of other loops of the axis.
    #[must_use]
    pub fn velocity(&self, other: &AxisLoops) -> MeasuredLoop {
        self.with(other, |line, model| Some(line.velocity_with(model)))
    }

    /// The position loop with the settings of other loops of the axis, closed by the same sensor.
    #[must_use]
    pub fn position(&self, other: &AxisLoops) -> MeasuredLoop {
        self.with(other, Line::position_with)
    }

    fn with(&self, other: &AxisLoops, of: impl Fn(&Line, Model) -> Option<Complex<f64>>) -> MeasuredLoop {
        let linear = Linear::of(other);
        let responses = self
            .lines
            .iter()
            .filter_map(|line| Some((line.frequency_hz, of(line, linear.model(line.frequency_hz)?)?)));
        MeasuredLoop::of(&responses.collect::<Vec<_>>())
    }
}

/// Whether two values of a key are the same, but for their rounding.
fn is_same(one: &Value, other: &Value) -> bool {
    match (one, other) {
        (Value::Array(one), Value::Array(other)) => {
            one.len() == other.len() && one.iter().zip(other).all(|(one, other)| is_same(one, other))
        }
        _ => match (one.as_f64(), other.as_f64()) {
            (Some(one), Some(other)) => (one - other).abs() <= SAME * one.abs(),
            _ => one == other,
        },
    }
}

/// The controller with which the axis was measured has to be that of the machine file: its loops are divided by those of the model.
fn check_controller(conditions: &Conditions, machine: &Machine, settings: &Settings) -> Result<(), String> {
    if settings.schedule.ratio.is_some() {
        return Err("the machine file has gain_schedule_ratio: expected a constant velocity gain, as a response is measured with one".to_owned());
    }
    let [measured, declared] = [
        (&conditions.controller, conditions.tick_rate_hz),
        (&settings.into(), machine.rates().velocity_loop_hz),
    ]
    .map(|(controller, hz)| {
        let mut keys = json!(controller);
        keys["velocity_loop_rate_hz"] = json!(hz);
        keys
    });
    let keys =
        [&measured, &declared].into_iter().filter_map(Value::as_object).flat_map(serde_json::Map::keys);
    for key in keys {
        let [measured, declared] = [&measured[key], &declared[key]];
        if !is_same(measured, declared) {
            let [measured, declared] = [measured, declared].map(words);
            return Err(format!(
                "it was measured with {key} = {measured}, and the machine file has {declared}: expected the file of that board"
            ));
        }
    }
    Ok(())
}

fn words(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        value => value.as_f64().map_or_else(|| value.to_string(), |number| number.to_string()),
    }
}

/// The loops of the model of an axis whose friction is viscous.
struct Linear {
    velocity: Sampled,
    position: Sampled,
    tick_s: f64,
    position_tick_s: f64,
}

impl Linear {
    fn of(loops: &AxisLoops) -> Self {
        let axis = loops.linear(Condition::Sliding);
        Self {
            velocity: axis.velocity_loop(),
            position: axis.position_loop(),
            tick_s: axis.tick_s(),
            position_tick_s: axis.position_tick_s(),
        }
    }

    /// At a frequency below half of the tick rate.
    fn model(&self, frequency_hz: f64) -> Option<Model> {
        let angle = |tick_s: f64| Some(TAU * frequency_hz * tick_s).filter(|angle| *angle < PI);
        let position = || self.position.response(angle(self.position_tick_s)?);
        Some(Model { velocity: self.velocity.response(angle(self.tick_s)?)?, position: position() })
    }

    fn line(&self, tone: &Tone) -> Option<Line> {
        if tone.coherence < LEAST_COHERENCE {
            return None;
        }
        Some(Line {
            frequency_hz: tone.frequency_hz,
            velocity: tone.velocity_loop?.into(),
            position: tone.position_loop?.into(),
            model: self.model(tone.frequency_hz)?,
        })
    }
}
