//! The result of a trace.

use std::ops::Deref;

use super::certainty::is_certain;
use super::distinguishing_motion::Proposal;
use super::refuting_motion::Refutation;
use crate::analysis::law::FoundLaw;
use crate::data_faults::DataFault;
use crate::fit::axis_model::AxisModel;
use crate::fit::declared_machine::DeclaredMachine;
use crate::fit::fit_data::FitData;
use crate::input::signals::Signals;
use crate::judge::axis_findings::{AxisFindings, StageResidual};
use crate::options::TraceOptions;
use crate::search::ambiguity::Ambiguity;
use model::effects::{Effect, Stage};
use model::machine::Machine;
use model::machine::evidence::{Certainty, Evidence};
use model::machine::nominal::LogOffsets;

/// The result of a trace: the effects that a machine shows in its logs and that its declared model lacks.
#[derive(Clone, Debug)]
pub struct Identification {
    pub(super) declared: DeclaredMachine,
    pub(super) axes: Vec<AxisIdentification>,
    pub(super) fit_logs: Vec<Signals>,
    pub(super) validate_logs: Vec<Signals>,
    pub(super) notes: Vec<String>,
}

/// The result for one axis: what was found, and what speaks against it. The findings are read as if they were its own.
#[derive(Clone, Debug)]
pub struct AxisIdentification {
    pub(super) findings: AxisFindings,
    /// Faults of its data, found before any fit.
    pub data_faults: Vec<DataFault>,
    /// Whether the scale of the logged force may be wrong, instead of masses, stiffness, friction and the gain of the loop.
    pub has_force_scale: bool,
    pub(super) proposals: Vec<Option<Proposal>>,
    pub(super) refutations: Vec<Option<Refutation>>,
}

impl Deref for AxisIdentification {
    type Target = AxisFindings;

    fn deref(&self) -> &AxisFindings {
        &self.findings
    }
}

impl AxisIdentification {
    /// What is known of effects of the axis: of those that were found, and of those that its machine file had, what it said.
    fn evidence(&self, effects: &[Effect]) -> Vec<Evidence> {
        let of = |effect: &Effect| {
            let declared = Evidence { effect: effect.name().to_owned(), ..Evidence::default() };
            let Some(found) = self.found.iter().find(|found| found.effect.is_same(effect)) else {
                let known = self.baseline.axis.evidence.iter().zip(&self.baseline.axis.effect);
                let known = known.into_iter().find(|(_, other)| other.is_same(effect));
                return known.map_or(declared, |(evidence, _)| evidence.clone());
            };
            let is_certain = is_certain(self, found);
            Evidence {
                certainty: if is_certain { Certainty::Certain } else { Certainty::Ambiguous },
                half_widths: found
                    .half_widths
                    .iter()
                    .map(|half| if half.is_finite() { *half } else { 0.0 })
                    .collect(),
                rivals: found.rival_names().into_iter().map(str::to_owned).collect(),
                decided_by: found.imitations.iter().map(|one| one.decided_by.to_owned()).collect(),
                alternatives: self.alternatives(&found.effect),
                ..declared
            }
        };
        effects.iter().map(of).collect()
    }

    /// The rivals of a found effect that another motion may decide, as fitted in its place.
    fn alternatives(&self, found: &Effect) -> Vec<Effect> {
        let of_found = self.ambiguities.iter().filter(|one| one.added.is_same(found));
        let fitted = |one: &Ambiguity| {
            let of_rival = one.with_rival.axis.effect.iter().find(|effect| effect.is_same(&one.rival));
            of_rival.cloned()
        };
        of_found.filter_map(fitted).collect()
    }

    /// What the model leaves of the positions from the command to the tool where it stands out of the noise, µm rms without the noise: each
    /// stage is predicted from the measured one before, so that their squares add. On the validation logs, if there are any.
    fn unexplained_um(&self, is_validated: bool) -> Option<f64> {
        let is_unexplained = |of: &&StageResidual| {
            of.stage != Stage::Force && self.unexplained.iter().any(|left| left.stage == of.stage)
        };
        let square_um2 = |of: &StageResidual| {
            let rms_um = if is_validated { of.after.validate } else { of.after.fit };
            (rms_um.powi(2) - of.noise.powi(2)).max(0.0)
        };
        let sum_um2: f64 = self.residuals.iter().filter(is_unexplained).map(square_um2).sum();
        (sum_um2 > 0.0 && sum_um2.is_finite()).then(|| sum_um2.sqrt())
    }

    /// Pairs of effects that the logs do not distinguish, with a motion that does; without one if the machine file does not suffice to
    /// simulate it.
    pub fn ambiguities_with_motions(&self) -> impl Iterator<Item = (&Ambiguity, Option<&Proposal>)> {
        self.ambiguities.iter().zip(self.proposals.iter().map(Option::as_ref))
    }

    /// The laws of the axis, each with a motion that would refute it; without one if the axes do not move in the fitted logs.
    pub fn laws_with_motions(&self) -> impl Iterator<Item = (&FoundLaw, Option<&Refutation>)> {
        self.laws.iter().zip(self.refutations.iter().map(Option::as_ref))
    }
}

impl Identification {
    /// The axes, in the order of the machine file.
    #[must_use]
    pub fn axes(&self) -> &[AxisIdentification] {
        &self.axes
    }

    /// The logs that were fitted.
    #[must_use]
    pub fn fit_logs(&self) -> &[Signals] {
        &self.fit_logs
    }

    /// The logs that were held out.
    #[must_use]
    pub fn validate_logs(&self) -> &[Signals] {
        &self.validate_logs
    }

    /// The declared machine.
    #[must_use]
    pub const fn machine(&self) -> &Machine {
        &self.declared.machine
    }

    /// The thresholds of the trace.
    #[must_use]
    pub const fn options(&self) -> &TraceOptions {
        &self.declared.options
    }

    /// Sentences on logs that were shortened or thinned, and on missing or excluded data.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The effects found, as `axis: name`.
    #[must_use]
    pub fn found_names(&self) -> Vec<String> {
        let all = self.axes.iter().flat_map(|axis| axis.found.iter().map(move |found| (axis, found)));
        all.map(|(axis, found)| format!("{}: {}", axis.axis, found.effect.name())).collect()
    }

    /// The machine with fitted values and with the effects found.
    #[must_use]
    pub fn better_machine(&self) -> Machine {
        let models = self.axes.iter().map(|axis| (axis.axis.as_str(), &axis.model));
        let mut better = better_machine(&self.declared.machine, models);
        for axis in &self.axes {
            if let Some(written) = better.axis.get_mut(&axis.axis) {
                written.evidence = axis.evidence(&written.effect);
                let unexplained_um = axis.unexplained_um(!self.validate_logs.is_empty());
                let offsets = LogOffsets { unexplained_um, ..written.log_offsets.unwrap_or_default() };
                written.log_offsets = (offsets != LogOffsets::default()).then_some(offsets);
            }
        }
        better
    }

    /// The data of one axis, by its index, in these logs.
    #[must_use]
    pub fn data<'a>(&'a self, logs: &'a [Signals], axis: usize) -> FitData<'a> {
        self.declared.data(logs, axis)
    }
}

/// A machine with the models of axes, by their names, in place of its declared ones.
pub(super) fn better_machine<'a>(
    declared: &Machine,
    models: impl Iterator<Item = (&'a str, &'a AxisModel)>,
) -> Machine {
    // The effects found include the influence of the bodies on an axis. With the structure, it would act twice.
    let mut machine = Machine { structure: None, ..declared.clone() };
    for (name, model) in models {
        if let Some(axis) = machine.axis.get_mut(name) {
            *axis = model.written();
        }
    }
    machine
}
