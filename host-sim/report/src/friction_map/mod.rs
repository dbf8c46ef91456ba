//! The page of a friction map: terms found, the law before and after, their residuals, and the candidates tested.

mod charts;
pub mod sentences;

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::output::OutputError;
use friction_map::explain::Explanation;
use friction_map::map::FrictionMap;
use friction_map::residual_analysis::Residual;
use friction_map::selection::{Candidate, Round};

use files::format::{fixed, percent};
use pages::file_name;
use pages::markup::{Column, list, note, number_cell, paragraph, preformatted, section, table, text};
use sentences::{error_table, sentences, unexplained};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(
    folder: &Path,
    map: &FrictionMap,
    explanation: &Explanation,
    residual: Option<&Residual>,
) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(map, explanation, residual))
}

/// The page.
#[must_use]
pub fn html(map: &FrictionMap, explanation: &Explanation, residual: Option<&Residual>) -> String {
    let lead = note(&format!(
        "Friction map {}: {} runs at constant speed. Declared: Coulomb and viscous friction, equal in both \
         directions.",
        file_name(&map.source),
        map.runs.len()
    ));
    let errors = preformatted("Error before and after", &error_table(map, explanation).join("\n"));
    let sections = html! {
        (section("Terms found", &list(&sentences(map, explanation))))
        (section("Error before and after", &errors))
        (section("The map", &charts::charts(map, &explanation.selection)))
        (section("Candidates tested", &tried(&explanation.selection.rounds)))
        (section("Unexplained residuals", &list(&unexplained(map, explanation, residual))))
    };
    pages::render(&format!("Friction of {}", file_name(&map.source)), &lead, &sections)
}

/// Every round with its terms.
fn tried(rounds: &[Round]) -> Markup {
    if rounds.is_empty() {
        return paragraph("No candidate could be tested.");
    }
    let columns = [
        Column::Words("term"),
        Column::Numbers("error of left-out runs"),
        Column::Numbers("error of left-out ranges"),
        Column::Numbers("p value"),
        Column::Words("verdict"),
    ];
    html! {
        (note(
            "Change of the rms error of left-out runs and of left-out ranges of speed with each term, and p value \
             of the term (F test of a single trial).",
        ))
        @for (number, round) in (1..).zip(rounds) {
            h3 { "Round " (number) }
            (table(&format!("Terms tried in round {number}"), &columns, &rows(round)))
        }
    }
}

fn rows(round: &Round) -> Markup {
    html! {
        @for (i, candidate) in round.candidates.iter().enumerate() {
            tr {
                th scope="row" { (text(candidate.term.description())) }
                (number_cell(&rms_change(candidate.reduction)))
                (number_cell(&rms_change(candidate.range_reduction)))
                (number_cell(&percent(100.0 * candidate.p_value)))
                td { (verdict(round, i, candidate)) }
            }
        }
    }
}

/// Change of an rms in percent for the fraction by which its square falls; a dash if it was not evaluated or the
/// change exceeds 1000 %.
fn rms_change(reduction: f64) -> String {
    // `clamp` keeps NaN, which `max` would replace.
    let change = 100.0 * ((1.0 - reduction).clamp(0.0, f64::MAX).sqrt() - 1.0);
    if change.is_finite() && change < 1000.0 { format!("{} %", fixed(change, 1)) } else { "–".to_owned() }
}

fn verdict(round: &Round, index: usize, candidate: &Candidate) -> &'static str {
    if round.added == Some(index) {
        "added"
    } else if candidate.is_supported(round.candidates.len()) {
        "supported, but another term is better"
    } else if !candidate.is_physical {
        "requires negative friction"
    } else {
        "not supported"
    }
}
