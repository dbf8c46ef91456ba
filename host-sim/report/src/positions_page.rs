//! The page of `positions`: the sentence, the figures, the deviation over position with its 2s band, what it is made of, what is left.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::output::OutputError;
use pages::file_name;
use pages::markup::{
    Column, figure, legend, line_entry, list, number_cell, paragraph, point_entry, section, surface_entry,
    table, text,
};
use pages::plot::{Chart, Ink, Layer};
use positions::Analysis;
use positions::effect::Effect;
use positions::measured::Way;
use positions::text::{cells, figures, floor, residuals, sentence};

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
        (section("Figures after ISO 230-2", &preformatted(&figures(analysis))))
        (section("Deviation over position", &measured(analysis)))
        (section("What it is made of", &effects(&analysis.effects)))
        (section("What is left", &left(analysis)))
        (section("From run to run", &runs(analysis)))
        (section("What was assumed", &notes(&analysis.notes)))
    };
    let lead = paragraph(&sentence(analysis));
    pages::render(&format!("Positions: {}", file_name(&analysis.test.source)), &lead, &sections)
}

fn preformatted(lines: &[String]) -> Markup {
    html! { pre { (text(&lines.join("\n"))) } }
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
    html! {
        (legend(&[
            line_entry("cw", "mean, approached in + direction"),
            line_entry("ccw", "in − direction"),
            point_entry("cw", "one reading"),
            surface_entry("noise", "± 2 standard deviations"),
        ]))
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
                td { (text(&parameters)) }
                td { (text(&certainty)) }
                td { (text(&rivals)) }
                td { (text(&effect.sentence)) }
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
    html! {
        (legend(&[
            point_entry("cw", "fitted, in + direction"),
            point_entry("ccw", "fitted, in − direction"),
            point_entry("after", "validation runs"),
            surface_entry("noise", "± 2 standard deviations of the scatter"),
        ]))
        (figure("wide", &chart.svg(), "Measured less the effects found."))
        (preformatted(&residuals(analysis)))
        @if let Some(floor) = floor(analysis) { (paragraph(&floor)) }
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
    figure("wide", &chart.svg(), "Deviation at each target in each direction, less its mean over the runs.")
}
