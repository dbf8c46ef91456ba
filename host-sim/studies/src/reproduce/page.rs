//! The page of the published experiments: of each paper what came out, every figure, pictures, and notes.

use std::path::{Path, PathBuf};

use crate::reproduce::study::{Outcome, Picture, Reproduction, Study};
use files::output::OutputError;
use report::markup::{figure, key, list, mark, note, paragraph, section, text};
use report::number::significant;
use report::{page, write_page};

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(folder: &Path, reproduction: &Reproduction, said: &str) -> Result<PathBuf, OutputError> {
    write_page(folder, &html(reproduction, said))
}

/// The page; the sentence stands on top.
#[must_use]
pub fn html(reproduction: &Reproduction, said: &str) -> String {
    let sections: String = reproduction.studies.iter().map(study).collect();
    page("Published experiments, run again", &paragraph(said), &sections)
}

fn study(study: &Study) -> String {
    let said: String = study.findings.iter().map(|sentence| paragraph(sentence)).collect();
    let pictures: String = study.pictures.iter().map(picture).collect();
    let notes =
        if study.notes.is_empty() { String::new() } else { note("About the print:") + &list(&study.notes) };
    section(
        &format!("{}: {}", study.paper, study.title),
        &[said, table(&study.outcomes), pictures, notes].concat(),
    )
}

fn table(outcomes: &[Outcome]) -> String {
    let rows: String = outcomes.iter().map(row).collect();
    format!(
        "<table>\n<thead>\n<tr><th scope=\"col\">quantity</th><th class=\"n\" scope=\"col\">printed</th><th class=\"n\" \
         scope=\"col\">ours</th><th scope=\"col\">unit</th><th scope=\"col\">verdict</th></tr>\n</thead>\n<tbody>\n\
         {rows}</tbody>\n</table>\n"
    )
}

fn row(outcome: &Outcome) -> String {
    let verdict = if outcome.agrees() { "agrees" } else { "<strong>differs</strong>" };
    format!(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td><td>{verdict}</td></tr>\n",
        text(&outcome.quantity),
        text(&outcome.printed.label()),
        text(&significant(outcome.ours, 4)),
        text(outcome.unit),
    )
}

/// An entry of a legend: a mark where the class says so, a surface or a line otherwise.
fn entry(class: &str, meaning: &str) -> String {
    match class.strip_suffix(" mark") {
        Some(class) => mark(class, meaning),
        None => key(class, class == "before-range", meaning),
    }
}

fn picture(picture: &Picture) -> String {
    let keys: String = picture.legend.iter().map(|(class, meaning)| entry(class, meaning)).collect();
    let legend = if keys.is_empty() { String::new() } else { format!("<p class=\"legend\">{keys}</p>\n") };
    format!("<h3>{}</h3>\n{legend}{}", text(&picture.title), figure("", &picture.svg, &picture.caption))
}
