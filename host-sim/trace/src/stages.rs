//! Names and units of stages, for people.

use files::log::Unit;
use model::effects::Stage;

/// Unit of a stage's residual as it is printed, and as a key of the JSON ends.
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
