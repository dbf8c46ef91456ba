//! The history for a terminal: what changed in a sentence each, then a table of all that is watched.

use files::format::{significant, with_spread};

use crate::History;
use crate::appearance::{Appearance, Turn};
use crate::change::Shape;
use crate::control_chart::TRACES_TO_FALSE_ALARM;
use crate::forecast::{Limit, Reached, Side};
use crate::monitor::Alarm;
use crate::series::{Estimate, Series};

/// Values of which a change can be told: before them, no value has a score where the temperature is known.
const MIN_TO_TELL: usize = 6;

/// Days of a month, for rates.
pub const MONTH_DAYS: f64 = 30.4375;

/// All lines.
#[must_use]
pub fn of(history: &History) -> String {
    let mut parts = vec![lead(history)];
    let changes: Vec<String> = sentences(history);
    parts.extend((!changes.is_empty()).then(|| changes.join("\n")));
    let rows = history.series.iter().filter(|series| series.is_watched());
    let table: Vec<String> = std::iter::once(line(HEADINGS.map(str::to_owned)))
        .chain(rows.map(|series| line(cells(series))))
        .collect();
    parts.push(table.join("\n"));
    let limits: Vec<String> = history.limits.iter().map(of_limit).collect();
    parts.extend((!limits.is_empty()).then(|| limits.join("\n")));
    parts.push(history.notes.iter().cloned().chain([promise(history)]).collect::<Vec<_>>().join("\n"));
    parts.join("\n\n")
}

/// How many traces there are, and whether anything changed.
#[must_use]
pub fn lead(history: &History) -> String {
    let Some((first, last)) = history.records.first().zip(history.records.last()) else {
        return String::new();
    };
    let traces = if history.records.len() == 1 { "trace" } else { "traces" };
    let changed = history.changed().count();
    let result = match (changed, history.series.iter().map(Series::count).max().unwrap_or(0)) {
        (0, count) if count < MIN_TO_TELL => "too few to tell a change from scatter".to_owned(),
        (0, _) => "nothing that is watched changed beyond its scatter".to_owned(),
        (1, _) => "one value changed".to_owned(),
        (changed, _) => format!("{changed} values changed"),
    };
    let whose = name(history).map_or_else(String::new, |name| format!("{name}: "));
    format!("{whose}{} {traces} from {} to {}; {result}.", history.records.len(), first.day, last.day)
}

/// Name and serial number of the machine.
#[must_use]
pub fn name(history: &History) -> Option<String> {
    let machine = history.records.iter().find_map(|record| record.machine.clone());
    let serial = history.records.iter().find_map(|record| record.serial.clone());
    match (machine, serial) {
        (Some(machine), Some(serial)) => Some(format!("{machine} ({serial})")),
        (machine, serial) => machine.or(serial),
    }
}

/// Each change, and each effect that came or went.
#[must_use]
pub fn sentences(history: &History) -> Vec<String> {
    let changes = history.changed().flat_map(|series| of_changes(history, series));
    changes.chain(history.appearances.iter().map(of_appearance)).collect()
}

/// How often a false alarm is expected.
#[must_use]
pub fn promise(history: &History) -> String {
    format!(
        "Of a steady machine, one false alarm is expected in {TRACES_TO_FALSE_ALARM} traces, all {} watched values together.",
        history.watched
    )
}

/// A sentence for each change of a series; one that goes on in its direction is one.
fn of_changes(history: &History, series: &Series) -> Vec<String> {
    let directions: Vec<&[Alarm]> =
        series.alarms.chunk_by(|a, b| (a.change.size > 0.0) == (b.change.size > 0.0)).collect();
    let mut sentences: Vec<String> =
        directions.iter().map(|alarms| of_direction(history, series, alarms)).collect();
    if let Some(last) = sentences.last_mut() {
        *last += &now(series);
    }
    sentences.into_iter().map(|sentence| sentence + ".").collect()
}

/// Alarms of changes in one direction, earliest first.
fn of_direction(history: &History, series: &Series, alarms: &[Alarm]) -> String {
    let (Some(first), Some(last)) = (alarms.first(), alarms.last()) else { return String::new() };
    let day = |index: usize| history.day(series, index);
    let direction = if first.change.size > 0.0 { "rose" } else { "fell" };
    let form = match last.change.shape {
        Shape::Step => "in a step",
        Shape::Growth => "steadily",
        Shape::Unclear => "in a step or steadily",
    };
    let size = match alarms {
        [only] => format!(" by {}", with_spread(only.change.size.abs(), only.change.half_width)),
        _ => String::new(),
    };
    let [earliest, latest] = first.change.range.map(day);
    let announced: Vec<String> = alarms.iter().map(|alarm| day(alarm.at).to_string()).collect();
    format!(
        "{} {direction} {form}{size} since about {} ({earliest} to {latest}), announced {}",
        series.name,
        day(first.change.first),
        announced.join(", ")
    )
}

/// The value before the first change and now, with what it costs.
fn now(series: &Series) -> String {
    let mut said = match (series.first, series.now) {
        (Some(first), Some(now)) => format!("; {} before, {} now", estimate(first), estimate(now)),
        _ => String::new(),
    };
    if let Some([before, after]) = &series.costs {
        said += &format!(
            "; at the tool on {} {} → {} µm rms",
            after.motion,
            significant(before.um_rms, 2),
            significant(after.um_rms, 2)
        );
    }
    said
}

fn of_appearance(appearance: &Appearance) -> String {
    let Appearance { axis, effect, turn, after, since } = appearance;
    match turn {
        Turn::Came => {
            format!("{axis}.{effect} is certain since {since}, and was not found up to {after}.")
        }
        Turn::Went => format!(
            "{axis}.{effect} is not found any more since {since}, and was certain up to {after}; it may be there, but smaller."
        ),
    }
}

/// Whether and when a limit is reached.
#[must_use]
pub fn of_limit((limit, reached): &(Limit, Reached)) -> String {
    let side = match limit.side {
        Side::AtMost => "at most",
        Side::AtLeast => "at least",
    };
    format!("{}, {side} {}: {reached}.", limit.name, limit.value)
}

/// Headings of the table.
pub const HEADINGS: [&str; 5] = ["value", "traces", "at first", "now", "a month"];

/// A row of the table.
#[must_use]
pub fn cells(series: &Series) -> [String; 5] {
    let shown = |value: Option<Estimate>| value.map_or_else(|| "–".to_owned(), estimate);
    let rate = series.trend.as_ref().map_or_else(
        || "–".to_owned(),
        |trend| {
            let [slope, half] = trend.per_day().map(|per_day| MONTH_DAYS * per_day);
            with_spread(slope, half)
        },
    );
    let count = match series.count() {
        counted if counted < series.entries.len() => format!("{counted} of {}", series.entries.len()),
        counted => counted.to_string(),
    };
    let state = if series.has_changed() { " (changed)" } else { "" };
    let first = if series.alarms.is_empty() { String::new() } else { shown(series.first) };
    [format!("{}{state}", series.name), count, first, shown(series.now), rate]
}

fn line(cells: [String; 5]) -> String {
    let [name, count, first, now, rate] = cells;
    format!("{name:<44}{count:>10}{first:>20}{now:>20}{rate:>22}").trim_end().to_owned()
}

/// A value with its interval.
#[must_use]
pub fn estimate(estimate: Estimate) -> String {
    if estimate.half_width.is_finite() {
        with_spread(estimate.value, estimate.half_width)
    } else {
        significant(estimate.value, 4)
    }
}
