//! Step 6, the result: what was found, with what speaks against it, the faults of the data, and motions that tell more.

use super::certainty::{Doubted, doubted};
use super::distinguishing_motion::{Proposal, propose};
use super::identification::{AxisIdentification, Identification, better_machine};
use super::refuting_motion::Refutation;
use crate::data_faults::fault::{DataFault, FaultHandling};
use crate::input::signals::Signals;
use crate::judge::axis_findings::AxisFindings;
use crate::judge::findings::Findings;
use crate::options::TraceOptions;
use crate::repair::repaired::Repaired;
use model::machine::Machine;

/// The result of a trace from its repaired logs and its findings.
#[must_use]
pub fn identify(repaired: Repaired<'_>, findings: Findings) -> Identification {
    let Repaired { declared, signals: [fit_logs, validate_logs], faults, mut notes, .. } = repaired;
    let Findings { axes, notes: of_findings } = findings;
    notes.extend(of_findings);
    let better = better_machine(&declared.machine, axes.iter().map(|axis| (axis.axis.as_str(), &axis.model)));
    let of_axis = |(number, Doubted { findings, has_force_scale }): (usize, Doubted)| {
        let data_faults: Vec<DataFault> =
            faults.iter().filter(|fault| fault.axis == findings.axis).cloned().collect();
        let proposals = proposals(&better, (number, &findings), &fit_logs, &declared.options);
        let findings = with_reasons(findings, &data_faults);
        let refutations = refutations(&better, (number, &findings), &fit_logs, &declared.options);
        AxisIdentification { findings, data_faults, has_force_scale, proposals, refutations }
    };
    let axes = doubted(axes, &declared, &fit_logs).into_iter().enumerate().map(of_axis).collect();
    Identification { declared, axes, fit_logs, validate_logs, notes }
}

/// The motion that distinguishes each of the ambiguities of an axis best.
fn proposals(
    better: &Machine,
    (number, axis): (usize, &AxisFindings),
    fit_logs: &[Signals],
    options: &TraceOptions,
) -> Vec<Option<Proposal>> {
    let of_ambiguity = |ambiguity: &crate::search::ambiguity::Ambiguity| {
        let mut other = better.clone();
        if let Some(of_axis) = other.axis.get_mut(&axis.axis) {
            *of_axis = ambiguity.with_rival.axis.clone();
        }
        propose([better, &other], number, fit_logs, &options.admission)
    };
    axis.ambiguities.iter().map(of_ambiguity).collect()
}

/// The motion that would refute each law of an axis.
fn refutations(
    better: &Machine,
    (number, axis): (usize, &AxisFindings),
    fit_logs: &[Signals],
    options: &TraceOptions,
) -> Vec<Option<Refutation>> {
    axis.laws.iter().map(|law| Refutation::of(law, (better, number), fit_logs, options)).collect()
}

/// The findings in which missing channels that were logged, but could not be used, have their fault as the reason.
fn with_reasons(mut axis: AxisFindings, faults: &[DataFault]) -> AxisFindings {
    let removed = faults.iter().filter(|fault| fault.treatment == FaultHandling::Removed);
    for (fault, channel) in removed.filter_map(|fault| Some((fault, fault.channel?))) {
        let missing = format!("a {} channel", channel.word());
        let stated = format!("{missing} without the fault \"{}\"", fault.kind.name());
        let stages = axis.not_testable.iter_mut().map(|stage| &mut stage.needs);
        let effects = axis.effects_not_testable.iter_mut().map(|effect| &mut effect.needs);
        for needs in stages.chain(effects).filter(|needs| !needs.contains(&stated)) {
            *needs = needs.replace(&missing, &stated);
        }
    }
    axis
}
