//! The history of one machine over months: its traces, each parameter over time with its interval, what changed and when, what that costs
//! at the tool, and when a limit will be reached.
//!
//! [`folder`] reads the traces, each a [`record`] from its JSON ([`trace_json`]) or its model ([`model_file`]). A [`series`] has the figures of one name; [`monitor`] watches it by a
//! [`control_chart`] of [`scores`], which require no known mean or scatter, and [`change`] determines date and size of an
//! announced change. [`forecast`] extends the trend to a limit, [`appearance`] determines which effects appeared or disappeared. [`text`],
//! [`page`], [`json`] and [`table`] show the result.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod appearance;
pub mod change;
pub mod control_chart;
pub mod folder;
pub mod forecast;
pub mod json;
pub mod least_squares;
pub mod model_file;
pub mod monitor;
pub mod page;
pub mod record;
pub mod scores;
pub mod series;
pub mod table;
pub mod text;
pub mod trace_json;

use files::error::{InputError, quoted};
use indexmap::IndexMap;
use jiff::civil::Date;
use numerics::mean_and_deviation;

use appearance::Appearance;
use control_chart::{Chart, TRACES_TO_FALSE_ALARM};
use folder::Folder;
use forecast::{Limit, Reached};
use record::{Figure, Group, Name, Record};
use series::{Conditions, Series};

/// A temperature that varies less than this is not taken into account, K.
const LEAST_KELVIN: f64 = 0.2;

/// The history of a machine.
#[derive(Clone, Debug)]
pub struct History {
    /// The traces, earliest first.
    pub records: Vec<Record>,
    /// Days of the traces since the first one.
    pub days: Vec<f64>,
    /// All series, by group and name.
    pub series: Vec<Series>,
    /// Effects that appeared or disappeared.
    pub appearances: Vec<Appearance>,
    /// Each requested limit.
    pub limits: Vec<(Limit, Reached)>,
    /// Number of series that are watched together.
    pub watched: usize,
    /// Assumptions and omissions, one sentence each.
    pub notes: Vec<String>,
}

impl History {
    /// The history of the traces of a machine. All series that are watched have one false alarm in 370 traces together.
    ///
    /// # Errors
    /// A limit of a series that does not exist.
    pub fn of(folder: Folder, limits: Vec<Limit>) -> Result<Self, InputError> {
        let Folder { records, mut notes, .. } = folder;
        let days: Vec<f64> =
            records.iter().map(|record| f64::from((record.day - records[0].day).get_days())).collect();
        let mut figures: IndexMap<Name, Vec<(usize, Figure)>> = IndexMap::new();
        for (index, record) in records.iter().enumerate() {
            for (name, figure) in &record.figures {
                figures.entry(name.clone()).or_default().push((index, *figure));
            }
        }
        figures.sort_keys();
        let watched = figures.keys().filter(|name| name.group != Group::Tool).count();
        let chart = Chart::with_run_length(TRACES_TO_FALSE_ALARM * watched.max(1) as f64);
        let (kelvin, note) = temperatures(&records);
        notes.extend(note);
        let conditions = Conditions { records: &records, days: &days, kelvin: kelvin.as_deref() };
        let of = |(name, figures)| Series::of(name, figures, &conditions, chart);
        let series: Vec<Series> = figures.into_iter().map(of).collect();
        let limits = limits.into_iter().map(|limit| judged(limit, &series)).collect::<Result<_, _>>()?;
        let appearances = appearance::of(&records);
        Ok(Self { records, days, series, appearances, limits, watched, notes })
    }

    /// Series whose change is announced.
    pub fn changed(&self) -> impl Iterator<Item = &Series> {
        self.series.iter().filter(|series| series.has_changed())
    }

    /// The day of a counted figure of a series, by its index; that of the first trace if there is no such figure.
    #[must_use]
    pub fn day(&self, series: &Series, index: usize) -> Date {
        self.records[series.counted(index).map_or(0, |entry| entry.record)].day
    }

    /// Series that the last trace raised an alarm of.
    pub fn alarmed_last(&self) -> impl Iterator<Item = &Series> {
        let last = self.records.len() - 1;
        self.changed().filter(move |series| {
            let at = series.alarms.last().and_then(|alarm| series.counted(alarm.at));
            at.is_some_and(|entry| entry.record == last)
        })
    }
}

/// Temperatures of all traces less their mean, and the note about them.
fn temperatures(records: &[Record]) -> (Option<Vec<f64>>, Option<String>) {
    let known: Vec<f64> = records.iter().filter_map(|record| record.temperature_c).collect();
    if known.is_empty() {
        return (None, None);
    }
    if known.len() < records.len() {
        let note = format!(
            "{} of {} traces have no temperature: it is not used.",
            records.len() - known.len(),
            records.len()
        );
        return (None, Some(note));
    }
    let (centre, deviation) = mean_and_deviation(&known);
    if deviation < LEAST_KELVIN {
        return (None, None);
    }
    let note = format!(
        "Levels and trends are those at {centre:.1} °C: what follows the temperature in proportion is no change."
    );
    (Some(known.iter().map(|celsius| celsius - centre).collect()), Some(note))
}

fn judged(limit: Limit, series: &[Series]) -> Result<(Limit, Reached), InputError> {
    let Some(own) = series.iter().find(|series| series.name.to_string() == limit.name) else {
        let names: Vec<String> = series.iter().map(|series| series.name.to_string()).collect();
        return Err(InputError::expected(
            "--limit",
            format!("a name of the history ({})", names.join(", ")),
            quoted(&limit.name),
        ));
    };
    let reached = own.trend.as_ref().map_or(Reached::Unknown, |trend| trend.reaches(&limit));
    Ok((limit, reached))
}
