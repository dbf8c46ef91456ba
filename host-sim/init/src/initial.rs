//! The machine file from the fitted values: what is shown, with which tolerance, and what is said about the rest.

use std::collections::BTreeMap;

use files::error::InputError;
use files::log::{Log, Unit};
use model::axis::{Drive, Settings, TOLERATED};
use model::machine::{Axis, Machine};
use trace::AxisIdentification;
use trace::Progress;
use trace::input::signals::Signals;
use trace::stages::stage_names;
use trace::{Identification, TraceOptions};

use crate::control_loop::DIVIDERS;

use crate::form::{SECOND_PERCENT, Search, with_values_of};
use crate::period;
use crate::rough::{self, Origin, Rough};
use crate::shown::{Spread, keep_shown};

/// Number of half widths of an interval in a tolerance: the next logs have errors of the model that these do not show.
const HALF_WIDTHS: f64 = 3.0;

/// Largest tolerance, percent.
const MOST_PERCENT: f64 = 100.0;

/// Smallest tolerance, percent, of a value of the mechanics and of a setting of the controller.
const LEAST_PERCENT: f64 = 2.0;
const LEAST_CONTROLLER_PERCENT: f64 = 0.5;

/// Least tolerance of a stiffness that is estimated, or declared beside estimated masses, percent. That of the first case is estimated 2.6 % too low beside a mass that is
/// 1.7 % too high.
pub const STIFFNESS_PERCENT: f64 = 5.0;

/// Tolerance of a value of a regression alone, percent. The inertia of HSM150 is 11 % above that of its catalogue.
const REGRESSION_PERCENT: f64 = 20.0;

/// Smallest half width, relative, of the gains of a loop that commands the velocity of an unknown drive: where another gain describes the motor
/// worse, and where only the lag that both have together is shown. The drive is never just what its model is.
const OF_UNKNOWN_DRIVE: [f64; 2] = [0.05, 0.25];

/// Tolerance of a usual value, percent: zero to twice it.
const USUAL_PERCENT: f64 = 100.0;

/// A value of an axis with its origin and tolerance.
#[derive(Clone, Copy, Debug)]
pub struct Value {
    /// Where it comes from.
    pub origin: Origin,
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
    let known = &known.clone().named_as_logs(logs);
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
    let (mut values, mut notes) = (BTreeMap::new(), last.notes().to_vec());
    for (index, (rough, axis)) in best.into_iter().zip(last.axes()).enumerate() {
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
    notes.extend(unknown(&machine, &last, known));
    // As it is read from its file, which has the values of rotary axes in other units, with 15 digits.
    let machine = Machine::parse(&machine.to_toml(), "machine file of init")?;
    Ok(Initial { machine, values, notes })
}

/// What stays unknown, and what was assumed: kinds of drives, the rate of the velocity loop.
fn unknown(machine: &Machine, last: &Identification, known: &Machine) -> Vec<String> {
    let mut notes = Vec::new();
    if let (Some(rate_hz), None) = (machine.velocity_loop_rate_hz, known.velocity_loop_rate_hz) {
        notes.push(format!(
            "The velocity loop is taken to run at {rate_hz} Hz: with this rate the fitted motor position deviates least."
        ));
    }
    for (index, (name, axis)) in machine.axis.iter().enumerate() {
        let drive = axis.settings.controller.drive;
        if drive != known.axis[name].settings.controller.drive {
            let word = drive.word();
            notes.push(format!(
                "{name}: drive = \"{word}\" is assumed from the channels of the logs; --set {name}.drive=… says another."
            ));
        }
        let is_linear = last.axes()[index].unit == Unit::Millimetre;
        if axis.settings.mechanics.lead_mm.is_none() && is_linear {
            let seen = period::strongest(last, index).map_or(String::new(), |[period_mm, amplitude_um]| {
                format!(
                    ". An error of {amplitude_um:.2} µm repeats every {period_mm:.2} mm: perhaps once a turn, \
                     perhaps several times"
                )
            });
            notes.push(format!("{name}: lead_mm is unknown{seen}."));
        }
        for missing in &last.axes()[index].not_testable {
            let stage = stage_names(&[missing.stage]);
            notes.push(format!("{name}: the {stage} stage is not modelled: it needs {}.", missing.needs));
        }
    }
    notes
}

/// The settings with a tolerance for each value that was fitted, and the values for the file.
fn with_tolerances(
    rough: &Rough,
    axis: &AxisIdentification,
    shows_gain: bool,
    values: &mut BTreeMap<(String, &'static str), Value>,
) -> Settings {
    let mut settings = rough.settings.clone();
    for key in TOLERATED {
        let Some(&origin) = rough.origins.get(key.key) else { continue };
        let fitted = axis.declared_values.iter().find(|value| value.key == key.key);
        let half_width =
            fitted.map(|value| value.half_width / value.fitted).filter(|width| width.is_finite());
        let [of_shown, of_lag] = OF_UNKNOWN_DRIVE;
        let smallest = match rough.settings.controller.drive {
            Drive::Velocity if shows_gain => of_shown,
            Drive::Velocity => of_lag,
            _ => 0.0,
        };
        let half_width = half_width.map(|width| width.max(smallest));
        let least = match key.key {
            "stiffness_n_per_um" => STIFFNESS_PERCENT,
            _ if key.is_of_controller => LEAST_CONTROLLER_PERCENT,
            _ => LEAST_PERCENT,
        };
        let tolerance_percent = match origin {
            Origin::Known => None,
            Origin::Usual => Some(USUAL_PERCENT),
            Origin::Regression => Some(REGRESSION_PERCENT),
            Origin::Logs if key.is_poorly_determined() => Some(USUAL_PERCENT),
            Origin::Logs => {
                Some((100.0 * HALF_WIDTHS * half_width.unwrap_or(1.0)).clamp(least, MOST_PERCENT).ceil())
            }
        };
        if let Some(percent) = tolerance_percent {
            let tolerances = settings.mechanics.tolerance_percent.get_or_insert_default();
            (key.set_tolerance_percent)(tolerances, percent);
        }
        values.insert((axis.axis.clone(), key.key), Value { origin, tolerance_percent });
    }
    settings
}
