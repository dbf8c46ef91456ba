//! What a trace found.

use super::axis_findings::AxisFindings;

/// What a trace found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The axes, in the order of the machine file.
    pub axes: Vec<AxisFindings>,
    /// Sentences on stretches of long logs whose residuals are far above those of the others.
    pub notes: Vec<String>,
}
