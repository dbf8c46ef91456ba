//! The page of a self-test: sentences, the confusion matrix, the parameters, the cases that went wrong.

use std::path::{Path, PathBuf};

use report::markup::{figure, key, note, paragraph, section, text};
use report::number::fixed;
use report::{page, write_page};

use crate::score::Outcome;
use crate::summary::Summary;
use crate::words;
use crate::{confusion_table, strip};
use files::output::OutputError;

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(
    folder: &Path,
    said: &[String],
    outcomes: &[Outcome],
    summary: &Summary,
) -> Result<PathBuf, OutputError> {
    write_page(folder, &html(said, outcomes, summary))
}

/// The page; the sentences stand on top.
#[must_use]
pub fn html(said: &[String], outcomes: &[Outcome], summary: &Summary) -> String {
    let lead: String = said.iter().map(|sentence| paragraph(sentence)).collect();
    let sections = [
        section("What was taken for what", &matrix(summary)),
        section("Parameters", &parameters(summary)),
        section("Residuals on logs that were not fitted", &residuals(summary)),
        section("Cases that went wrong", &wrong(outcomes)),
    ]
    .concat();
    page("Machines drawn at random, traced blind", &lead, &sections)
}

fn matrix(summary: &Summary) -> String {
    let picture = confusion_table::picture(&summary.confusion);
    if picture.is_empty() {
        return picture;
    }
    let what = "Rows: the effects that were there; columns: what was found. A false effect is put down to what was \
                missed on its axis, or else to nothing. Unexplained: an effect from outside the catalogue that the \
                trace describes by what it follows.";
    let legend = [key("hit", true, "as it is"), key("slip", true, "mistaken or missed")].concat();
    format!("{}<p class=\"legend\">{legend}</p>\n{}", note(what), figure("", &picture, ""))
}

fn parameters(summary: &Summary) -> String {
    let picture = strip::picture(&summary.parameters);
    if picture.is_empty() {
        return picture;
    }
    let what = "Left: error of each found parameter, percent of the truth; the stroke is the median. Right: share of the \
                truths inside the 95 % confidence intervals, with its own 95 % interval. Periods follow from the lead and \
                are left out.";
    format!("{}{}", note(what), figure("", &picture, ""))
}

fn residuals(summary: &Summary) -> String {
    let rows: String = summary
        .ratios
        .iter()
        .filter(|(_, spread)| spread.count > 0)
        .map(|(channel, spread)| {
            let cell = |said: String| format!("<td class=\"n\">{}</td>", text(&said));
            let cells =
                [cell(spread.count.to_string()), cell(fixed(spread.median, 2)), cell(fixed(spread.most, 2))];
            format!("<tr><th scope=\"row\">{channel}</th>{}</tr>\n", cells.concat())
        })
        .collect();
    if rows.is_empty() {
        return rows;
    }
    format!(
        "{}<table>\n<thead>\n<tr><th scope=\"col\">channel</th><th class=\"n\" scope=\"col\">logs of axes</th><th \
         class=\"n\" scope=\"col\">median</th><th class=\"n\" scope=\"col\">95 % below</th></tr>\n</thead>\n<tbody>\n{rows}\
         </tbody>\n</table>\n",
        note("Root mean square after the last effect over that of the sensors' noise.")
    )
}

fn wrong(outcomes: &[Outcome]) -> String {
    let row = |outcome: &Outcome| {
        let (there, found) = words::sets(outcome);
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td></tr>\n",
            outcome.number,
            text(&there),
            text(&found)
        )
    };
    let rows: String = outcomes.iter().filter(|outcome| !words::is_right(outcome)).map(row).collect();
    if rows.is_empty() {
        return paragraph("None.");
    }
    format!(
        "<table>\n<thead>\n<tr><th scope=\"col\">case</th><th scope=\"col\">there was</th><th scope=\"col\">found</th></tr>\n\
         </thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}
