//! The fit of the tracer from first values, for each form of the loops.

use std::collections::BTreeMap;

use files::error::InputError;
use files::log::{Log, Unit};
use model::axis::{Drive, Settings, TOLERATED, Tolerated};
use model::effects::Stage;
use model::machine::{Axis, Machine};
use rayon::prelude::*;
use shared::config::Rates;
use trace::axis_trace::fit_values;
use trace::fit::axis_model::AxisModel;
use trace::fit::fit_data::FitData;
use trace::fit::scope_fit::Progress;
use trace::input::signals::Signals;
use trace::outcome::AxisTrace;
use trace::stages::stage_names;
use trace::{Trace, TraceOptions};

use crate::control_loop::DIVIDERS;
use crate::period;
use crate::rough::{self, Origin, Rough};
use crate::shown::{Spread, keep_shown};

/// Tolerance of the first fit, percent: a value may be several times the first one.
const FIRST_PERCENT: f64 = 100.0;

/// Tolerance of the second fit, percent, which is centred on the first.
const SECOND_PERCENT: f64 = 50.0;

/// Forms of the loops that are fitted for an axis.
const MOST_FORMS: usize = 4;

/// Part of what the best form before it leaves that another form may leave at most: a form with one more value always leaves a little less.
const BETTER_FORM: f64 = 0.8;

/// Times the noise up to which what is left of the motor is noise.
const AT_NOISE: f64 = 1.5;

/// Most effects that are searched for beside the values of a stage: smaller ones hardly move these.
const MOST_EFFECTS: usize = 4;

/// Number of half widths of an interval in a tolerance: the next logs have errors of the model that these do not show.
const HALF_WIDTHS: f64 = 3.0;

/// Smallest tolerance, percent, of a value of the mechanics and of a setting of the controller.
const LEAST_PERCENT: [f64; 2] = [2.0, 0.5];

/// Tolerance of a value of a regression alone, percent. The inertia of HSM150 is 11 % above that of its catalogue.
const REGRESSION_PERCENT: f64 = 20.0;

/// Half width, relative, of the gains of a loop that commands the velocity of an unknown drive, if the logs show only the lag that both
/// have together.
const OF_UNKNOWN_DRIVE: f64 = 0.25;

/// Factors of Kp, with the same lag (1 − Kf)/Kp, and times the residual at which such a gain describes the motor as well.
const OTHER_GAINS: [f64; 2] = [0.75, 1.33];
const AS_WELL: f64 = 1.5;

/// Tolerance of a usual value, percent: zero to twice it.
const USUAL_PERCENT: f64 = 100.0;

/// A value of an axis with its origin and tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Where it comes from.
    pub origin: Origin,
    /// Half width of its 95 % confidence interval, relative; `None`: it was not fitted.
    pub half_width: Option<f64>,
    /// Its tolerance in the file, percent; `None`: exact.
    pub tolerance_percent: Option<f64>,
}

/// A machine file from logs.
#[derive(Clone, Debug)]
pub struct Initial {
    /// The machine, with tolerances.
    pub machine: Machine,
    /// The values with an origin, by axis and key.
    pub values: BTreeMap<(String, &'static str), Value>,
    /// What was decided and what it rests on, one sentence each.
    pub notes: Vec<String>,
}

/// The machine with everything that the logs show beside what is known of it.
///
/// # Errors
/// If the logs do not belong to the machine.
pub fn machine(known: &Machine, logs: &[Log], progress: &Progress<'_>) -> Result<Initial, InputError> {
    let names: Vec<String> = known.axis.keys().cloned().collect();
    let options = TraceOptions::default();
    progress("regressions");
    let signals: Vec<Signals> = logs.iter().map(|log| Signals::new(log, &names, &options.samples)).collect();
    let declared = known.velocity_loop_rate_hz.map(|_| known.rates().position_loop_divider);
    let forms = |(index, axis): (usize, &Axis)| {
        let of_axis: Vec<_> = signals.iter().map(|log| &log.axes[index]).collect();
        rough::of(axis, &of_axis, 1.0 / known.sample_rate_hz, declared)
    };
    let forms: Vec<Vec<Rough>> = known.axis.values().enumerate().map(forms).collect();
    let divider = declared.unwrap_or(DIVIDERS[0]);
    let search = Search { known, logs, progress };
    let (mut best, examined) = search.best_forms(&forms, divider)?;
    let is_torque = |rough: &Rough| rough.settings.controller.drive == Drive::Torque;
    let is_open = declared.is_none() && best.iter().any(|fitted| is_torque(&fitted.rough));
    let divider = match is_open {
        false => declared.unwrap_or(1),
        true if best.iter().all(|fitted| fitted.is_at_noise) => divider,
        true => search.best_divider(&mut best, &examined),
    };
    let shows_gain: Vec<bool> =
        best.iter().enumerate().map(|(axis, fitted)| search.shows_gain(&examined, axis, fitted)).collect();
    progress("fitting the values");
    let best: Vec<&Rough> = best.iter().map(|fitted| &fitted.rough).collect();
    let mut machine = search.machine(&best, SECOND_PERCENT, divider);
    let last = trace::evaluate(&machine, logs, &[], progress)?;
    let (mut values, mut notes) = (BTreeMap::new(), last.notes.clone());
    for (index, (rough, axis)) in best.into_iter().zip(&last.axes).enumerate() {
        let mut rough = with_values_of(rough, &axis.model);
        let declared = &known.axis[&axis.axis];
        let of_axis: Vec<_> = signals.iter().map(|log| &log.axes[index]).collect();
        notes.extend(keep_shown(&mut rough, axis, &declared.settings, Spread::of(&of_axis)));
        let settings = with_tolerances(&rough, axis, shows_gain[index], &mut values);
        if let Some(written) = machine.axis.get_mut(&axis.axis) {
            *written = Axis { settings, effect: declared.effect.clone(), ..Axis::default() };
        }
    }
    let has_loops = machine.axis.values().any(|axis| axis.settings.controller.law.is_some());
    if !has_loops {
        machine.velocity_loop_rate_hz = known.velocity_loop_rate_hz;
    }
    notes.extend(unknown(&machine, &last, known.velocity_loop_rate_hz.is_none()));
    Ok(Initial { machine, values, notes })
}

/// What stays unknown, and the rate of the velocity loop if it was found.
fn unknown(machine: &Machine, last: &Trace, is_rate_found: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if let (Some(rate_hz), true) = (machine.velocity_loop_rate_hz, is_rate_found) {
        notes.push(format!(
            "The velocity loop is taken to run at {rate_hz} Hz, which leaves least of the motor."
        ));
    }
    for (index, (name, axis)) in machine.axis.iter().enumerate() {
        let is_linear = last.axes[index].unit == Unit::Millimetre;
        if axis.settings.mechanics.lead_mm.is_none() && is_linear {
            let seen = period::strongest(last, index).map_or(String::new(), |[period_mm, amplitude_um]| {
                format!(
                    ". An error of {amplitude_um:.2} µm repeats every {period_mm:.2} mm: perhaps once a turn, \
                     perhaps several times"
                )
            });
            notes.push(format!("{name}: lead_mm is unknown{seen}."));
        }
        for missing in &last.axes[index].not_testable {
            let stage = stage_names(&[missing.stage]);
            notes.push(format!("{name}: the {stage} stage is not modelled: it needs {}.", missing.needs));
        }
    }
    notes
}

/// Values of an axis with what their fit leaves of the motor.
#[derive(Clone, Debug)]
struct Fitted {
    rough: Rough,
    motor_rms: f64,
    /// Whether only the noise is left of the motor: another form cannot be better.
    is_at_noise: bool,
}

/// The search for the form of the loops.
struct Search<'a> {
    known: &'a Machine,
    logs: &'a [Log],
    progress: &'a Progress<'a>,
}

impl Search<'_> {
    /// The machine with the values of its axes, of which those that are not known have a tolerance, percent.
    fn machine(&self, rough: &[&Rough], percent: f64, divider: u32) -> Machine {
        let mut machine = self.known.clone();
        if machine.velocity_loop_rate_hz.is_none() && divider > 1 {
            machine.velocity_loop_rate_hz = Some(f64::from(divider) * machine.sample_rate_hz);
        }
        for (axis, rough) in machine.axis.values_mut().zip(rough) {
            *axis = rough.free(percent);
        }
        machine
    }

    /// The form of each axis that leaves least of the motor, with the effects that a trace finds beside it: an effect that is not
    /// modelled would choose another form in its place. The last trace has the examined logs.
    fn best_forms(&self, forms: &[Vec<Rough>], divider: u32) -> Result<(Vec<Fitted>, Trace), InputError> {
        let rounds = forms.iter().map(Vec::len).max().unwrap_or(0).clamp(1, MOST_FORMS);
        let mut best: Vec<Option<Fitted>> = forms.iter().map(|_| None).collect();
        let mut examined = None;
        for round in 0..rounds {
            let tried: Vec<&Rough> =
                forms.iter().filter_map(|forms| forms.get(round.min(forms.len().checked_sub(1)?))).collect();
            (self.progress)(&format!("form {} of {rounds} of the loops", round + 1));
            let trace = self.searched(&tried, divider)?;
            for ((best, rough), axis) in best.iter_mut().zip(tried).zip(&trace.axes) {
                let tried = Fitted::of(rough, axis);
                if best.as_ref().is_none_or(|best| tried.motor_rms < BETTER_FORM * best.motor_rms) {
                    *best = Some(tried);
                }
            }
            examined = Some(trace);
            if best.iter().flatten().all(|best| best.is_at_noise) {
                break;
            }
        }
        let none = || InputError::expected("--log", "a log of an axis", "none".to_owned());
        Ok((best.into_iter().flatten().collect(), examined.ok_or_else(none)?))
    }

    /// A trace from first values: they are fitted, then effects are searched for.
    fn searched(&self, tried: &[&Rough], divider: u32) -> Result<Trace, InputError> {
        let first =
            trace::evaluate(&self.machine(tried, FIRST_PERCENT, divider), self.logs, &[], self.progress)?;
        let fitted: Vec<Rough> =
            tried.iter().zip(&first.axes).map(|(rough, axis)| with_values_of(rough, &axis.model)).collect();
        let fitted: Vec<&Rough> = fitted.iter().collect();
        let mut options = TraceOptions::default();
        options.search.max_effects = MOST_EFFECTS;
        trace::trace_with(
            &options,
            &self.machine(&fitted, FIRST_PERCENT, divider),
            [self.logs, &[]],
            self.progress,
        )
    }

    /// The ticks of the velocity loop per sample, which all axes share, with which the fits leave least; the values are then those.
    fn best_divider(&self, best: &mut Vec<Fitted>, examined: &Trace) -> u32 {
        let error = |all: &[Fitted]| all.iter().map(|fitted| fitted.motor_rms.ln()).sum::<f64>();
        let mut kept = (f64::INFINITY, DIVIDERS[0]);
        let start = best.clone();
        for divider in DIVIDERS {
            (self.progress)(&format!("{divider} ticks of the velocity loop per sample"));
            let fit =
                |(axis, fitted): (usize, &Fitted)| self.refitted(examined, axis, &fitted.rough, divider);
            let tried: Vec<Fitted> = start.par_iter().enumerate().map(fit).collect();
            if error(&tried) < kept.0 {
                kept = (error(&tried), divider);
                *best = tried;
            }
        }
        kept.1
    }

    /// Whether a loop that commands the velocity of an unknown drive has no other gain with the same lag that describes the motor about as
    /// well, with another bandwidth of the drive. True for other drives.
    fn shows_gain(&self, examined: &Trace, axis: usize, fitted: &Fitted) -> bool {
        let controller = &fitted.rough.settings.controller;
        let (Drive::Velocity, Some(gain_per_s)) = (controller.drive, controller.position_gain_per_s) else {
            return true;
        };
        let lag_percent = 100.0 - controller.feedforward_percent.unwrap_or(0.0);
        let motor_rms = |factor: f64| {
            let mut other = fitted.rough.clone();
            other.settings.controller.position_gain_per_s = Some(factor * gain_per_s);
            other.settings.controller.feedforward_percent = Some((100.0 - factor * lag_percent).max(0.0));
            for key in ["position_gain_per_s", "feedforward_percent"] {
                other.origins.insert(key, Origin::Known);
            }
            self.refitted(examined, axis, &other, 1).motor_rms
        };
        let own = motor_rms(1.0);
        OTHER_GAINS.into_iter().all(|factor| motor_rms(factor) > AS_WELL * own)
    }

    /// The values of an axis fitted at a rate of the velocity loop, without a search.
    fn refitted(&self, examined: &Trace, axis: usize, rough: &Rough, divider: u32) -> Fitted {
        let sample_rate_hz = self.known.sample_rate_hz;
        let rates =
            Rates { velocity_loop_hz: f64::from(divider) * sample_rate_hz, position_loop_divider: divider };
        let data = FitData { rates, ..examined.data(&examined.fit_logs, axis) };
        let (model, left) = fit_values(&rough.free(SECOND_PERCENT), &data);
        let motor = left.iter().find(|(stage, _)| *stage == Stage::Motor);
        Fitted {
            rough: with_values_of(rough, &model),
            motor_rms: motor.map_or(f64::INFINITY, |(_, [rms, _])| *rms),
            is_at_noise: false,
        }
    }
}

impl Fitted {
    /// The values of a trace with the effects that it found, without those of the loops, and with what it leaves of the motor.
    fn of(rough: &Rough, axis: &AxisTrace) -> Self {
        let mut rough = with_values_of(rough, &axis.model);
        let found = axis.model.found().iter().filter(|effect| *effect.stages() != [Stage::Motor]);
        rough.beside.extend(found.cloned());
        let motor = axis.residual(Stage::Motor);
        Self {
            rough,
            motor_rms: motor.map_or(f64::INFINITY, |motor| motor.after.fit),
            is_at_noise: motor.is_none_or(|motor| motor.after.fit < AT_NOISE * motor.noise),
        }
    }
}

/// First values as fitted: those that the logs show, and the effects beside them.
fn with_values_of(rough: &Rough, model: &AxisModel) -> Rough {
    let mut rough = rough.clone();
    let shown = |key: &&Tolerated| rough.origins.get(key.key) == Some(&Origin::Logs);
    for key in TOLERATED.iter().filter(shown).collect::<Vec<_>>() {
        if let Some(value) = (key.get)(&model.axis.settings).filter(|value| *value > 0.0) {
            (key.set)(&mut rough.settings, crate::rounded(value));
        }
    }
    let declared = rough.beside.len();
    rough.beside = model.axis.effect.iter().take(declared).cloned().collect();
    rough
}

/// The settings with a tolerance for each value that was fitted, and the values for the file.
fn with_tolerances(
    rough: &Rough,
    axis: &AxisTrace,
    shows_gain: bool,
    values: &mut BTreeMap<(String, &'static str), Value>,
) -> Settings {
    let mut settings = rough.settings.clone();
    for key in TOLERATED {
        let Some(&origin) = rough.origins.get(key.key) else { continue };
        let fitted = axis.declared_values.iter().find(|value| value.key == key.key);
        let half_width =
            fitted.map(|value| value.half_width / value.fitted).filter(|width| width.is_finite());
        let half_width = half_width.map(|width| width.max(if shows_gain { 0.0 } else { OF_UNKNOWN_DRIVE }));
        let [of_mechanics, of_controller] = LEAST_PERCENT;
        let least = if key.is_of_controller { of_controller } else { of_mechanics };
        let tolerance_percent = match origin {
            Origin::Known => None,
            Origin::Usual => Some(USUAL_PERCENT),
            Origin::Regression => Some(REGRESSION_PERCENT),
            Origin::Logs if key.is_poorly_determined() => Some(USUAL_PERCENT),
            Origin::Logs => {
                Some((100.0 * HALF_WIDTHS * half_width.unwrap_or(1.0)).clamp(least, FIRST_PERCENT).ceil())
            }
        };
        if let Some(percent) = tolerance_percent {
            let tolerances = settings.mechanics.tolerance_percent.get_or_insert_default();
            (key.set_tolerance_percent)(tolerances, percent);
        }
        values.insert((axis.axis.clone(), key.key), Value { origin, half_width, tolerance_percent });
    }
    settings
}
