//! The compensation of a model: every effect is compensated as far as the controller can, and what makes the simulated contour
//! error larger is left out again.

use std::collections::BTreeSet;
use std::f64::consts::PI;

use rayon::prelude::*;
use shared::compensate::CompensationSettings;

use crate::file::{AxisCompensation, CompensationFile, Provenance};
use crate::prediction::{self, PredictionError, TestMotion, contour_errors, total_rms_um};
use crate::servo::ControllerChange;
use crate::treatment::{self, Treatment};
use crate::{force, tables};
use contour::ContourError;
use model::axis::Law;
use model::effects::Effect;
use model::machine::Machine;
use plant::instruments::Instruments;
use plant::machine_path::MachinePath;
use plant::parameters::AxisParameters;

/// A part of a compensation is left out if the contour error is lower without it by more than this fraction.
const MIN_LOSS: f64 = 2e-3;

/// Part of the travel of the motions that the tables cover beyond it, on both sides.
const BEYOND_TRAVEL: f64 = 0.02;

/// How far the measured error may be from the predicted one, percent.
const BOUND_PERCENT: f64 = 15.0;

/// Why a part has no setting, and what to do instead.
const NO_SETTING: (&str, &str) = (
    "no setting of the controller is left for it: tables of two periods, one source of cross-talk and straightness, friction \
     only as part of the force feed-forward",
    "remove its cause, or join effects of the same period",
);

/// A part of a compensation that can be left out.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    /// The compensation of an effect: index of the axis, and of the effect among those of the axis.
    Effect(usize, usize),
    /// Force feed-forward of an axis from its declared masses, friction and loads.
    Force(usize),
    /// The stretch of an axis's drive under the modelled force.
    Stretch(usize),
    /// Velocity feed-forward of 100 % on all axes.
    Feedforward,
    /// P control in place of HPC on all axes: HPC filters the feed-forward, too, and overshoots with 100 % of it.
    Law,
}

/// Times by which the velocity feed-forward is ahead of the command that are tried, position ticks. Its backward difference is
/// one tick late; drive and velocity reading change that by a part of a tick.
const AHEAD_TICKS: [f64; 7] = [0.0, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0];

/// What of the possible compensation is used.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choice {
    off: BTreeSet<Part>,
    /// Time by which the velocity feed-forward is ahead of the command, s.
    ahead_s: f64,
}

impl Choice {
    fn has(&self, part: &Part) -> bool {
        !self.off.contains(part)
    }

    pub(crate) fn without(&self, part: &Part) -> Self {
        let mut choice = self.clone();
        choice.off.insert(part.clone());
        choice
    }
}

/// What is compensated, and what the model predicts of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Name of the effect, or of the part of the declared model.
    pub effect: String,
    /// Name of the axis; all axes: empty.
    pub axis: String,
    /// What the controller does.
    pub does: String,
    /// Rms of the contour error without this item and with all others, µm.
    pub before_um: f64,
    /// Rms of the contour error with all items, µm.
    pub after_um: f64,
}

/// What is not compensated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotCompensated {
    /// Name of the effect, or of the part of the declared model.
    pub effect: String,
    /// Name of the axis; all axes: empty.
    pub axis: String,
    /// Why.
    pub why: String,
    /// What to do instead.
    pub instead: String,
}

/// A compensation with its predictions.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The file.
    pub file: CompensationFile,
    /// What is compensated.
    pub items: Vec<Item>,
    /// What is not.
    pub not_compensated: Vec<NotCompensated>,
}

/// From what a compensation is planned.
#[derive(Clone, Copy, Debug)]
pub struct Planning<'a> {
    /// The model, with the effects found.
    pub model: &'a Machine,
    /// Its file.
    pub model_file: &'a str,
    /// The motions whose contour error counts.
    pub tests: &'a [TestMotion],
    /// Sensors and drives of the machine.
    pub instruments: Instruments,
    /// Time on the session clock at which the compensation is set, s.
    pub set_at_s: f64,
}

impl Planning<'_> {
    /// Plans the compensation.
    ///
    /// # Errors
    /// If the model cannot be simulated on a motion, or the controller refuses a setting.
    pub fn plan(&self) -> Result<Plan, PredictionError> {
        self.check_capacity()?;
        let before = self.errors(&CompensationFile::none(self.model))?;
        let (mut best_um, mut choice) = self.start()?;
        let without = loop {
            let without = self.without_each(&choice)?;
            match without.iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((part, rms_um)) if *rms_um <= best_um * (1.0 - MIN_LOSS) => {
                    best_um = *rms_um;
                    choice.off.insert(part.clone());
                }
                _ => break without,
            }
        };
        // What is compensated together may be worse than nothing, and still better than without one of its parts.
        if best_um >= total_rms_um(&before) {
            choice.off.extend(self.parts());
        }
        let idle = self.without_effect(&choice)?;
        choice.off.extend(idle.iter().cloned());
        let mut file = self.file(&choice)?;
        let after = self.errors(&file)?;
        file.predicted = prediction::predictions(self.model, self.tests, [&before, &after], BOUND_PERCENT)?;
        let after_um = total_rms_um(&after);
        let without = without.into_iter().filter(|(part, _)| choice.has(part));
        let items = without.map(|(part, before_um)| self.item(&part, before_um, after_um)).collect();
        Ok(Plan { file, items, not_compensated: self.not_compensated(&choice.off, &idle) })
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

    /// All parts, with the best time of the velocity feed-forward and the better control law, and the contour error, µm rms.
    fn start(&self) -> Result<(f64, Choice), PredictionError> {
        let tick_s = 1.0 / self.model.rates().position_loop_hz();
        let laws = if self.parts().contains(&Part::Law) {
            vec![BTreeSet::new(), BTreeSet::from([Part::Law])]
        } else {
            vec![BTreeSet::new()]
        };
        let choices = laws
            .iter()
            .flat_map(|off| AHEAD_TICKS.map(|ticks| Choice { off: off.clone(), ahead_s: ticks * tick_s }));
        let choices: Vec<Choice> = choices.collect();
        let tried = choices.into_par_iter().map(|choice| Ok((self.rms_um(&choice)?, choice)));
        let tried: Vec<(f64, Choice)> = tried.collect::<Result<_, PredictionError>>()?;
        let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        Ok(best.unwrap_or((f64::INFINITY, Choice::default())))
    }

    /// Rms of the contour error over all motions, µm.
    fn rms_um(&self, choice: &Choice) -> Result<f64, PredictionError> {
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
            let is_compensated =
                |(_, effect): &(usize, &Effect)| matches!(treatment::of(effect), Treatment::Compensated(_));
            let effects = axis.effect.iter().enumerate().filter(is_compensated);
            parts.extend(effects.map(|(effect, _)| Part::Effect(index, effect)));
            if axis.settings.has_mass() {
                parts.push(Part::Force(index));
                parts.extend((!axis.settings.is_rigid()).then_some(Part::Stretch(index)));
            }
        }
        let is_below = |percent: Option<f64>| percent.is_none_or(|percent| percent < 100.0);
        if self.model.axis.values().any(|axis| is_below(axis.settings.controller.feedforward_percent)) {
            parts.push(Part::Feedforward);
        }
        if self.model.axis.values().any(|axis| axis.settings.controller.law == Some(Law::Hpc)) {
            parts.push(Part::Law);
        }
        parts
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
        axis.effect.retain(|_| {
            effect += 1;
            choice.has(&Part::Effect(index, effect - 1))
        });
        let parameters = AxisParameters::of(&axis);
        let travel_m = self.travel_m(index)?;
        let mut controller = ControllerChange::to_declared(&axis.settings, &parameters.servo);
        if choice.has(&Part::Feedforward) {
            let full = 100.0 - parameters.servo.feedforward.percent;
            controller.feedforward_percent = Some(full.clamp(0.0, 200.0));
            controller.feedforward_ahead_s = (choice.ahead_s > 0.0).then_some(choice.ahead_s);
            axis.settings.controller.feedforward_percent = Some(100.0);
        }
        if let (Some(resonance), Some(gain_per_s)) =
            (&parameters.tool.resonance, axis.settings.controller.position_gain_per_s)
        {
            controller.add_lead(
                gain_per_s * resonance.damping_ratio / (PI * resonance.frequency_hz),
                &axis.settings,
            );
        }
        let is_hpc = axis.settings.controller.law == Some(Law::Hpc);
        controller.law = (is_hpc && choice.has(&Part::Law)).then_some(Law::P);
        let (mut compensation, _) = tables::of_axis(&parameters, &names, travel_m, self.set_at_s);
        (compensation.ripple, _) = force::ripple(&parameters);
        let force = force::model(&parameters, &axis.settings, travel_m, self.set_at_s);
        let has_force = choice.has(&Part::Force(index));
        let has_stretch = choice.has(&Part::Stretch(index));
        if let Some(model) = force.filter(|_| has_force || has_stretch) {
            compensation.force = Some(shared::compensate::settings::ForceModel {
                share: if has_force { 1.0 } else { 0.0 },
                ..model
            });
            compensation.stretch_m_per_n = parameters
                .spring
                .as_ref()
                .filter(|_| has_stretch)
                .map(|spring| spring.stiffness_n_per_m.recip());
        }
        limit(&mut compensation, axis.settings.controller.force_limit_n);
        Ok((name, AxisCompensation { controller, compensation }))
    }

    /// The travel that the tables of an axis cover, m: its soft limits, or that of the motions and a little more.
    fn travel_m(&self, index: usize) -> Result<[f64; 2], PredictionError> {
        if let Some([from, to]) = self.model.axis[index].settings.limits.travel_mm {
            return Ok([1e-3 * from, 1e-3 * to]);
        }
        let mut travel_m = [f64::INFINITY, f64::NEG_INFINITY];
        for test in self.tests {
            let path = MachinePath::new(&test.motion, self.model, &test.source)?;
            let path = contour::NominalPath::of_blocks(&path.start_m, &path.blocks);
            let [from, to] = path.extent_m(index);
            travel_m = [travel_m[0].min(from), travel_m[1].max(to)];
        }
        // An axis that does not move still has tables, of 2 mm.
        let beyond_m = (BEYOND_TRAVEL * (travel_m[1] - travel_m[0])).max(1e-3);
        Ok([travel_m[0] - beyond_m, travel_m[1] + beyond_m])
    }

    /// Names of effect and axis of a part.
    pub(crate) fn names(&self, part: &Part) -> (String, String) {
        let axis = |index: usize| self.model.axis.get_index(index).map_or("", |(name, _)| name).to_owned();
        match *part {
            Part::Effect(index, effect) => {
                (self.model.axis[index].effect[effect].name().to_owned(), axis(index))
            }
            Part::Force(index) => ("force_feedforward".to_owned(), axis(index)),
            Part::Stretch(index) => ("stretch".to_owned(), axis(index)),
            Part::Feedforward => ("velocity_feedforward".to_owned(), String::new()),
            Part::Law => ("control_law".to_owned(), String::new()),
        }
    }

    fn item(&self, part: &Part, before_um: f64, after_um: f64) -> Item {
        let (effect, axis) = self.names(part);
        let does = match part {
            Part::Effect(index, effect) => &treatment::description(&self.model.axis[*index].effect[*effect]),
            Part::Force(_) => {
                "the force for the commanded acceleration, friction and load is added to the controller's"
            }
            Part::Stretch(_) => "the stretch of the drive under the modelled force is added to the command",
            Part::Feedforward => "Kf is set to 100 % on all axes",
            Part::Law => "P control takes the place of HPC, which filters the feed-forward, too",
        };
        Item { effect, axis, does: does.to_owned(), before_um, after_um }
    }

    fn not_compensated(&self, off: &BTreeSet<Part>, idle: &BTreeSet<Part>) -> Vec<NotCompensated> {
        let mut list = Vec::new();
        for (name, axis) in &self.model.axis {
            for effect in &axis.effect {
                if let Treatment::Not { why, instead } = treatment::of(effect) {
                    let (why, instead) = (why.to_owned(), instead.to_owned());
                    list.push(NotCompensated {
                        effect: effect.name().to_owned(),
                        axis: name.clone(),
                        why,
                        instead,
                    });
                }
            }
        }
        let with_tables = self.model.axis.iter().filter(|(_, axis)| !axis.empirical.is_empty());
        list.extend(with_tables.map(|(name, _)| NotCompensated {
            effect: "empirical".to_owned(),
            axis: name.clone(),
            why: "a table of a residual does not say what causes it, and holds for motions like those measured".to_owned(),
            instead: "find its cause; a table of the error over the position can be entered as a pitch_map".to_owned(),
        }));
        list.extend(off.iter().map(|part| {
            let (effect, axis) = self.names(part);
            let (why, instead) = if idle.contains(part) {
                NO_SETTING
            } else {
                (
                    "the simulated contour error is smaller without it",
                    "measure with motions that show it more",
                )
            };
            NotCompensated { effect, axis, why: why.to_owned(), instead: instead.to_owned() }
        }));
        list
    }
}

/// Bounds of corrections and force. A correction of 10 mm/s follows a reversal of some µm within a millisecond.
fn limit(compensation: &mut CompensationSettings, force_limit_n: Option<f64>) {
    compensation.position_bound_m = 1e-3;
    compensation.position_rate_m_per_s = 0.01;
    compensation.force_bound_n = force_limit_n.map_or(5000.0, |limit_n| (0.5 * limit_n).min(20_000.0));
    compensation.force_rate_n_per_s = 1e6;
}
