//! The page of `positions`: the sentence, the figures, the deviation over position with its 2s band, what it is made of, what is left.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::format::fixed;
use files::output::OutputError;
use pages::file_name;
use pages::markup::{
    Column, figure, legend, line_entry, list, note, number_cell, paragraph, point_entry, section,
    surface_entry, table, text, words_cell,
};
use pages::plot::{Chart, Ink, Layer};
use positions::Analysis;
use positions::effect::Effect;
use positions::measured::Way;
use positions::text::{cells, figure_remarks, figure_rows, figure_um, floor, residual_rows, sentence};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, analysis: &Analysis) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(analysis))
}

/// The page. The same result gives the same bytes.
#[must_use]
pub fn html(analysis: &Analysis) -> String {
    let sections = html! {
        (section("Figures after ISO 230-2", &figures(analysis)))
        (section("Deviation over position", &measured(analysis)))
        (section("What it is made of", &effects(&analysis.effects)))
        (section("What is left", &left(analysis)))
        (section("From run to run", &runs(analysis)))
        (section("What was assumed", &notes(&analysis.notes)))
    };
    let lead = paragraph(&sentence(analysis));
    pages::render(&format!("Positions: {}", file_name(&analysis.test.source)), &lead, &sections)
}

fn figures(analysis: &Analysis) -> Markup {
    let columns = [Column::Words("µm"), Column::Numbers("both"), Column::Numbers("↑"), Column::Numbers("↓")];
    let rows = html! {
        @for (name, values) in figure_rows(analysis) {
            tr { th scope="row" { (name) } @for um in &values { (number_cell(um)) } }
        }
    };
    html! { (table("Figures after ISO 230-2", &columns, &rows)) (list(&figure_remarks(analysis))) }
}

fn notes(notes: &[String]) -> Markup {
    if notes.is_empty() { Markup::default() } else { list(notes) }
}

const fn ink(way: Way) -> Ink {
    match way {
        Way::Positive => Ink::Third,
        Way::Negative => Ink::Fourth,
    }
}

/// The legend of those directions in which a target was approached: class and words of an entry.
fn approached<'a>(analysis: &Analysis, words: [&'a str; 2]) -> Vec<(&'static str, &'a str)> {
    let is_there = |way: Way| analysis.test.readings.iter().any(|reading| reading.way == way);
    let entries = Way::BOTH.into_iter().zip(["cw", "ccw"]).zip(words);
    entries.filter(|((way, _), _)| is_there(*way)).map(|((_, class), words)| (class, words)).collect()
}

/// Points that no line joins.
fn points(ink: Ink, all: impl Iterator<Item = (f64, f64)>) -> Vec<Layer> {
    all.map(|point| Layer { ink, points: vec![point], is_marked: true }).collect()
}

/// The classic picture: runs as points, means as lines, and the band of two standard deviations about them, in both directions.
fn measured(analysis: &Analysis) -> Markup {
    let (mut bands, mut lines) = (Vec::new(), Vec::new());
    for (way, index) in Way::BOTH.into_iter().zip(0..) {
        let approaches =
            || analysis.positions.iter().filter_map(move |at| Some((at.target_mm, at.ways[index]?)));
        let edge = |sign: f64| {
            approaches().filter_map(move |(mm, at)| Some((mm, at.mean_um + sign * 2.0 * at.deviation_um?)))
        };
        let outline: Vec<(f64, f64)> =
            edge(1.0).chain(edge(-1.0).collect::<Vec<_>>().into_iter().rev()).collect();
        if outline.len() > 3 {
            bands.push(Layer { ink: Ink::Noise, points: outline, is_marked: false });
        }
        let means = approaches().map(|(mm, at)| (mm, at.mean_um)).collect();
        lines.push(Layer { ink: ink(way), points: means, is_marked: false });
        let readings = analysis.test.readings.iter().filter(move |reading| reading.way == way);
        lines.extend(points(ink(way), readings.map(|reading| (reading.target_mm, reading.deviation_um))));
    }
    let chart = Chart {
        size: (960, 320),
        title: "Deviation over position",
        description: "Each reading, the means in both directions, and two standard deviations about them.",
        x: "target, mm",
        y: "deviation, µm",
        noise: Some(0.0),
        layers: bands.into_iter().chain(lines).collect(),
    };
    let means = approached(analysis, ["mean, approached in + direction", "mean, in − direction"]);
    let mut entries: Vec<Markup> = means.iter().map(|(class, words)| line_entry(class, words)).collect();
    entries.extend(means.first().map(|(class, _)| point_entry(class, "one reading")));
    entries.push(surface_entry("noise", "± 2 standard deviations"));
    html! {
        (legend(&entries))
        (figure("wide", &chart.svg(), "Actual position less target."))
    }
}

fn effects(effects: &[Effect]) -> Markup {
    if effects.is_empty() {
        return paragraph("No effect stands out of the scatter.");
    }
    let columns = [
        Column::Words("effect"),
        Column::Numbers("µm"),
        Column::Words("parameters, 95 % interval"),
        Column::Words("certainty"),
        Column::Words("may be confused with"),
        Column::Words("in words"),
    ];
    let rows = html! {
        @for effect in effects {
            @let [name, um, parameters, certainty, rivals] = cells(effect);
            tr {
                td { (text(&name)) }
                (number_cell(&um))
                (words_cell(&parameters))
                td { (text(&certainty)) }
                (words_cell(&rivals))
                (words_cell(&effect.sentence))
            }
        }
    };
    table("Effects in the deviation over position", &columns, &rows)
}

fn left(analysis: &Analysis) -> Markup {
    let of = |is_fitted: bool, sign: f64| {
        let all =
            analysis.left.iter().filter(move |left| left.is_fitted == is_fitted && left.sign * sign > 0.0);
        all.map(|left| (left.target_mm, left.um))
    };
    let both = [(1.0, ink(Way::Positive)), (-1.0, ink(Way::Negative))];
    let fitted = both.into_iter().flat_map(|(sign, ink)| points(ink, of(true, sign)));
    let held = [1.0, -1.0].into_iter().flat_map(|sign| points(Ink::After, of(false, sign)));
    let chart = Chart {
        size: (960, 220),
        title: "What is left over position",
        description: "Each reading less the effects found.",
        x: "target, mm",
        y: "left, µm",
        noise: Some(2.0 * analysis.scatter_um.unwrap_or(0.0)),
        layers: fitted.chain(held).collect(),
    };
    let fitted = approached(analysis, ["fitted, in + direction", "fitted, in − direction"]);
    let mut entries: Vec<Markup> = fitted.iter().map(|(class, words)| point_entry(class, words)).collect();
    if analysis.left.iter().any(|left| !left.is_fitted) {
        entries.push(point_entry("after", "validation runs"));
    }
    entries.push(surface_entry("noise", "± 2 standard deviations of the scatter"));
    html! {
        (legend(&entries))
        (figure("wide", &chart.svg(), "Measured less the effects found."))
        (residuals(analysis))
        @if let Some(floor) = floor(analysis) { (paragraph(&floor)) }
    }
}

/// The residual of the fitted and of the validation runs, and of runs that were left out.
fn residuals(analysis: &Analysis) -> Markup {
    let rows = residual_rows(analysis);
    let has_validation = rows.iter().any(|(_, um)| um.validate.is_some());
    let mut columns = vec![Column::Words("µm rms"), Column::Numbers("fitted runs")];
    if has_validation {
        columns.push(Column::Numbers("validation runs"));
    }
    let cell = |um: Option<f64>| number_cell(&figure_um(um));
    let body = html! {
        @for (name, um) in &rows {
            tr {
                th scope="row" { (name) }
                (cell(Some(um.fit)))
                @if has_validation { (cell(um.validate)) }
            }
        }
    };
    html! {
        (table("Residual of the readings", &columns, &body))
        @if let Some(um) = analysis.residual.left_out {
            (note(&format!("Fitted runs that were left out of the fit one by one: {} µm rms.", fixed(um, 2))))
        }
    }
}

/// How the deviation at each target changes from run to run.
fn runs(analysis: &Analysis) -> Markup {
    const FEWEST: usize = 3;
    if analysis.test.runs() < FEWEST || analysis.test.is_scattered() {
        return Markup::default();
    }
    let mut layers = Vec::new();
    for position in &analysis.positions {
        for (way, index) in Way::BOTH.into_iter().zip(0..) {
            let Some(mean_um) = position.ways[index].map(|at| at.mean_um) else { continue };
            let is_here = |reading: &&positions::measured::Reading| {
                reading.way == way && (reading.target_mm - position.target_mm).abs() < 1e-6
            };
            let readings = analysis.test.readings.iter().filter(is_here);
            let points =
                readings.map(|reading| ((reading.run + 1) as f64, reading.deviation_um - mean_um)).collect();
            layers.push(Layer { ink: ink(way), points, is_marked: true });
        }
    }
    let chart = Chart {
        size: (960, 220),
        title: "Deviation from run to run",
        description: "The deviation at each target in each direction, less its mean, over the runs.",
        x: "run",
        y: "change, µm",
        noise: Some(0.0),
        layers,
    };
    let ways = approached(analysis, ["a target, approached in + direction", "a target, in − direction"]);
    let entries: Vec<Markup> = ways.iter().map(|(class, words)| line_entry(class, words)).collect();
    html! {
        (legend(&entries))
        (figure("wide", &chart.svg(), "Deviation at each target in each direction, less its mean over the runs."))
    }
}
