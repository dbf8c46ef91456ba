//! The page of a friction map: what was found, the curve before and after, and what either leaves.

pub mod sentences;

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use crate::markup::{
    Column, figure, legend, line_entry, list, note, number_cell, paragraph, point_entry, section,
    surface_entry, table as table_of, text,
};
use crate::number::{fixed, percent};
use crate::page::{self, file_name};
use crate::plot::{Chart, Ink, Layer};
use trace::friction_map::FrictionMap;
use trace::friction_map::fit::Law;
use trace::friction_map::search::{Candidate, Explained, Round};
use trace::friction_map::unexplained::Unexplained;

use files::output::OutputError;
use sentences::{remainder, sentences, table};

/// Writes the page into a folder, which is made where it is missing, and gives its path.
///
/// # Errors
/// If the folder cannot be made or the page not be written.
pub fn write(
    folder: &Path,
    map: &FrictionMap,
    explained: &Explained,
    rest: Option<&Unexplained>,
) -> Result<PathBuf, OutputError> {
    page::write(folder, &html(map, explained, rest))
}

/// The page.
#[must_use]
pub fn html(map: &FrictionMap, explained: &Explained, rest: Option<&Unexplained>) -> String {
    let lead = note(&format!(
        "Friction map {}: {} runs at constant speed. Declared: Coulomb and viscous friction, the same both ways.",
        file_name(&map.source),
        map.runs.len()
    ));
    let figures = html! { pre { (text(&table(map, explained).join("\n"))) } };
    let sections = html! {
        (section("What was found", &list(&sentences(map, explained))))
        (section("Error before and after", &figures))
        (section("The map", &pictures(map, explained)))
        (section("What was tried", &tried(&explained.searched.rounds)))
        (section("What stays unexplained", &list(&remainder(map, explained, rest))))
    };
    page::render(&format!("Friction of {}", file_name(&map.source)), &lead, &sections)
}

fn pictures(map: &FrictionMap, explained: &Explained) -> Markup {
    let (before, after) = (&explained.searched.declared.law, &explained.searched.fitted.law);
    let keys = [
        point_entry("cw", "measured: the mean of a run"),
        line_entry("before", "Coulomb and viscous friction"),
        line_entry("after", "with what was found"),
        surface_entry("noise", "within ± 2 standard errors of a mean"),
    ];
    let (drive, force, speed) = (map.unit.drive(), map.unit.force(), map.unit.speed());
    let mut layers: Vec<Layer> = map
        .runs
        .iter()
        .map(|run| Layer { ink: Ink::Third, points: vec![(run.velocity, run.force)], is_marked: true })
        .collect();
    layers.extend(curves(map, before, Ink::Before));
    layers.extend(curves(map, after, Ink::After));
    let x = format!("speed, {speed}");
    let all = Chart {
        size: (960, 260),
        title: "Friction over speed",
        description: "Measured runs, and the law before and after.",
        x: &x,
        y: &format!("{drive}, {force}"),
        noise: 0.0,
        layers,
    };
    let left = |ink: Ink, law: &Law| {
        let one = |side: f64| {
            let runs = map.runs.iter().filter(move |run| run.velocity * side > 0.0);
            let points = runs.map(|run| (run.velocity, run.force - law.force(run.velocity))).collect();
            Layer { ink, points, is_marked: true }
        };
        [one(-1.0), one(1.0)].into_iter().filter(|layer| !layer.points.is_empty())
    };
    let residual = Chart {
        size: (960, 220),
        title: "What is left over speed",
        description: "Measured minus law, before and after.",
        x: &x,
        y: &format!("residual, {force}"),
        noise: 2.0 * map.noise().unwrap_or(0.0),
        layers: left(Ink::Before, before).chain(left(Ink::After, after)).collect(),
    };
    html! {
        (legend(&keys))
        (figure("wide", &all.svg(), "Measured and modelled."))
        (figure("wide", &residual.svg(), "Measured minus modelled, from fits to all runs."))
    }
}

/// A law drawn over the speeds of the map, each way for itself.
fn curves(map: &FrictionMap, law: &Law, ink: Ink) -> Vec<Layer> {
    const POINTS: u32 = 120;
    let one = |side: f64| {
        let speeds = map.runs.iter().map(|run| side * run.velocity).filter(|speed| *speed > 0.0);
        let (low, high) =
            speeds.fold((f64::INFINITY, 0.0_f64), |(low, high), speed| (low.min(speed), high.max(speed)));
        let at = |i: u32| {
            let velocity = side * (low + (high - low) * f64::from(i) / f64::from(POINTS));
            (velocity, law.force(velocity))
        };
        (high > low).then(|| Layer { ink, points: (0..=POINTS).map(at).collect(), is_marked: false })
    };
    [one(-1.0), one(1.0)].into_iter().flatten().collect()
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
            (table_of(&columns, &rows(round)))
        }
    }
}

fn rows(round: &Round) -> Markup {
    let verdict = |i, candidate: &Candidate| match (
        round.added == Some(i),
        candidate.is_supported(round.candidates.len()),
    ) {
        (true, _) => "added",
        (_, true) => "supported, but less",
        _ if !candidate.is_physical => "would need friction below none",
        _ => "not supported",
    };
    html! {
        @for (i, candidate) in round.candidates.iter().enumerate() {
            tr {
                th scope="row" { (text(candidate.term.meaning())) }
                (number_cell(&change(candidate.reduction)))
                (number_cell(&change(candidate.range_reduction)))
                (number_cell(&percent(100.0 * candidate.chance)))
                td { (verdict(i, candidate)) }
            }
        }
    }
}

/// Change of the rms error in percent, from the reduction of the mean square error; a dash where it is not known.
fn change(reduction: f64) -> String {
    // `clamp` keeps NaN, which `max` would replace.
    match 100.0 * ((1.0 - reduction).clamp(0.0, f64::MAX).sqrt() - 1.0) {
        change if change.is_finite() && change < 1000.0 => format!("{} %", fixed(change, 1)),
        _ => "–".to_owned(),
    }
}
