//! Laws of residuals in sentences.

use files::format::{fixed, percent, significant, with_spread};
use model::residual_law::Term;
use model::residual_table::TableVariable;
use trace::AxisIdentification;
use trace::analysis::law::equation::variable_unit;
use trace::analysis::law::{FoundLaw, FoundTerm, Resemblance};
use trace::result::refuting_motion::{Instant, Prediction, Refutation};
use trace::stages::{residual_unit, stage_names};

/// A law: its equation, what it leaves on held-out motions, which of its terms are not certain, and which motion would refute it.
#[must_use]
pub fn sentence(axis: &AxisIdentification, law: &FoundLaw, motion: Option<&Refutation>) -> String {
    let (unit, _) = residual_unit(axis.unit, law.stage);
    let [before, after] = [law.before, law.after].map(|rms| significant(rms.validate, 3));
    let doubts: Vec<String> = law.terms.iter().filter_map(|term| doubt(law, term)).collect();
    let doubts =
        if doubts.is_empty() { String::new() } else { format!(" Not certain: {}.", doubts.join("; ")) };
    format!(
        "{}, {}: the remaining residual follows the law {}; on held-out motions it leaves {after} of {before} {unit} rms.{doubts} \
         {}. {}.",
        law.axis,
        stage_names(&[law.stage]),
        law.equation(axis.unit),
        resemblance(law),
        refuted_by(axis, law, motion)
    )
}

/// The effects of the catalogue that a law resembles.
fn resemblance(law: &FoundLaw) -> String {
    let name = |one: &Resemblance| one.effect.replace('_', " ");
    let share = |one: &Resemblance| percent(100.0 * one.share);
    let Some(best) = law.resembles.first() else {
        return "No effect of the catalogue describes a part of it".to_owned();
    };
    if best.share < Resemblance::MIN_SHARE {
        return format!(
            "No effect of the catalogue describes half of its values, the best one, {}, {}",
            name(best),
            share(best)
        );
    }
    let all: Vec<String> =
        law.resembles.iter().map(|one| format!("{} ({})", name(one), share(one))).collect();
    format!(
        "It resembles {}, by the share of its values that each describes; that is no cause",
        all.join(", ")
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
    } else if let Some(effect) = term.beside_ambiguous {
        format!(
            "it depends on what the {} does, which the logs do not tell from another effect",
            effect.replace('_', " ")
        )
    } else if !term.is_in_all_folds {
        "a part of the logs alone does not show it".to_owned()
    } else {
        "more than twice the noise remains".to_owned()
    };
    Some(format!("{form} ({why})"))
}

/// The motion that would refute the law, and what the law predicts there.
fn refuted_by(axis: &AxisIdentification, law: &FoundLaw, motion: Option<&Refutation>) -> String {
    let Some(Refutation { how, prediction, .. }) = motion else {
        return "A log in which the axes move would tell more of it".to_owned();
    };
    let Some(Prediction { instants: [from, to], change, half_width, tolerance }) = prediction else {
        return format!(
            "A log of {how} would refute it if the law leaves more there (--propose writes the motion file)"
        );
    };
    let (unit, _) = residual_unit(axis.unit, law.stage);
    let [from, to] = [from, to].map(|instant| at(axis, law, instant));
    let [least, most] = [change - tolerance, change + tolerance].map(|value| significant(value, 3));
    format!(
        "A log of {how} would refute it (--propose writes the motion file): from {from} to {to} it predicts a change of {} {unit}, and a \
         measured change below {least} or above {most} {unit} refutes it",
        with_spread(*change, *half_width)
    )
}

/// An instant by its time and by the variables of the law.
fn at(axis: &AxisIdentification, law: &FoundLaw, instant: &Instant) -> String {
    let value = |&(variable, value): &(TableVariable, f64)| {
        let unit = variable_unit(variable, axis.unit).map_or_else(String::new, |unit| format!(" {unit}"));
        let product = Term::Product { of: vec![variable], coefficient: 1.0 };
        format!("{} = {}{unit}", law.form(&product), significant(value, 3))
    };
    let values: Vec<String> = instant.values.iter().map(value).collect();
    format!("{} s ({})", fixed(instant.at_s, 2), values.join(", "))
}
