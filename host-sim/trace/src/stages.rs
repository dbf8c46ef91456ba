//! Printed names and units of stages.

use files::log::Unit;
use model::effects::Stage;

/// Unit of a stage's residual: printed symbol, and suffix of a JSON key.
#[must_use]
pub const fn residual_unit(unit: Unit, stage: Stage) -> (&'static str, &'static str) {
    match (unit, stage) {
        (Unit::Millimetre, Stage::Force) => ("N", "n"),
        (Unit::Millimetre, _) => ("µm", "um"),
        (Unit::Degree, Stage::Force) => ("N·m", "nm"),
        (Unit::Degree, _) => ("mdeg", "mdeg"),
    }
}

/// Names of stages, joined by "and".
#[must_use]
pub fn stage_names(stages: &[Stage]) -> String {
    let name = |stage: &Stage| match stage {
        Stage::Motor => "motor",
        Stage::Table => "table",
        Stage::Tool => "tool",
        Stage::Force => "force",
    };
    stages.iter().map(name).collect::<Vec<_>>().join(" and ")
}
