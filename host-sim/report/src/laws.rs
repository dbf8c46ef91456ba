//! Laws of residuals in sentences.

use files::format::significant;
use model::residual_law::Term;
use model::residual_table::TableVariable;
use trace::AxisIdentification;
use trace::analysis::law::{FoundLaw, FoundTerm};
use trace::stages::{residual_unit, stage_names};

/// A law: its equation, what it leaves on held-out motions, which of its terms are not certain, and which motion would refute it.
#[must_use]
pub fn sentence(axis: &AxisIdentification, law: &FoundLaw) -> String {
    let (unit, _) = residual_unit(axis.unit, law.stage);
    let [before, after] = [law.before, law.after].map(|rms| significant(rms.validate, 3));
    let doubts: Vec<String> = law.terms.iter().filter_map(|term| doubt(law, term)).collect();
    let doubts =
        if doubts.is_empty() { String::new() } else { format!(" Not certain: {}.", doubts.join("; ")) };
    format!(
        "{}, {}: the remaining residual follows the law {}; on held-out motions it leaves {after} of {before} {unit} rms. No effect of the \
         catalogue states its cause.{doubts} {}.",
        law.axis,
        stage_names(&[law.stage]),
        law.equation(axis.unit),
        refuted_by(law)
    )
}

/// Why a term is not certain.
fn doubt(law: &FoundLaw, term: &FoundTerm) -> Option<String> {
    if law.is_certain(term) {
        return None;
    }
    let form = law.form(&term.term);
    let why = if !term.rivals.is_empty() {
        let rivals: Vec<String> = term.rivals.iter().map(|rival| law.form(rival)).collect();
        format!("{} would fit as well", rivals.join(", "))
    } else if let Some(large) = &term.shadowed_by {
        format!("it may be what the form of the far larger {} lacks", law.form(large))
    } else if !term.is_in_all_folds {
        "a part of the logs alone does not show it".to_owned()
    } else {
        "more than twice the noise remains".to_owned()
    };
    Some(format!("{form} ({why})"))
}

/// The motion that would refute the law: one in which what it depends on is different.
fn refuted_by(law: &FoundLaw) -> String {
    let has = |is: fn(&TableVariable) -> bool| {
        law.terms.iter().any(|found| {
            let is_hysteresis = matches!(found.term, Term::Hysteresis { .. });
            !is_hysteresis && found.term.variables().iter().any(is)
        })
    };
    let mut motions = Vec::new();
    if has(|one| matches!(one, TableVariable::PositionMm | TableVariable::OtherPositionMm)) {
        motions.push("at another place of the travel");
    }
    if has(|one| {
        use TableVariable::{
            AccelerationMPerS2, OtherAccelerationMPerS2, OtherVelocityMPerS, SpeedMPerS, VelocityMPerS,
        };
        matches!(
            one,
            VelocityMPerS | SpeedMPerS | OtherVelocityMPerS | AccelerationMPerS2 | OtherAccelerationMPerS2
        )
    }) {
        motions.push("at another speed");
    }
    if motions.is_empty() {
        motions.push("with other distances between its reversals");
    }
    format!("A log of the same motion {} would refute it if it leaves more there", motions.join(", and one "))
}
