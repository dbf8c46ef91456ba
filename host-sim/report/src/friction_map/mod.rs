//! The page of a friction map: what was found, the law before and after, their residuals, and what was tried.

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
use pages::markup::{Column, list, note, number_cell, paragraph, section, table, text};
use sentences::{error_table, sentences, unexplained};

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
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
        "Friction map {}: {} runs at constant speed. Declared: Coulomb and viscous friction, the same both ways.",
        file_name(&map.source),
        map.runs.len()
    ));
    let errors = html! { pre { (text(&error_table(map, explanation).join("\n"))) } };
    let sections = html! {
        (section("What was found", &list(&sentences(map, explanation))))
        (section("Error before and after", &errors))
        (section("The map", &charts::charts(map, &explanation.selection)))
        (section("What was tried", &tried(&explanation.selection.rounds)))
        (section("What stays unexplained", &list(&unexplained(map, explanation, residual))))
    };
    pages::render(&format!("Friction of {}", file_name(&map.source)), &lead, &sections)
}

/// Every round with its terms.
fn tried(rounds: &[Round]) -> Markup {
    if rounds.is_empty() {
        return paragraph("Nothing could be tried.");
    }
    let columns = [
        Column::Words("term"),
        Column::Numbers("error of left-out runs"),
        Column::Numbers("of left-out ranges"),
        Column::Numbers("chance"),
        Column::Words("verdict"),
    ];
    html! {
        (note(
            "How the error (rms) of runs and of ranges of speed that were left out changes with each term, and the chance \
             that a law without it gives so much (F test, one trial).",
        ))
        @for (number, round) in (1..).zip(rounds) {
            h3 { "Round " (number) }
            (table(&columns, &rows(round)))
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

/// Change of an rms in percent for the fraction by which its square falls; a dash where that was not evaluated, or where
/// the change exceeds 1000 %.
fn rms_change(reduction: f64) -> String {
    // `clamp` keeps NaN, which `max` would replace.
    let change = 100.0 * ((1.0 - reduction).clamp(0.0, f64::MAX).sqrt() - 1.0);
    if change.is_finite() && change < 1000.0 { format!("{} %", fixed(change, 1)) } else { "–".to_owned() }
}

fn verdict(round: &Round, index: usize, candidate: &Candidate) -> &'static str {
    if round.added == Some(index) {
        "added"
    } else if candidate.is_supported(round.candidates.len()) {
        "supported, but less"
    } else if !candidate.is_physical {
        "would need friction below none"
    } else {
        "not supported"
    }
}
