//! The history as JSON.

use jiff::civil::Date;
use serde::Serialize;

use crate::History;
use crate::appearance::Turn;
use crate::control_chart::TRACES_TO_FALSE_ALARM;
use crate::forecast::{Reached, Side};
use crate::monitor::Alarm;
use crate::record::Cost;
use crate::series::{Estimate, Series};
use crate::text::{MONTH_DAYS, name};

/// The document of `history --json`.
#[derive(Serialize)]
pub struct Document<'a> {
    machine: Option<String>,
    traces: Vec<Trace<'a>>,
    traces_to_false_alarm: f64,
    watched: usize,
    series: Vec<OfSeries>,
    appearances: Vec<Appearance<'a>>,
    limits: Vec<Limit<'a>>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct Trace<'a> {
    file: &'a str,
    date: Date,
    temperature_c: Option<f64>,
}

#[derive(Serialize)]
struct OfSeries {
    name: String,
    group: &'static str,
    /// Whether changes of it are announced.
    is_watched: bool,
    points: Vec<Point>,
    changes: Vec<Change>,
    first: Option<Value>,
    now: Option<Value>,
    per_month: Option<Value>,
    at_tool_um_rms: Option<AtTool>,
}

#[derive(Serialize)]
struct Point {
    date: Date,
    value: f64,
    half_width: Option<f64>,
    certainty: &'static str,
    is_counted: bool,
}

#[derive(Serialize)]
struct Value {
    value: f64,
    half_width: Option<f64>,
}

#[derive(Serialize)]
struct Change {
    shape: &'static str,
    since: Date,
    earliest: Date,
    latest: Date,
    announced: Date,
    size: f64,
    half_width: Option<f64>,
}

#[derive(Serialize)]
struct AtTool {
    motion: String,
    first: f64,
    now: f64,
}

#[derive(Serialize)]
struct Appearance<'a> {
    axis: &'a str,
    effect: &'a str,
    turn: &'static str,
    after: Date,
    since: Date,
}

#[derive(Serialize)]
struct Limit<'a> {
    name: &'a str,
    value: f64,
    side: &'static str,
    reached: &'static str,
    date: Option<Date>,
    earliest: Option<Date>,
    latest: Option<Date>,
}

/// The document of a history.
#[must_use]
pub fn of(history: &History) -> Document<'_> {
    let traces = history.records.iter();
    let traces = traces.map(|record| Trace {
        file: &record.source,
        date: record.day,
        temperature_c: record.temperature_c,
    });
    Document {
        machine: name(history),
        traces: traces.collect(),
        traces_to_false_alarm: TRACES_TO_FALSE_ALARM,
        watched: history.watched,
        series: history.series.iter().map(|series| of_series(history, series)).collect(),
        appearances: history.appearances.iter().map(Appearance::of).collect(),
        limits: history.limits.iter().map(|(limit, reached)| Limit::of(limit, reached)).collect(),
        notes: &history.notes,
    }
}

fn value(estimate: Estimate) -> Value {
    Value { value: estimate.value, half_width: finite(estimate.half_width) }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

fn of_series(history: &History, series: &Series) -> OfSeries {
    let point = |entry: &crate::series::Entry| Point {
        date: history.records[entry.record].day,
        value: entry.figure.value,
        half_width: entry.figure.half_width,
        certainty: entry.figure.trust.word(),
        is_counted: entry.is_counted,
    };
    let change = |alarm: &Alarm| {
        let day = |index: usize| history.day(series, index);
        let change = alarm.change;
        Change {
            shape: change.shape.word(),
            since: day(change.first),
            earliest: day(change.range[0]),
            latest: day(change.range[1]),
            announced: day(alarm.at),
            size: change.size,
            half_width: finite(change.half_width),
        }
    };
    let at_tool = |[first, now]: &[Cost; 2]| AtTool {
        motion: now.motion.clone(),
        first: first.um_rms,
        now: now.um_rms,
    };
    let rate = series.trend.as_ref().map(|trend| trend.per_day().map(|per_day| MONTH_DAYS * per_day));
    OfSeries {
        name: series.name.to_string(),
        group: series.name.group.word(),
        is_watched: series.is_watched(),
        points: series.entries.iter().map(point).collect(),
        changes: series.alarms.iter().map(change).collect(),
        first: series.first.map(value),
        now: series.now.map(value),
        per_month: rate.map(|[rate, half]| Value { value: rate, half_width: finite(half) }),
        at_tool_um_rms: series.costs.as_ref().map(at_tool),
    }
}

impl<'a> Appearance<'a> {
    fn of(found: &'a crate::appearance::Appearance) -> Self {
        let turn = match found.turn {
            Turn::Came => "came",
            Turn::Went => "went",
        };
        Self { axis: &found.axis, effect: &found.effect, turn, after: found.after, since: found.since }
    }
}

impl<'a> Limit<'a> {
    fn of(limit: &'a crate::forecast::Limit, reached: &Reached) -> Self {
        let side = match limit.side {
            Side::AtMost => "at_most",
            Side::AtLeast => "at_least",
        };
        let (word, date, earliest, latest) = match *reached {
            Reached::Already => ("already", None, None, None),
            Reached::AboutNow => ("about_now", None, None, None),
            Reached::On { date, earliest, latest } => ("on", Some(date), earliest, latest),
            Reached::NotInSight { earliest } => ("not_in_sight", None, earliest, None),
            Reached::Unknown => ("unknown", None, None, None),
        };
        Self { name: &limit.name, value: limit.value, side, reached: word, date, earliest, latest }
    }
}
