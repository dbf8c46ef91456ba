//! The compensation of a model: every effect is compensated as far as the controller can, and what makes the simulated contour
//! error larger is left out again.

use std::collections::BTreeSet;

use rayon::prelude::*;
use shared::compensate::CompensationSettings;

use crate::compensate::choice::{Choice, Part, Strength};
use crate::compensate::file::{AxisCompensation, CompensationFile, Provenance};
use crate::compensate::law_parts::law_terms;
use crate::compensate::listed::{Item, LeftOut, NotCompensated};
use crate::compensate::mapped::{self, Beyond};
use crate::compensate::planning::Planning;
use crate::compensate::prediction::{self, PredictionError, TestMotion, contour_errors, total_rms_um};
use crate::compensate::servo::ControllerChange;
use crate::compensate::watched::{Watch, Watched};
use crate::compensate::{force, tables};
use contour::ContourError;
use contour::verification::Prediction;
use model::axis::{Controller, Drive, Law, Settings};
use model::effects::Effect;
use plant::equivalent::{self, Assumed};
use plant::parameters::AxisParameters;

/// A part of a compensation is left out if the contour error is lower without it by more than this fraction.
const MIN_LOSS: f64 = 2e-3;

/// How far the measured error may be from the predicted one, percent.
const BOUND_PERCENT: f64 = 15.0;

/// How far the measured error may be from the predicted one where a loop is not known, or the errors beyond a map, percent.
const UNKNOWN_PERCENT: f64 = 100.0;

/// A compensation with its predictions.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The file.
    pub file: CompensationFile,
    /// What is compensated.
    pub items: Vec<Item>,
    /// What is not.
    pub not_compensated: Vec<NotCompensated>,
    /// The motions that may not become worse, beginning with those whose contour error counts.
    pub watched: Vec<Watched>,
    /// The motions whose contour error counts that leave the mapped travel: their names, and on which axes.
    pub beyond: Vec<(String, Vec<Beyond>)>,
    /// What the simulation assumes of axes whose loops or masses are not known.
    pub assumed: Vec<Assumed>,
}

impl Planning<'_> {
    /// Plans the compensation.
    ///
    /// # Errors
    /// If the model cannot be simulated on a motion, or the controller refuses a setting.
    pub fn plan(&self) -> Result<Plan, PredictionError> {
        self.check_capacity()?;
        let before = self.errors(&CompensationFile::none(self.model))?;
        let unknown = self.unknown()?;
        let (mut best_um, mut choice) = self.start(&unknown)?;
        let assumed = equivalent::of(self.model).1;
        // Where a loop is only assumed, its simulation does not decide whether a measured error is compensated.
        let may_go =
            |part: &Part| assumed.is_empty() || !matches!(part, Part::Effect(..) | Part::LawTerm(..));
        loop {
            let without = self.without_each(&choice)?.into_iter().filter(|(part, _)| may_go(part));
            match without.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((part, rms_um)) if rms_um <= best_um * (1.0 - MIN_LOSS) => {
                    best_um = rms_um;
                    choice.off.insert(part);
                }
                _ => break,
            }
        }
        // What is compensated together may be worse than nothing, and still better than without one of its parts.
        if best_um >= total_rms_um(&before) {
            choice.off.extend(self.parts());
        }
        let watch = Watch::new(self);
        let (mut choice, worse) = watch.guarded(choice)?;
        let idle = self.without_effect(&choice)?;
        choice.off.extend(idle.iter().cloned());
        let mut file = self.file(&choice)?;
        let after_um = total_rms_um(&self.errors(&file)?);
        let beyond = self.leaving(&file)?;
        file.predicted = self.predictions(&file, &beyond, assumed.is_empty())?;
        let without = self.without_each(&choice)?.into_iter();
        let items =
            without.map(|(part, before_um)| self.item((&part, &choice), before_um, after_um)).collect();
        let not_compensated = self.not_compensated(&choice.off, &LeftOut { idle, unknown, worse });
        let watched = watch.figures(&file)?;
        Ok(Plan { file, items, not_compensated, watched, beyond, assumed })
    }

    /// The motions that leave the mapped travel of a file, by their names.
    fn leaving(&self, file: &CompensationFile) -> Result<Vec<(String, Vec<Beyond>)>, PredictionError> {
        let of_motion = |test: &TestMotion| {
            let path = test.nominal_path(self.model)?;
            Ok((test.motion.name.clone(), mapped::beyond_on_path(file, self.model, &path)))
        };
        let all: Vec<_> = self.tests.iter().map(of_motion).collect::<Result<_, PredictionError>>()?;
        Ok(all.into_iter().filter(|(_, beyond)| !beyond.is_empty()).collect())
    }

    /// The predictions of the motions: without the noise of the probe, which each log has its own of. Beyond the mapped travel
    /// nothing is known of the error, and little where a loop is not known.
    fn predictions(
        &self,
        file: &CompensationFile,
        beyond: &[(String, Vec<Beyond>)],
        has_known_loops: bool,
    ) -> Result<Vec<Prediction>, PredictionError> {
        let mut predictions = prediction::predictions(self.model, file, self.tests, self.instruments)?;
        for prediction in &mut predictions {
            prediction.bound_percent = if has_known_loops { BOUND_PERCENT } else { UNKNOWN_PERCENT };
            prediction.unexplained_um = self.unexplained_um(prediction);
            if let Some((_, axes)) = beyond.iter().find(|(name, _)| *name == prediction.motion) {
                prediction.bound_percent = UNKNOWN_PERCENT;
                prediction.beyond_mapped = axes.iter().map(|beyond| beyond.axis.clone()).collect();
            }
        }
        Ok(predictions)
    }

    /// What the trace of the model left unexplained on the axes of a predicted motion, µm rms.
    fn unexplained_um(&self, prediction: &Prediction) -> f64 {
        let of_axis = |name: &String| self.model.axis.get(name)?.log_offsets?.unexplained_um;
        let squares_um2 = prediction.displacement_um.keys().filter_map(of_axis).map(|um| um * um);
        squares_um2.sum::<f64>().sqrt()
    }

    /// The parts that change no setting: the controller has no table left for them, or the force feed-forward to which they
    /// belong is left out.
    fn without_effect(&self, choice: &Choice) -> Result<BTreeSet<Part>, PredictionError> {
        let mut idle = BTreeSet::new();
        let axes = self.file(choice)?.axis;
        for part in self.parts().into_iter().filter(|part| choice.has(part)) {
            if self.file(&choice.without(&part))?.axis == axes {
                idle.insert(part);
            }
        }
        Ok(idle)
    }

    /// A tick of the position loop, s.
    pub(crate) fn tick_s(&self) -> f64 {
        1.0 / self.model.rates().position_loop_hz()
    }

    /// Mean time constant of the drives whose velocity is commanded, as far as a trace has fitted them, s; 0: there is none.
    pub(crate) fn drive_time_constant_s(&self) -> f64 {
        let axes = self.model.axis.values().filter(|axis| axis.settings.controller.drive == Drive::Velocity);
        let fitted_s = axes.map(|axis| axis.fitted_velocity_drive().time_constant_s);
        numerics::mean(fitted_s.filter(|fitted_s| *fitted_s > 0.0))
    }

    /// The errors over the position that motions leave far behind.
    fn unknown(&self) -> Result<BTreeSet<Part>, PredictionError> {
        let mut unknown = BTreeSet::new();
        for (index, axis) in self.model.axis.values().enumerate() {
            if mapped::is_far_beyond(self.model, self.tests, index)? {
                let effects =
                    axis.effect.iter().enumerate().filter(|(_, effect)| effect.over_position().is_some());
                unknown.extend(effects.map(|(effect, _)| Part::Effect(index, effect)));
            }
        }
        Ok(unknown)
    }

    /// All parts but some, with the best time of the velocity feed-forward and the better control law, and the contour error, µm rms.
    fn start(&self, off: &BTreeSet<Part>) -> Result<(f64, Choice), PredictionError> {
        let mut laws = vec![off.clone()];
        if self.parts().contains(&Part::Law) {
            laws.push(off.iter().cloned().chain([Part::Law]).collect());
        }
        let choices = laws.iter().flat_map(|off| {
            Strength::full(self.tick_s(), self.drive_time_constant_s())
                .map(|strength| Choice { off: off.clone(), strength })
        });
        let choices: Vec<Choice> = choices.collect();
        let tried = choices.into_par_iter().map(|choice| Ok((self.rms_um(&choice)?, choice)));
        let tried: Vec<(f64, Choice)> = tried.collect::<Result<_, PredictionError>>()?;
        let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(best.unwrap_or((f64::INFINITY, Choice::default())))
    }

    /// Rms of the contour error over all motions, µm.
    pub(crate) fn rms_um(&self, choice: &Choice) -> Result<f64, PredictionError> {
        Ok(total_rms_um(&self.errors(&self.file(choice)?)?))
    }

    /// Contour error on all motions without each part that is on, µm rms.
    fn without_each(&self, choice: &Choice) -> Result<Vec<(Part, f64)>, PredictionError> {
        let parts: Vec<Part> = self.parts().into_iter().filter(|part| choice.has(part)).collect();
        let without = |part: Part| Ok((part.clone(), self.rms_um(&choice.without(&part))?));
        parts.into_par_iter().map(without).collect()
    }

    fn errors(&self, file: &CompensationFile) -> Result<Vec<ContourError>, PredictionError> {
        contour_errors(self.model, file, self.tests, self.instruments)
    }

    /// All parts that the model gives reason for.
    pub(crate) fn parts(&self) -> Vec<Part> {
        let mut parts = Vec::new();
        for (index, axis) in self.model.axis.values().enumerate() {
            let is_compensated = |(_, effect): &(usize, &Effect)| effect.compensation().is_compensated();
            let effects = axis.effect.iter().enumerate().filter(is_compensated);
            parts.extend(effects.map(|(effect, _)| Part::Effect(index, effect)));
            parts.extend(
                law_terms(axis, index).filter(|(.., refused)| refused.is_none()).map(|(part, ..)| part),
            );
            let has_mass = axis.settings.has_mass();
            match axis.settings.controller.drive {
                Drive::Torque if has_mass => {
                    parts.push(Part::Force(index));
                    parts.extend((!axis.settings.is_rigid()).then_some(Part::Stretch(index)));
                }
                Drive::Velocity if force::of_velocity_drive(axis).is_some() => {
                    parts.push(Part::Force(index));
                }
                _ => {}
            }
        }
        let is_below = |percent: Option<f64>| percent.is_none_or(|percent| percent < 100.0);
        if self.has_loops() && self.controllers().any(|c| is_below(c.feedforward_percent)) {
            parts.push(Part::Feedforward);
        }
        if self.controllers().any(|controller| controller.law == Some(Law::Hpc)) {
            parts.push(Part::Law);
        }
        parts
    }

    /// Whether all axes have a loop with a feed-forward: one of which no gain is known may have any, and a stepper motor has no loop.
    fn has_loops(&self) -> bool {
        self.controllers().all(|c| c.position_gain_per_s.is_some() && c.drive != Drive::Stepper)
    }

    fn controllers(&self) -> impl Iterator<Item = &Controller> {
        self.model.axis.values().map(|axis| &axis.settings.controller)
    }

    /// The compensation without the parts that are off.
    pub(crate) fn file(&self, choice: &Choice) -> Result<CompensationFile, PredictionError> {
        let mut file = CompensationFile::none(self.model);
        file.provenance = Provenance {
            model: self.model_file.to_owned(),
            program: format!("lost-motion {}", env!("CARGO_PKG_VERSION")),
            compensates: self.compensated(choice),
        };
        for index in 0..self.model.axis.len() {
            let (name, axis) = self.axis(index, choice)?;
            file.axis.insert(name, axis);
        }
        Ok(file)
    }

    fn compensated(&self, choice: &Choice) -> Vec<String> {
        let parts = self.parts().into_iter().filter(|part| choice.has(part));
        let word = |part: Part| match self.names(&part) {
            (effect, axis) if axis.is_empty() => effect,
            (effect, axis) => format!("{axis}: {effect}"),
        };
        parts.map(word).collect()
    }

    fn axis(&self, index: usize, choice: &Choice) -> Result<(String, AxisCompensation), PredictionError> {
        let names: Vec<String> = self.model.axis.keys().cloned().collect();
        let name = names[index].clone();
        let mut axis = self.model.axis[index].clone();
        let mut effect = 0;
        // An effect that is not compensated must not reach a table by the part of the plant in which its law acts.
        axis.effect.retain(|kept| {
            effect += 1;
            kept.compensation().is_compensated() && choice.has(&Part::Effect(index, effect - 1))
        });
        let parameters = AxisParameters::of(&axis);
        let travel_m = mapped::known_m(&axis, mapped::travel_m(self.model, self.tests, index)?);
        let mut controller = ControllerChange::to_declared(&axis.settings, &parameters.servo);
        if choice.has(&Part::Feedforward) && self.has_loops() {
            let Strength { percent, ahead_s, .. } = choice.strength;
            let set = percent - parameters.servo.feedforward.percent;
            controller.feedforward_percent = Some(set.clamp(0.0, 200.0));
            controller.feedforward_ahead_s = (ahead_s > 0.0).then_some(ahead_s);
            axis.settings.controller.feedforward_percent = Some(percent);
        }
        if let Some(gain_per_s) = axis.settings.controller.position_gain_per_s {
            for mode in parameters.tool.modes() {
                controller.add_lead(gain_per_s * mode.lag_s(), &axis.settings);
            }
        }
        let is_hpc = axis.settings.controller.law == Some(Law::Hpc);
        controller.law = (is_hpc && choice.has(&Part::Law)).then_some(Law::P);
        let (mut compensation, _) = tables::of_axis(&parameters, &names, travel_m, self.set_at_s);
        (compensation.ripple, _) = force::ripple(&parameters);
        self.add_position_products(index, &parameters.tool, (&mut compensation, travel_m))?;
        self.add_laws(index, choice, (&mut compensation, travel_m))?;
        let force = match axis.settings.controller.drive {
            Drive::Torque => force::model(&parameters, &axis.settings, travel_m, self.set_at_s),
            Drive::Velocity => force::of_velocity_drive(&axis),
            Drive::Stepper => None,
        };
        let has_force = choice.has(&Part::Force(index));
        let is_torque = axis.settings.controller.drive == Drive::Torque;
        let has_stretch = is_torque && choice.has(&Part::Stretch(index));
        if let Some(model) = force.filter(|_| has_force || has_stretch) {
            compensation.force = Some(shared::compensate::settings::ForceModel {
                share: if has_force { 1.0 } else { 0.0 },
                ..model
            });
            compensation.stretch_m_per_n = parameters
                .spring
                .as_ref()
                .filter(|_| has_stretch)
                .map(|spring| choice.strength.stretch / spring.stiffness_n_per_m);
        }
        limit(&mut compensation, &axis.settings);
        let has_tables = !mapped::over_position(&compensation).is_empty();
        let mapped_m = if has_tables { Some(travel_m) } else { mapped::maps_m(&self.model.axis[index]) };
        let mapped_mm = mapped_m.map(|ends| ends.map(|m| 1e3 * m));
        Ok((name, AxisCompensation { mapped_mm, controller, compensation }))
    }
}

/// Bounds of corrections and force. A correction of 10 mm/s follows a reversal of some µm within a millisecond; of an axis whose loops are
/// not known, one of 2 mm/s, which no loop follows too far.
pub(crate) fn limit(compensation: &mut CompensationSettings, settings: &Settings) {
    let force_limit_n = settings.controller.force_limit_n;
    compensation.position_bound_m = 1e-3;
    compensation.position_rate_m_per_s = if settings.has_mass() { 0.01 } else { 0.002 };
    compensation.force_bound_n = force_limit_n.map_or(5000.0, |limit_n| (0.5 * limit_n).min(20_000.0));
    compensation.force_rate_n_per_s = 1e6;
}
