//! The position loops that are tried.

use super::measured::MeasuredAxis;
use crate::margins::axis_margins::AxisLoops;
use crate::margins::{MarginError, MarginLimits};
use model::axis::{Feedback, Law};
use model::machine::Machine;
use plant::instruments::Instruments;
use plant::parameters::AxisParameters;

/// Time constants of the dual feedback that are tried, as multiples of the declared one.
const TIME_CONSTANTS: [f64; 4] = [0.25, 0.5, 1.0, 2.0];

/// Velocity feed-forward that is tried, %, and the time by which it is ahead of the command, position ticks. At 50 %, HPC keeps
/// the radius of a circle.
const FEEDFORWARD: [(f64, f64); 4] = [(0.0, 0.0), (50.0, 0.0), (100.0, 0.0), (100.0, 1.0)];

/// A position loop, the same on all axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// P or HPC.
    pub law: Law,
    /// The sensors that close the loop.
    pub feedback: Feedback,
    /// Time constant of the dual feedback as a multiple of the declared one.
    pub time_constant_factor: f64,
    /// Kf, %.
    pub feedforward_percent: f64,
    /// Time by which the feed-forward is ahead of the command, position ticks.
    pub ahead_ticks: f64,
}

/// The candidates of a machine. The scale takes part only where the machine file says that it does; with measured axes, the sensor is the
/// one with which they were measured.
#[must_use]
pub fn of_machine(machine: &Machine, measured: &[MeasuredAxis]) -> Vec<Candidate> {
    let has =
        |feedback: Feedback| machine.axis.values().all(|axis| axis.settings.sensors.feedback == feedback);
    let mut feedbacks = vec![(Feedback::Motor, 1.0)];
    if has(Feedback::Table) || has(Feedback::Dual) {
        feedbacks.push((Feedback::Table, 1.0));
    }
    if has(Feedback::Dual) {
        feedbacks.extend(TIME_CONSTANTS.map(|factor| (Feedback::Dual, factor)));
    }
    feedbacks.retain(|(feedback, _)| measured.iter().all(|axis| axis.feedback == *feedback));
    let laws = [Law::P, Law::Hpc];
    let with_law = |law: Law| feedbacks.iter().map(move |(feedback, factor)| (law, *feedback, *factor));
    let with_feedforward = |(law, feedback, time_constant_factor)| {
        FEEDFORWARD.map(|(feedforward_percent, ahead_ticks)| Candidate {
            law,
            feedback,
            time_constant_factor,
            feedforward_percent,
            ahead_ticks,
        })
    };
    laws.into_iter().flat_map(with_law).flat_map(with_feedforward).collect()
}

impl Candidate {
    /// The machine with this position loop, at the highest Kp that all axes can have with these margins. The same Kp on all axes
    /// keeps the shape of a path. `None`: an axis has no such Kp.
    ///
    /// # Errors
    /// If the machine lacks a key.
    pub fn applied_to(
        &self,
        machine: &Machine,
        instruments: &Instruments,
        limits: MarginLimits,
        measured: &[MeasuredAxis],
    ) -> Result<Option<Machine>, MarginError> {
        let mut machine = machine.clone();
        let tick_s = 1.0 / machine.rates().position_loop_hz();
        for axis in machine.axis.values_mut() {
            let settings = &mut axis.settings;
            settings.controller.law = Some(self.law);
            settings.sensors.feedback = self.feedback;
            let time_constant_s = settings.sensors.dual_feedback_time_constant_s;
            settings.sensors.dual_feedback_time_constant_s = time_constant_s
                .filter(|_| self.feedback == Feedback::Dual)
                .map(|s| s * self.time_constant_factor);
            settings.controller.feedforward_percent = Some(self.feedforward_percent);
            settings.controller.feedforward_ahead_s =
                (self.ahead_ticks > 0.0).then_some(self.ahead_ticks * tick_s);
        }
        let loops = AxisLoops::of_machine(&machine, instruments)?;
        // The gain of the drive is the declared one times the mismatch that was found.
        let parameters = AxisParameters::of_machine(&machine);
        let factors = parameters.iter().map(|axis| axis.servo.mismatch.factor());
        let highest: Option<Vec<f64>> = loops
            .iter()
            .zip(factors)
            .enumerate()
            .map(|(index, (loops, factor))| {
                let measured = measured.iter().find(|axis| axis.index == index);
                let highest = loops.highest_usable_position_gain_per_s(|loops| {
                    loops.position().meet(limits)
                        && measured.is_none_or(|axis| axis.position(loops).meets(limits))
                });
                Some(highest? / factor)
            })
            .collect();
        Ok(highest.map(|gains| {
            let gain = gains.into_iter().fold(f64::INFINITY, f64::min);
            for axis in machine.axis.values_mut() {
                axis.settings.controller.position_gain_per_s = Some(gain);
            }
            machine
        }))
    }
}
