//! The settings of the loops, from command, motor and force.
//!
//! force = Kv·(ev + ∫ev dt/Ti), ev = Kp·e + Kf·command' − velocity, where e and the feed-forward pass the filter of high-order
//! control. For a control law, a feedback, a filter and Ti the force is linear in Kv·Kp, Kv·Kf and Kv.

use nalgebra::SMatrix;
use numerics::resample::delayed_linear;
use rayon::prelude::*;
use shared::control::hpc::{Hpc, State};

use crate::mechanics::MOST_LEFT;
use crate::regression::{Regression, Solution, inner};
use model::axis::{Feedback, Law};
use trace::input::signals::AxisSignals;

/// Kp, 1/s, of the filters of high-order control that are tried.
const LEAST_GAIN: f64 = 5.0;
const MOST_GAIN: f64 = 400.0;
const GAIN_RATIO: f64 = 1.2;

/// Ti, s, that are tried, beside none.
const LEAST_INTEGRAL_S: f64 = 2e-3;
const MOST_INTEGRAL_S: f64 = 1.0;
const INTEGRAL_RATIO: f64 = 1.3;

/// Time constants of dual feedback that are tried, s.
const DUAL_S: [f64; 7] = [0.01, 0.02, 0.04, 0.06, 0.09, 0.15, 0.3];

/// Ticks of the velocity loop per sample that are tried, the usual ones first.
pub const DIVIDERS: [u32; 5] = [4, 8, 2, 1, 16];

/// Values tried on either side of one that was found, up to the next of the coarse ones.
const NEARBY: i32 = 4;

/// Ratio of neighbouring time constants of dual feedback.
const DUAL_RATIO: f64 = 1.5;

/// A law and feedback that leaves more than this many times what the best leaves is not the one.
const WORST_KIND: f64 = 1.5;

/// What is known of the loop.
#[derive(Clone, Copy, Debug, Default)]
pub struct Known {
    /// Control law; `None`: both are tried.
    pub law: Option<Law>,
    /// Position feedback; `None`: all are tried that the logs have the channels of.
    pub feedback: Option<Feedback>,
    /// Ticks of the velocity loop per sample.
    pub divider: Option<u32>,
}

/// Settings of the loops.
#[derive(Clone, Copy, Debug)]
pub struct LoopSettings {
    /// Control law.
    pub law: Law,
    /// Position feedback.
    pub feedback: Feedback,
    /// Time constant of dual feedback, s.
    pub dual_s: Option<f64>,
    /// Kp, 1/s.
    pub position_gain_per_s: f64,
    /// Kf, percent.
    pub feedforward_percent: f64,
    /// Kv, N·s/m.
    pub velocity_gain_n_s_per_m: f64,
    /// Ti, s; `None`: no integral part.
    pub integral_time_s: Option<f64>,
    /// Rms of the force that it leaves, N.
    pub rms_n: f64,
}

/// The form of a loop, beside its linear settings.
#[derive(Clone, Copy, Debug)]
struct Form {
    feedback: Feedback,
    dual_s: Option<f64>,
    /// Kp of the filter of high-order control, 1/s; `None`: proportional.
    filter_per_s: Option<f64>,
    divider: u32,
    /// Samples from the reading to the force that it causes in the log.
    shift: usize,
}

/// The settings for each control law and feedback that suits the force about as well as the best, which comes first.
#[must_use]
pub fn candidates(logs: &[&AxisSignals], sample_s: f64, known: Known) -> Vec<LoopSettings> {
    let has_table = logs.iter().any(|log| log.table.is_some());
    let is_possible = |law: Law, feedback: Feedback| {
        known.law.is_none_or(|own| own == law)
            && known.feedback.map_or(has_table || feedback == Feedback::Motor, |own| own == feedback)
    };
    let laws = [Law::P, Law::Hpc].into_iter();
    let kinds = laws
        .flat_map(|law| [Feedback::Motor, Feedback::Dual, Feedback::Table].map(|feedback| (law, feedback)));
    let kinds = kinds.filter(|(law, feedback)| is_possible(*law, *feedback));
    let tried =
        kinds.filter_map(|(law, feedback)| best(logs, sample_s, coarse(law, feedback, known.divider)));
    let mut tried: Vec<(LoopSettings, Form)> = tried.collect();
    let limit_n = WORST_KIND * numerics::min(tried.iter().map(|(settings, _)| settings.rms_n));
    tried.retain(|(settings, _)| settings.rms_n <= limit_n);
    let fine = |(settings, form): (LoopSettings, Form)| {
        let (settings, form) =
            best(logs, sample_s, other_instants(form, known.divider)).unwrap_or((settings, form));
        best(logs, sample_s, nearby(form)).map_or(settings, |(settings, _)| settings)
    };
    let mut all: Vec<LoopSettings> = tried.into_iter().map(fine).collect();
    all.sort_by(|a, b| a.rms_n.total_cmp(&b.rms_n));
    all
}

/// Forms of a law and a feedback over the whole range of their values.
fn coarse(law: Law, feedback: Feedback, divider: Option<u32>) -> Vec<Form> {
    let filters: Vec<Option<f64>> = match law {
        Law::P => vec![None],
        Law::Hpc => geometric(LEAST_GAIN, MOST_GAIN, GAIN_RATIO).into_iter().map(Some).collect(),
    };
    let duals: Vec<Option<f64>> = match feedback {
        Feedback::Dual => DUAL_S.into_iter().map(Some).collect(),
        _ => vec![None],
    };
    let divider = divider.unwrap_or(DIVIDERS[0]);
    let forms = filters.into_iter().flat_map(|filter_per_s| {
        duals.iter().map(move |&dual_s| Form { feedback, dual_s, filter_per_s, divider, shift: 1 })
    });
    forms.collect()
}

/// A form with other ticks and instants.
fn other_instants(form: Form, divider: Option<u32>) -> Vec<Form> {
    let dividers = DIVIDERS.into_iter().filter(|other| divider.is_none_or(|own| own == *other));
    dividers.flat_map(|divider| [0, 1].map(|shift| Form { divider, shift, ..form })).collect()
}

/// A form with values between those of [`coarse`].
fn nearby(form: Form) -> Vec<Form> {
    let factors = |value: Option<f64>, ratio: f64| -> Vec<Option<f64>> {
        let steps = (-NEARBY..=NEARBY).map(|step| libm::pow(ratio, f64::from(step) / f64::from(NEARBY)));
        value.map_or(vec![None], |value| steps.map(|factor| Some(value * factor)).collect())
    };
    let duals = factors(form.dual_s, DUAL_RATIO);
    let forms = factors(form.filter_per_s, GAIN_RATIO)
        .into_iter()
        .flat_map(|filter_per_s| duals.iter().map(move |&dual_s| Form { dual_s, filter_per_s, ..form }));
    forms.collect()
}

/// The form that leaves least of the force.
fn best(logs: &[&AxisSignals], sample_s: f64, forms: Vec<Form>) -> Option<(LoopSettings, Form)> {
    let all = forms.into_par_iter().filter_map(|form| Some((fitted(logs, sample_s, form)?, form)));
    all.min_by(|(a, _), (b, _)| a.rms_n.total_cmp(&b.rms_n))
}

/// Values from the least to the most, each a factor above the one before.
fn geometric(least: f64, most: f64, ratio: f64) -> Vec<f64> {
    std::iter::successors(Some(least), |value| Some(value * ratio))
        .take_while(|value| *value <= most)
        .collect()
}

/// The settings of a form with the best Ti; `None` if the logs do not determine them.
fn fitted(logs: &[&AxisSignals], sample_s: f64, form: Form) -> Option<LoopSettings> {
    let mut regression = Regression::<6>::default();
    for log in logs {
        add(&mut regression, log, sample_s, form);
    }
    let integrals = geometric(LEAST_INTEGRAL_S, MOST_INTEGRAL_S, INTEGRAL_RATIO).into_iter().map(Some);
    let solved = integrals.chain([None]).filter_map(|integral_time_s| {
        let rate = integral_time_s.map_or(0.0, |time_s| 1.0 / time_s);
        Some((settings(&regression, rate, form)?, integral_time_s))
    });
    let (best, integral_time_s) = solved.min_by(|(a, _), (b, _)| a.rms_n.total_cmp(&b.rms_n))?;
    Some(LoopSettings { integral_time_s, ..best })
}

/// The linear settings with 1/Ti, 1/s. With a filter its Kp is that of the loop.
fn settings(regression: &Regression<6>, rate: f64, form: Form) -> Option<LoopSettings> {
    // Each column with its integral.
    let factor = |row: usize, column: usize| match row {
        own if own == column => 1.0,
        integral if integral == column + 3 => rate,
        _ => 0.0,
    };
    let regression = regression.combined(&SMatrix::<f64, 6, 3>::from_fn(factor));
    let (values, rms_n, left) = match form.filter_per_s {
        None => {
            let Solution { values, rms, left } = regression.solve()?;
            (values, rms, left)
        }
        Some(kp) => {
            // Kp·e − velocity is one column, the feed-forward the other.
            let factors = SMatrix::<f64, 3, 2>::new(kp, 0.0, 0.0, 1.0, 1.0, 0.0);
            let Solution { values: [gain, feed], rms, left } = regression.combined(&factors).solve()?;
            ([gain * kp, feed, gain], rms, left)
        }
    };
    let [position, feed, velocity] = values;
    let law = if form.filter_per_s.is_some() { Law::Hpc } else { Law::P };
    let is_possible = velocity > 0.0 && position > 0.0 && left < MOST_LEFT;
    is_possible.then_some(LoopSettings {
        law,
        feedback: form.feedback,
        dual_s: form.dual_s,
        position_gain_per_s: position / velocity,
        feedforward_percent: (100.0 * feed / velocity).clamp(0.0, 200.0),
        velocity_gain_n_s_per_m: velocity,
        integral_time_s: None,
        rms_n,
    })
}

/// Adds a log: e, command', −velocity, and their integrals.
fn add(regression: &mut Regression<6>, log: &AxisSignals, sample_s: f64, form: Form) {
    let (Some(command), Some(motor), Some(force)) = (&log.command, &log.motor, &log.force) else { return };
    let Some(feedback) = feedback(log, sample_s, form) else { return };
    let samples = force.raw.len();
    let error: Vec<f64> =
        command.iter().zip(&feedback).map(|(command, feedback)| command - feedback).collect();
    let command_velocity: Vec<f64> =
        (0..samples).map(|i| (command[(i + 1).min(samples - 1)] - command[i]) / sample_s).collect();
    let [error, command_velocity] =
        [error, command_velocity].map(|values| filtered(values, form.filter_per_s, sample_s));
    // The last tick before the sample, and the difference over it: one and a half ticks before.
    let steps: Vec<f64> = differences(&motor.raw, sample_s);
    let velocity = delayed_linear(&steps, 1.5 / f64::from(form.divider) - 0.5 + (form.shift as f64 - 1.0));
    let mut integrals = [0.0; 3];
    let mut rows: Vec<([f64; 6], f64)> = Vec::with_capacity(samples);
    for i in form.shift..samples {
        let now = [error[i - form.shift], command_velocity[i - form.shift], -velocity[i]];
        for (integral, value) in integrals.iter_mut().zip(now) {
            *integral += sample_s * value;
        }
        let [a, b, c] = now;
        let [ia, ib, ic] = integrals;
        rows.push(([a, b, c, ia, ib, ic], force.raw[i]));
    }
    regression.add_log(rows[inner(rows.len())].iter().copied());
}

/// The position feedback, m; `None` without its channel.
fn feedback(log: &AxisSignals, sample_s: f64, form: Form) -> Option<Vec<f64>> {
    let motor = &log.motor.as_ref()?.raw;
    let table = || log.table.as_ref().map(|table| &table.raw);
    match form.feedback {
        Feedback::Motor => Some(motor.clone()),
        Feedback::Table => table().cloned(),
        Feedback::Dual => {
            let table = table()?;
            let kept = libm::exp(-sample_s / form.dual_s?);
            let mut slow = table.first()? - motor.first()?;
            let dual = motor.iter().zip(table).map(|(motor, table)| {
                slow = kept * slow + (1.0 - kept) * (table - motor);
                motor + slow
            });
            Some(dual.collect())
        }
    }
}

/// The values after the filter of high-order control with this Kp, which starts settled.
fn filtered(values: Vec<f64>, gain_per_s: Option<f64>, sample_s: f64) -> Vec<f64> {
    let Some(gain_per_s) = gain_per_s else { return values };
    let hpc = Hpc::<f64>::new(gain_per_s * sample_s);
    let mut state = State::settled(values.first().copied().unwrap_or(0.0));
    values.into_iter().map(|value| hpc.filter(&mut state, value)).collect()
}

/// Differences from each sample to the one before, per second.
fn differences(values: &[f64], sample_s: f64) -> Vec<f64> {
    (0..values.len()).map(|i| (values[i] - values[i.saturating_sub(1)]) / sample_s).collect()
}
