//! Step 5, the judgement: [`judge`] takes the hypotheses on an axis, and returns those that its validation logs leave;
//! [`judge_together`] judges those of all axes.
//!
//! [`confirmation`] drops effects until none is at a limit and none is refuted. Each effect is tested twice: as it was added, and by
//! removing it from the final model ([`refutation`]). Both tests compare the [`likelihood`] of the validation logs. The remaining
//! effects are [`found_effect`]s. [`alignment`] says which names of the machine the measuring chain
//! imitates. Of long logs, [`mod@whole`] gives the values and residuals of all samples.

pub mod alignment;
pub mod axis_findings;
pub mod common_noise;
pub mod confirmation;
pub mod declared_value;
pub mod findings;
pub mod found_effect;
pub mod laws;
pub mod likelihood;
pub mod misfit;
pub mod not_testable;
pub mod of_axis;
pub mod of_machine;
pub mod refutation;
pub mod remainder;
pub mod resemblance;
pub mod tool_slopes;
pub mod whole;

pub use axis_findings::{AxisFindings, StageResidual};
pub use findings::Findings;
pub use of_axis::judge;
pub use of_machine::judge_together;
