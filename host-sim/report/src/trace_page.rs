//! The page of a trace: verdict, error budget, limits and circumstances; then effects found, plots, and what is not explained; folded away,
//! how it was found.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use super::axis_view::{AxisView, is_at_noise};
use super::before_after::{self, RoundTripMotion};
use super::certificate::{self, Circumstances};
use super::{budget_page, circle_plots, laws, ranking, residual_plots, sentences, tables};
use budget::Budget;
use budget::limits::Judgement;
use contour::log_error::LogError;
use files::output::OutputError;
use model::effects::Effect;
use pages::markup::{folded, list, note, paragraph, section, text};
use trace::AxisIdentification;
use trace::Identification;
use trace::stages::stage_names;

/// Additional content of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extra {
    /// Heading of the page.
    pub title: String,
    /// Sentences above the sections.
    pub lead: Vec<String>,
    /// The true effects of the machine, each with its axis, if they are known.
    pub truth: Option<Vec<(String, Effect)>>,
    /// Contour errors of the logs.
    pub contour_errors: Vec<LogError>,
    /// What each cause costs at the tool.
    pub budget: Option<Budget>,
    /// Limits with pass, fail or unknown.
    pub limits: Vec<Judgement>,
    /// Serial number, operator, date and command line.
    pub circumstances: Circumstances,
    /// Motions before and after a compensation, with a sentence about them.
    pub round_trip: (Vec<RoundTripMotion>, String),
}

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, trace: &Identification, extra: &Extra) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(trace, extra))
}

/// The page. The same trace gives the same bytes.
#[must_use]
pub fn html(trace: &Identification, extra: &Extra) -> String {
    let views = AxisView::all(trace);
    let lead = html! {
        p.verdict { (text(&certificate::verdict(trace, extra.budget.as_ref(), &extra.limits))) }
        @for sentence in &extra.lead { (paragraph(sentence)) }
    };
    let sections = html! {
        @if let Some(budget) = &extra.budget { (budget_page::sections(budget)) }
        (section("Limits", &certificate::limits(&extra.limits)))
        (section("Machine and logs", &certificate::circumstances(trace, &extra.circumstances)))
        (section("Effects found", &found(trace, extra)))
        (section("Residuals before and after", &tables::errors(trace.axes())))
        (section("Contour error", &tables::contour_errors(&extra.contour_errors)))
        (section("Before and after the compensation", &before_after::round_trip(&extra.round_trip.0, &extra.round_trip.1)))
        (section("The circle", &circle_plots::body(trace, &views)))
        (section("The residual of each stage", &residual_plots::body(trace, &views)))
        (section("Unexplained residuals", &unexplained(trace.axes(), trace.notes())))
        (folded("How was this found?", &way(trace.axes())))
    };
    pages::render(&extra.title, &lead, &sections)
}

/// One sentence for each effect, and the truth if it is known.
fn found(trace: &Identification, extra: &Extra) -> Markup {
    html! {
        ul.found {
            @for sentence in sentences::data_faults(trace) { li.none { (text(&sentence)) } }
            @for axis in trace.axes() {
                @for sentence in sentences::of_axis(axis, extra.budget.as_ref()) {
                    li class=[axis.found.is_empty().then_some("none")] { (text(&sentence)) }
                }
            }
        }
        @if let Some(truth) = &extra.truth { (tables::truth(trace.axes(), truth)) }
    }
}

/// The only decision that uses the validation logs.
const VALIDATION_DECIDES: &str = "The held-out data are used for one decision only: an effect that increases their \
                                  residual is refuted and left out of the model.";

/// The candidates of each round, and what was refused.
fn way(axes: &[AxisIdentification]) -> Markup {
    let refused = axes
        .iter()
        .flat_map(|axis| sentences::refused_of_axis(axis).into_iter().chain(ranking::refused(axis)));
    let refused: Vec<String> = refused.collect();
    html! {
        (note(VALIDATION_DECIDES))
        @if !refused.is_empty() { (section("Refused", &list(&refused))) }
        (section("Candidates tested", &ranking::body(axes)))
    }
}

/// Remaining residuals, stages that could not be evaluated, and residuals at noise level.
fn unexplained(axes: &[AxisIdentification], notes: &[String]) -> Markup {
    let of_axis = |axis: &AxisIdentification| {
        let remainders = axis.unexplained.iter().map(|entry| sentences::remainder(axis, entry));
        let remainders =
            remainders.chain(axis.laws_with_motions().map(|(law, motion)| laws::sentence(axis, law, motion)));
        let not_testable = axis.not_testable.iter().map(|stage| sentences::not_testable(&axis.axis, stage));
        sentences::open_ends(axis).into_iter().chain(remainders).chain(not_testable).collect::<Vec<_>>()
    };
    let remaining: Vec<String> = notes.iter().cloned().chain(axes.iter().flat_map(of_axis)).collect();
    let explained: Vec<String> = axes.iter().flat_map(explained_stages).collect();
    html! {
        @if !remaining.is_empty() { (list(&remaining)) }
        @if !explained.is_empty() {
            (paragraph(&format!("Residuals at sensor-noise level: {}.", explained.join(", "))))
        }
    }
}

/// Axis and name of each stage whose residual is at noise level.
fn explained_stages(axis: &AxisIdentification) -> Vec<String> {
    let explained = axis.residuals.iter().filter(|error| is_at_noise(axis, error));
    explained.map(|error| format!("{} {}", axis.axis, stage_names(&[error.stage]))).collect()
}
