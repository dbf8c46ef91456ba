//! The form of the loops: control law, feedback, rate of the velocity loop.
//!
//! Each form is fitted by the tracer, which also searches for effects: one that is not modelled would choose another form in its place.

use files::error::InputError;
use files::log::Log;
use model::axis::{Drive, TOLERATED, Tolerated};
use model::effects::Stage;
use model::machine::Machine;
use rayon::prelude::*;
use shared::config::Rates;
use trace::AxisIdentification;
use trace::Progress;
use trace::fit::axis_model::AxisModel;
use trace::fit::baseline::fit_values;
use trace::fit::fit_data::FitData;
use trace::{Identification, TraceOptions};

use crate::control_loop::DIVIDERS;
use crate::rough::{Origin, Rough};

/// Tolerance of the first fit, percent: a value may be several times the first one.
const FIRST_PERCENT: f64 = 100.0;

/// Tolerance of the second fit, percent, which is centred on the first.
pub const SECOND_PERCENT: f64 = 50.0;

/// Forms of the loops that are fitted for an axis.
const MOST_FORMS: usize = 4;

/// Part of what the best form before it leaves that another form may leave at most: a form with one more value always leaves a little less.
const BETTER_FORM: f64 = 0.8;

/// Times the noise up to which what is left of the motor is noise.
const AT_NOISE: f64 = 1.5;

/// Most effects that are searched for beside the values of a stage: smaller ones hardly move these.
const MOST_EFFECTS: usize = 4;

/// Factors of Kp, with the same lag (1 − Kf)/Kp, and times the residual at which such a gain describes the motor as well.
const OTHER_GAINS: [f64; 2] = [0.75, 1.33];
const AS_WELL: f64 = 1.5;

/// Values of an axis with what their fit leaves of the motor.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The values, and the effects beside them.
    pub rough: Rough,
    /// Rms of what is left of the motor, µm; infinite if it is not evaluated.
    pub motor_rms: f64,
    /// Whether only the noise is left of the motor: another form cannot be better.
    pub is_at_noise: bool,
}

/// The search for the form of the loops.
pub struct Search<'a> {
    /// What is known of the machine.
    pub known: &'a Machine,
    /// The logs.
    pub logs: &'a [Log],
    /// Called with a message for each step.
    pub progress: &'a Progress<'a>,
}

impl Search<'_> {
    /// The machine with the values of its axes, of which those that are not known have a tolerance, percent.
    #[must_use]
    pub fn machine(&self, rough: &[&Rough], percent: f64, divider: u32) -> Machine {
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
    /// modelled would choose another form in its place. The trace that is returned has the examined logs.
    ///
    /// # Errors
    /// If the logs do not belong to the machine.
    pub fn best_forms(
        &self,
        forms: &[Vec<Rough>],
        divider: u32,
    ) -> Result<(Vec<Fitted>, Identification), InputError> {
        let rounds = forms.iter().map(Vec::len).max().unwrap_or(0).clamp(1, MOST_FORMS);
        let mut best: Vec<Option<Fitted>> = forms.iter().map(|_| None).collect();
        let mut examined = None;
        for round in 0..rounds {
            let tried: Vec<&Rough> =
                forms.iter().filter_map(|forms| forms.get(round.min(forms.len().checked_sub(1)?))).collect();
            (self.progress)(&format!("form {} of {rounds} of the loops", round + 1));
            let trace = self.searched(&tried, divider)?;
            for ((best, rough), axis) in best.iter_mut().zip(tried).zip(trace.axes()) {
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
    fn searched(&self, tried: &[&Rough], divider: u32) -> Result<Identification, InputError> {
        let first =
            trace::evaluate(&self.machine(tried, FIRST_PERCENT, divider), self.logs, &[], self.progress)?;
        let fitted: Vec<Rough> =
            tried.iter().zip(first.axes()).map(|(rough, axis)| with_values_of(rough, &axis.model)).collect();
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
    pub fn best_divider(&self, best: &mut Vec<Fitted>, examined: &Identification) -> u32 {
        let error = |all: &[Fitted]| all.iter().map(|fitted| libm::log(fitted.motor_rms)).sum::<f64>();
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
    #[must_use]
    pub fn shows_gain(&self, examined: &Identification, axis: usize, fitted: &Fitted) -> bool {
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
    fn refitted(&self, examined: &Identification, axis: usize, rough: &Rough, divider: u32) -> Fitted {
        let sample_rate_hz = self.known.sample_rate_hz;
        let rates =
            Rates { velocity_loop_hz: f64::from(divider) * sample_rate_hz, position_loop_divider: divider };
        let data = FitData { rates, ..examined.data(examined.fit_logs(), axis) };
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
    fn of(rough: &Rough, axis: &AxisIdentification) -> Self {
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
#[must_use]
pub fn with_values_of(rough: &Rough, model: &AxisModel) -> Rough {
    let mut rough = rough.clone();
    let shown = |key: &&Tolerated| rough.origins.get(key.key) == Some(&Origin::Logs);
    for key in TOLERATED.iter().filter(shown).collect::<Vec<_>>() {
        if let Some(value) = (key.get)(&model.axis.settings).filter(|value| *value > 0.0) {
            let value = crate::rounded_as_written(key.key, value, rough.settings.names);
            (key.set)(&mut rough.settings, value);
        }
    }
    let declared = rough.beside.len();
    rough.beside = model.axis.effect.iter().take(declared).cloned().collect();
    rough
}
