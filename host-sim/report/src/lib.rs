//! The report: one page that says what was found, shows it, and says what was not.
//!
//! [`words`] puts effects into sentences, `parameters` into a few words; `tables` holds figures;
//! `polar` draws a circle as ballbar users do (`circle` finds one in a log, `deviation` is how
//! far the machine ran off it); `curves` draws residuals against time and against a `variable`,
//! those of `stages` before and after; `ranking` lists what was tried. `plot`, `markup` and
//! `number` are what these are made of. `doubts` says what speaks against a model or an effect. [`friction_map`] is the
//! page of a steady-state friction map. Pages of other studies are made of the same parts, in the crates of the
//! studies.
//!
//! The page needs nothing but itself: no script, no address. The same trace gives the same bytes.

mod circle;
mod curves;
mod deviation;
mod doubts;
pub mod friction_map;
pub mod markup;
pub mod number;
mod parameters;
pub mod plot;
pub mod polar;
pub mod ranking;
mod stages;
mod tables;
mod variable;
pub mod words;

use std::fs;
use std::path::{Path, PathBuf};

use files::output::{OutputError, write_whole};
use markup::{list, note, paragraph, section, text};
use model::effects::Effect;
use stages::AxisView;
use trace::Trace;
use trace::outcome::AxisTrace;

/// Name of the page in its folder.
pub const FILE_NAME: &str = "report.html";

/// Where it is written, if it is.
#[must_use]
pub fn file_in(folder: Option<&PathBuf>) -> Option<PathBuf> {
    folder.map(|folder| folder.join(FILE_NAME))
}

const STYLE: &str = include_str!("style.css");

/// What a report holds beside the trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extra {
    /// Heading of the page.
    pub title: String,
    /// Sentences that stand on top.
    pub lead: Vec<String>,
    /// The effects that the machine had in truth, each with its axis, where that is known.
    pub truth: Option<Vec<(String, Effect)>>,
}

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(folder: &Path, trace: &Trace, extra: &Extra) -> Result<PathBuf, OutputError> {
    write_page(folder, &html(trace, extra))
}

/// The page.
#[must_use]
pub fn html(trace: &Trace, extra: &Extra) -> String {
    let views = AxisView::all(trace);
    let lead: String = extra.lead.iter().map(|sentence| paragraph(sentence)).collect();
    let sections = [
        section("What was found", &found(trace, extra)),
        section("Residuals before and after", &tables::errors(&trace.axes)),
        section("The circle", &polar::body(trace, &views)),
        section("The residual of each stage", &curves::body(trace, &views)),
        section("What was tried", &ranking::body(&trace.axes)),
        section("What stays unexplained", &unexplained(&trace.axes, &trace.notes)),
    ]
    .concat();
    page(&extra.title, &format!("{lead}{}", note(&sources(trace))), &sections)
}

/// A page of its own: title in plain text, the rest as markup.
#[must_use]
pub fn page(title: &str, lead: &str, sections: &str) -> String {
    let title = text(title);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n<main>\n<header>\n<h1>{title}</h1>\n{lead}</header>\n{sections}</main>\n\
         </body>\n</html>\n"
    )
}

/// Writes a page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write_page(folder: &Path, html: &str) -> Result<PathBuf, OutputError> {
    let path = folder.join(FILE_NAME);
    fs::create_dir_all(folder).map_err(|cause| OutputError { path: folder.to_owned(), cause })?;
    write_whole(&path, |out| out.write_all(html.as_bytes()))?;
    Ok(path)
}

/// One sentence an effect, and the truth where it is known.
fn found(trace: &Trace, extra: &Extra) -> String {
    let of_axis = |axis: &AxisTrace| -> String {
        let class = if axis.found.is_empty() { " class=\"none\"" } else { "" };
        words::of_axis(axis).iter().map(|said| format!("<li{class}>{}</li>\n", text(said))).collect()
    };
    let items: String = trace.axes.iter().map(of_axis).collect();
    let truth = extra.truth.as_ref().map(|truth| tables::truth(&trace.axes, truth)).unwrap_or_default();
    format!("<ul class=\"found\">\n{items}</ul>\n{truth}")
}

/// What the logs that no fit saw take part in.
const DECIDES: &str = "One decision is made with what was held out: an effect that makes its residual larger is refuted, and left out of the model.";

/// Which logs were fitted and which were not.
fn sources(trace: &Trace) -> String {
    let names = |logs: &[trace::input::signals::Signals]| {
        logs.iter().map(|log| file_name(&log.source)).collect::<Vec<_>>().join(", ")
    };
    let (fit, validate) = (names(&trace.fit_logs), names(&trace.validate_logs));
    if fit == validate {
        format!(
            "Machine {}. Fitted to {fit}, judged on the last part of it, which no fit saw. {DECIDES}",
            trace.machine.name
        )
    } else {
        format!(
            "Machine {}. Fitted to {fit}; judged on {validate}, which no fit saw. {DECIDES}",
            trace.machine.name
        )
    }
}

/// What stays, what could not be tested, and what is down to noise.
fn unexplained(axes: &[AxisTrace], notes: &[String]) -> String {
    let stays: Vec<String> = axes
        .iter()
        .flat_map(|axis| {
            let rests = axis.unexplained.iter().map(|rest| words::remainder(axis, rest));
            let rests = words::open_ends(axis).into_iter().chain(rests);
            rests.chain(axis.not_testable.iter().map(|stage| words::not_testable(&axis.axis, stage)))
        })
        .collect();
    let is_explained = |axis: &AxisTrace, error: &trace::outcome::StageError| {
        const MOST: f64 = 1.5;
        let is_quiet = error.after.validate <= MOST * error.noise;
        is_quiet && !axis.unexplained.iter().any(|rest| rest.channel == error.stage)
    };
    let quiet: Vec<String> = axes
        .iter()
        .flat_map(|axis| {
            let explained = axis.errors.iter().filter(|error| is_explained(axis, error));
            explained.map(|error| format!("{} {}", axis.axis, trace::stages::stage_names(&[error.stage])))
        })
        .collect();
    let stays: Vec<String> = notes.iter().cloned().chain(stays).collect();
    let mut body = if stays.is_empty() { String::new() } else { list(&stays) };
    if !quiet.is_empty() {
        body += &paragraph(&format!("Down to the sensors' noise: {}.", quiet.join(", ")));
    }
    body
}

/// The last part of a path: where a log lay is nobody's business who reads the page.
#[must_use]
pub fn file_name(source: &str) -> &str {
    source.rsplit(['/', '\\']).next().unwrap_or(source)
}

#[cfg(test)]
mod tests;
