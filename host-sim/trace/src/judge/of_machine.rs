//! Step 5, the judgement of all axes together.

use super::alignment;
use super::axis_findings::AxisFindings;
use super::findings::Findings;
use super::whole::refinement::with_all_samples;
use crate::repair::repaired::Repaired;
use crate::task::Job;

/// Judges what was found of each axis by that of the others, with the values and residuals of all samples.
#[must_use]
pub fn judge_together(job: &Job<'_>, repaired: &Repaired<'_>, axes: Vec<AxisFindings>) -> Findings {
    let searched = Findings { axes, notes: Vec::new() };
    let Findings { axes, notes } = with_all_samples(job, repaired, searched);
    Findings { axes: alignment::decide(&repaired.signals[0], axes, &job.options.search, job.progress), notes }
}
