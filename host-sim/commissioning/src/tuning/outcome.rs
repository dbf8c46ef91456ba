//! The proposal as text and JSON.

use std::cmp::Ordering;

use serde_json::{Value, json};

use super::candidate::Candidate;
use super::measured::{MeasuredLoop, MeasuredLoops};
use crate::margins::axis_margins::{AxisMargins, LoopMargins};
use crate::margins::margin::At;
use crate::margins::{MarginLimits, json};
use crate::response::margins::MeasuredMargins;
use model::axis::{Law, Settings};
use model::machine::Machine;

/// Lines of the table of position loops.
const SHOWN: usize = 8;

/// Settings with their margins and the contour error.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The position loop; `None`: as declared.
    pub candidate: Option<Candidate>,
    /// The machine with the settings.
    pub machine: Machine,
    /// The margins of its axes.
    pub margins: Vec<AxisMargins>,
    /// The loops of the measured axes, with these settings.
    pub measured: Vec<MeasuredLoops>,
    /// Rms of the simulated contour error over all motions, µm; `None`: a loop is unstable.
    pub contour_um: Option<f64>,
}

impl Tried {
    /// Order by the contour error, with unstable loops last.
    #[must_use]
    pub fn cmp_error(&self, other: &Self) -> Ordering {
        let or_infinite = |um: Option<f64>| um.unwrap_or(f64::INFINITY);
        or_infinite(self.contour_um).total_cmp(&or_infinite(other.contour_um))
    }
}

/// The settings that were tried, the best one first.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// As declared.
    pub declared: Tried,
    /// Position loops on the fastest velocity loops, the smallest contour error first.
    pub tried: Vec<Tried>,
    /// Margins that each has.
    pub limits: MarginLimits,
}

impl Proposal {
    /// The best settings, if they are better than the declared ones.
    #[must_use]
    pub fn best(&self) -> Option<&Tried> {
        self.tried.first().filter(|best| best.cmp_error(&self.declared).is_lt())
    }

    /// A sentence, the settings of each axis, and the position loops that were tried.
    #[must_use]
    pub fn text(&self) -> String {
        let MarginLimits { gain_db, phase_deg } = self.limits;
        let Some(best) = self.best() else {
            let with_margins = format!("No settings with margins of {gain_db} dB and {phase_deg}°");
            return self.declared.contour_um.map_or_else(
                || format!("{with_margins} have stable loops; nor have the declared ones."),
                |um| {
                    format!(
                        "{with_margins} have a smaller simulated contour error than the declared ones, {um:.2} µm rms."
                    )
                },
            );
        };
        let mut lines = vec![
            self.sentence(best),
            String::new(),
            format!(
                "{:<10}{:>6}{:>10}{:>10}{:>8}{:>12}{:>10}{:>14}{:>20}{:>20}",
                "",
                "law",
                "feedback",
                "Kp 1/s",
                "Kf %",
                "Kv N·s/m",
                "Ti ms",
                "notch Hz",
                "velocity loop",
                "position loop"
            ),
        ];
        for (word, tried) in [("declared", &self.declared), ("proposed", best)] {
            let axes = tried.machine.axis.iter().zip(&tried.margins);
            lines.extend(axes.map(|((name, axis), margins)| {
                format!("{:<10}{}", format!("{word} {name}"), settings_row(&axis.settings, margins))
            }));
        }
        if !best.measured.is_empty() {
            lines.push(String::new());
            lines.extend(best.measured.iter().map(|axis| {
                let [velocity, position] = [&axis.velocity, &axis.position].map(MeasuredLoop::words);
                format!(
                    "proposed {}, as measured: velocity loop {velocity}; position loop {position}",
                    axis.axis
                )
            }));
        }
        lines.extend([
            String::new(),
            format!(
                "{:>6}{:>10}{:>8}{:>10}{:>10}{:>16}",
                "law", "feedback", "Kf %", "ahead", "Kp 1/s", "contour µm rms"
            ),
        ]);
        lines.extend(self.tried.iter().take(SHOWN).filter_map(candidate_row));
        if self.tried.len() > SHOWN {
            lines.push(format!("and {} others, with larger errors", self.tried.len() - SHOWN));
        }
        lines.join("\n")
    }

    fn sentence(&self, best: &Tried) -> String {
        let MarginLimits { gain_db, phase_deg } = self.limits;
        let with_margins = format!("With margins of at least {gain_db} dB and {phase_deg}°");
        let best_um = um(best.contour_um, 2);
        self.declared.contour_um.map_or_else(
            || {
                format!(
                    "{with_margins}, the simulated contour error is {best_um} µm rms; the declared loops are unstable."
                )
            },
            |um| {
                format!(
                    "{with_margins}, the simulated contour error changes from {um:.2} to {best_um} µm rms."
                )
            },
        )
    }

    /// The JSON of `tune`.
    #[must_use]
    pub fn json(&self) -> Value {
        let tried = |tried: &Tried| {
            let settings = tried.machine.axis.iter().map(|(name, axis)| {
                let Settings { controller, filters, sensors, .. } = &axis.settings;
                let values = json!({
                    "position_gain_per_s": controller.position_gain_per_s,
                    "feedforward_percent": controller.feedforward_percent,
                    "feedforward_ahead_s": controller.feedforward_ahead_s,
                    "velocity_gain_n_s_per_m": controller.velocity_gain_n_s_per_m,
                    "velocity_integral_time_s": controller.velocity_integral_time_s,
                    "notch_frequency_hz": filters.notch_frequency_hz,
                    "dual_feedback_time_constant_s": sensors.dual_feedback_time_constant_s,
                });
                (name.clone(), values)
            });
            json!({
                "controller": tried.candidate.map(|candidate| candidate.law),
                "feedback": tried.candidate.map(|candidate| candidate.feedback),
                "axis": settings.collect::<serde_json::Map<_, _>>(),
                "margins": json::of(&tried.margins, self.limits),
                "measured": tried.measured.iter().map(MeasuredLoops::json).collect::<Vec<_>>(),
                "contour_error_um": tried.contour_um,
            })
        };
        json!({
            "declared": tried(&self.declared),
            "proposed": self.best().map(tried),
            "tried": self.tried.iter().map(tried).collect::<Vec<_>>(),
        })
    }
}

impl MeasuredLoops {
    /// `{"axis": …, "velocity": {…}, "position": {…}}`.
    fn json(&self) -> Value {
        json!({"axis": self.axis, "velocity": self.velocity.json(), "position": self.position.json()})
    }
}

impl MeasuredLoop {
    fn json(&self) -> Value {
        let MeasuredMargins { crossover_hz, phase_deg, gain_db } = self.margins;
        let at = |at: Option<At>| at.map(|at| json!({"value": at.value, "at_hz": at.hz}));
        json!({"crossover_hz": crossover_hz, "phase_margin_deg": at(phase_deg), "gain_margin_db": at(gain_db)})
    }

    fn words(&self) -> String {
        let MeasuredMargins { crossover_hz, phase_deg, gain_db } = self.margins;
        let Some((hz, phase)) = crossover_hz.zip(phase_deg) else {
            return "has its crossover below the measured frequencies".to_owned();
        };
        let gain = gain_db.map_or("no −180° was measured".to_owned(), |at| format!("{:.1} dB", at.value));
        format!("{gain}, {:.0}°, crossover {hz:.0} Hz", phase.value)
    }
}

fn settings_row(settings: &Settings, margins: &AxisMargins) -> String {
    let Settings { controller, filters, sensors, .. } = settings;
    let number = |value: Option<f64>, width: usize, decimals: usize| {
        value.map_or(format!("{:>width$}", "–"), |value| format!("{value:>width$.decimals$}"))
    };
    let law = controller.law.map_or("–", Law::word);
    let feedback = sensors.feedback.word();
    format!(
        "{law:>6}{feedback:>10}{}{}{}{}{}{:>20}{:>20}",
        number(controller.position_gain_per_s, 10, 1),
        number(controller.feedforward_percent, 8, 0),
        number(controller.velocity_gain_n_s_per_m, 12, 0),
        number(controller.velocity_integral_time_s.map(|s| 1e3 * s), 10, 1),
        filters
            .notch_frequency_hz
            .as_ref()
            .map_or(format!(" {:>13}", "–"), |hz| format!(" {:>13}", hz.words(0))),
        loop_words(&margins.velocity),
        loop_words(&margins.position),
    )
}

fn loop_words(margins: &LoopMargins) -> String {
    if margins.unstable.is_some() {
        return "unstable".to_owned();
    }
    let gain = margins.gain_db.map_or("–".to_owned(), |(at, _)| format!("{:.1} dB", at.value));
    let phase = margins.phase_deg.map_or("–".to_owned(), |(at, _)| format!("{:.0}°", at.value));
    format!("{gain}, {phase}")
}

/// A contour error, or that there is none.
fn um(contour_um: Option<f64>, decimals: usize) -> String {
    contour_um.map_or("unstable".to_owned(), |um| format!("{um:.decimals$}"))
}

fn candidate_row(tried: &Tried) -> Option<String> {
    let candidate = tried.candidate?;
    let [law, feedback] = [candidate.law.word(), candidate.feedback.word()];
    let gain = tried.machine.axis.values().next()?.settings.controller.position_gain_per_s?;
    Some(format!(
        "{law:>6}{feedback:>10}{:>8.0}{:>10}{gain:>10.1}{:>16}",
        candidate.feedforward_percent,
        if candidate.ahead_ticks > 0.0 {
            format!("{} tick", candidate.ahead_ticks)
        } else {
            "–".to_owned()
        },
        um(tried.contour_um, 3)
    ))
}
