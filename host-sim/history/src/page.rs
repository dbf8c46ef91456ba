//! The page of a history: what changed, a picture of each value that did, and a table of all.

use std::path::{Path, PathBuf};

use maud::{Markup, html};

use files::output::OutputError;
use pages::markup::{
    Column, figure, folded, legend, line_entry, list, number_cell, paragraph, point_entry, section,
    surface_entry, table, text,
};
use pages::plot::{Chart, Ink, Layer};

use crate::History;
use crate::series::Series;
use crate::text::{HEADINGS, MONTH_DAYS, cells, lead, name, of_limit, promise, sentences};

/// Writes the page into a folder, which is created if it does not exist, and returns its path.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(folder: &Path, history: &History) -> Result<PathBuf, OutputError> {
    pages::write(folder, &html(history))
}

/// The page. The same history gives the same bytes.
#[must_use]
pub fn html(history: &History) -> String {
    let limits: Vec<String> = history.limits.iter().map(of_limit).collect();
    let notes: Vec<String> = history.notes.iter().cloned().chain([promise(history)]).collect();
    let (watched, tool): (Vec<&Series>, Vec<&Series>) =
        history.series.iter().partition(|series| series.is_watched());
    let others: Vec<&Series> = watched.into_iter().filter(|series| !series.has_changed()).collect();
    let sections = html! {
        @if !limits.is_empty() { (section("Limits", &list(&limits))) }
        @if history.changed().next().is_some() {
            (section("What changed", &pictures(history, &history.changed().collect::<Vec<_>>())))
        }
        (section("All values", &values(history)))
        @if !tool.is_empty() {
            (section("Contour error at the tool", &folded("Pictures", &pictures(history, &tool))))
        }
        @if !others.is_empty() {
            (section("Values that did not change", &folded("Pictures", &pictures(history, &others))))
        }
        (section("How it is judged", &list(&notes)))
    };
    let changes = sentences(history);
    let lead = html! { (paragraph(&lead(history))) @if !changes.is_empty() { (list(&changes)) } };
    let whose = name(history).unwrap_or_else(|| "a machine".to_owned());
    pages::render(&format!("History of {whose}"), &lead, &sections)
}

fn values(history: &History) -> Markup {
    let columns = HEADINGS.map(|heading| match heading {
        "value" => Column::Words(heading),
        _ => Column::Numbers(heading),
    });
    let rows = html! {
        @for series in history.series.iter() {
            @let [name, count, first, now, rate] = cells(series);
            tr {
                td { (text(&name)) }
                @for number in [count, first, now, rate] { (number_cell(&number)) }
            }
        }
    };
    html! {
        (table("All values over the traces", &columns, &rows))
        (paragraph("Now: at the last trace. A month: the trend since the last change, with its 95 % interval."))
    }
}

fn pictures(history: &History, all: &[&Series]) -> Markup {
    html! {
        (legend(&[
            point_entry("after", "a trace, with its 95 % interval"),
            point_entry("label", "not counted: ambiguous, at a bound, or far less exact"),
            line_entry("before", "trend since the last change"),
            line_entry("cw", "a change was announced"),
            surface_entry("noise", "95 % interval of the trend"),
        ]))
        @for series in all { (picture(history, series)) }
    }
}

fn picture(history: &History, series: &Series) -> Markup {
    let months = |record: usize| history.days[record] / MONTH_DAYS;
    let mut layers = Vec::new();
    if let (Some(trend), Some(first)) = (&series.trend, series.counted(series.since())) {
        let steps = (0..=20).map(|step| {
            let start = history.days[first.record];
            start + (trend.last_days - start) * f64::from(step) / 20.0
        });
        let lines: Vec<(f64, [f64; 2])> = steps.map(|days| (days / MONTH_DAYS, trend.at(days))).collect();
        let edge = |sign: f64| lines.iter().map(move |(x, [value, half])| (*x, value + sign * half));
        let outline = edge(1.0).chain(edge(-1.0).collect::<Vec<_>>().into_iter().rev()).collect();
        layers.push(Layer { ink: Ink::Noise, points: outline, is_marked: false });
        let line = lines.iter().map(|(x, [value, _])| (*x, *value)).collect();
        layers.push(Layer { ink: Ink::Before, points: line, is_marked: false });
    }
    let [low, high] = series.entries.iter().fold([f64::MAX, f64::MIN], |[low, high], entry| {
        [low.min(entry.figure.value), high.max(entry.figure.value)]
    });
    for alarm in &series.alarms {
        if let Some(entry) = series.counted(alarm.at) {
            let at = months(entry.record);
            layers.push(Layer { ink: Ink::Third, points: vec![(at, low), (at, high)], is_marked: false });
        }
    }
    for entry in &series.entries {
        let ink = if entry.is_counted { Ink::After } else { Ink::Label };
        let (x, value) = (months(entry.record), entry.figure.value);
        if let Some(half) = entry.figure.half_width {
            layers.push(Layer { ink, points: vec![(x, value - half), (x, value + half)], is_marked: false });
        }
        layers.push(Layer { ink, points: vec![(x, value)], is_marked: true });
    }
    let name = series.name.to_string();
    let x = format!("months since {}", history.records[0].day);
    let chart = Chart {
        size: (960, 220),
        title: &name,
        description: "The value of each trace with its interval, the trend, and where a change was announced.",
        x: &x,
        y: &name,
        noise: None,
        layers,
    };
    figure("wide", &chart.svg(), &name)
}
