//! The page of a friction map: what was found, the law before and after, their residuals, and what was tried.

mod charts;
pub mod sentences;

use std::path::{Path, PathBuf};

use files::output::OutputError;
use friction_map::explain::Explanation;
use friction_map::map::FrictionMap;
use friction_map::residual_analysis::Residual;
use friction_map::selection::{Candidate, Round};

use crate::markup::{list, note, paragraph, section, text};
use crate::number::{fixed, percent};
use crate::{file_name, page, write_page};
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
    write_page(folder, &html(map, explanation, residual))
}

/// The page.
#[must_use]
pub fn html(map: &FrictionMap, explanation: &Explanation, residual: Option<&Residual>) -> String {
    let lead = note(&format!(
        "Friction map {}: {} runs at constant speed. Declared: Coulomb and viscous friction, the same both ways.",
        file_name(&map.source),
        map.runs.len()
    ));
    let errors = format!("<pre>{}</pre>\n", text(&error_table(map, explanation).join("\n")));
    let sections = [
        section("What was found", &list(&sentences(map, explanation))),
        section("Error before and after", &errors),
        section("The map", &charts::charts(map, &explanation.selection)),
        section("What was tried", &tried(&explanation.selection.rounds)),
        section("What stays unexplained", &list(&unexplained(map, explanation, residual))),
    ]
    .concat();
    page(&format!("Friction of {}", file_name(&map.source)), &lead, &sections)
}

/// Every round with its terms.
fn tried(rounds: &[Round]) -> String {
    if rounds.is_empty() {
        return paragraph("Nothing could be tried.");
    }
    let head = "<table>\n<thead><tr><th scope=\"col\">term</th><th class=\"n\" scope=\"col\">error of left-out runs</th>\
                <th class=\"n\" scope=\"col\">of left-out ranges</th><th class=\"n\" scope=\"col\">chance</th>\
                <th scope=\"col\">verdict</th></tr></thead>\n";
    let mut body = note(
        "How the error (rms) of runs and of ranges of speed that were left out changes with each term, and the chance \
         that a law without it gives so much (F test, one trial).",
    );
    for (number, round) in rounds.iter().enumerate() {
        let rows: String = (0..round.candidates.len()).map(|index| row(round, index)).collect();
        body += &format!("<h3>Round {}</h3>\n{head}<tbody>\n{rows}</tbody>\n</table>\n", number + 1);
    }
    body
}

fn row(round: &Round, index: usize) -> String {
    let candidate = &round.candidates[index];
    format!(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
         <td>{}</td></tr>\n",
        text(candidate.term.description()),
        rms_change(candidate.reduction),
        rms_change(candidate.range_reduction),
        percent(100.0 * candidate.p_value),
        verdict(round, index, candidate),
    )
}

/// Change of an rms in percent for the fraction by which its square falls; a dash where that was not evaluated or makes
/// it ten times larger or more.
fn rms_change(reduction: f64) -> String {
    // `clamp` keeps NaN, `max` would not.
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
