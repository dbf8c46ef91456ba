//! The figures of one name over all traces of a machine, with what changed.

use numerics::{mean, median};

use crate::control_chart::Chart;
use crate::forecast::Trend;
use crate::least_squares::Regression;
use crate::monitor::{Alarm, alarms};
use crate::record::{Cost, Figure, Group, Name, Record};

/// A figure whose interval is this many times as wide as that of the ones before is not counted.
const TOO_WIDE: f64 = 3.0;

/// Values that a trend needs.
const MIN_FOR_TREND: usize = 4;

/// A figure of a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry {
    /// Index of the trace.
    pub record: usize,
    /// The figure.
    pub figure: Figure,
    /// Whether it is monitored.
    pub is_counted: bool,
}

/// A value with the half width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Half width; infinite if it is not known.
    pub half_width: f64,
}

/// A series of figures.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name.
    pub name: Name,
    /// A figure of each trace that has it, earliest first.
    pub entries: Vec<Entry>,
    /// The changes that were found, which are announced if the series is watched; indices count the entries that are counted.
    pub alarms: Vec<Alarm>,
    /// Mean before the first change, at mean temperature.
    pub first: Option<Estimate>,
    /// Value at the last trace, at mean temperature: of the trend if one is shown, else the mean since the last change.
    pub now: Option<Estimate>,
    /// The line since the last change.
    pub trend: Option<Trend>,
    /// Cost at the tool before the first change and at the last trace.
    pub costs: Option<[Cost; 2]>,
}

/// The days and the temperature of the traces.
pub(crate) struct Conditions<'a> {
    pub records: &'a [Record],
    /// Days since the first trace.
    pub days: &'a [f64],
    /// Temperature less its mean, K; `None` if it is not known of all traces, or hardly varies.
    pub kelvin: Option<&'a [f64]>,
}

impl Series {
    /// A series with its changes.
    pub(crate) fn of(
        name: Name,
        figures: Vec<(usize, Figure)>,
        conditions: &Conditions,
        chart: Chart,
    ) -> Self {
        let entries = counted(figures);
        let (records, values): (Vec<usize>, Vec<f64>) =
            of_counted(&entries).map(|entry| (entry.record, entry.figure.value)).unzip();
        let days: Vec<f64> = records.iter().map(|record| conditions.days[*record]).collect();
        let own = |record: &usize| conditions.kelvin.map(|kelvin| kelvin[*record]);
        let with = |mut row: Vec<f64>, record: &usize| {
            row.extend(own(record));
            row
        };
        let rows: Vec<Vec<f64>> = records.iter().map(|record| with(vec![1.0], record)).collect();
        let alarms = alarms(&rows, &values, &days, chart);
        let since = since(&alarms);
        let until = alarms.first().map_or(values.len(), |alarm| alarm.change.first);
        let trend = (values.len() >= since + MIN_FOR_TREND).then(|| {
            let rows: Vec<Vec<f64>> =
                (since..values.len()).map(|at| with(vec![1.0, days[at]], &records[at])).collect();
            let fit = Regression::of(&rows, &values[since..])?;
            let (last_days, start) = (*days.last()?, conditions.records.first()?.day);
            Some(Trend { fit, last_days, start })
        });
        let trend = trend.flatten();
        let now = shown(trend.as_ref()).or_else(|| level(&rows[since..], &values[since..]));
        let first = level(&rows[..until], &values[..until]);
        let costs = costs(&name, conditions.records, records.get(..until).unwrap_or_default());
        Self { name, entries, alarms, first, now, trend, costs }
    }

    /// Whether its changes are announced.
    #[must_use]
    pub fn is_watched(&self) -> bool {
        self.name.group != Group::Tool
    }

    /// Whether a change is announced.
    #[must_use]
    pub fn has_changed(&self) -> bool {
        self.is_watched() && !self.alarms.is_empty()
    }

    /// The entry that a counted index means.
    #[must_use]
    pub fn counted(&self, index: usize) -> Option<&Entry> {
        of_counted(&self.entries).nth(index)
    }

    /// Number of figures that are counted.
    #[must_use]
    pub fn count(&self) -> usize {
        of_counted(&self.entries).count()
    }

    /// Index of the first counted figure since the last change.
    #[must_use]
    pub fn since(&self) -> usize {
        since(&self.alarms)
    }
}

fn since(alarms: &[Alarm]) -> usize {
    alarms.last().map_or(0, |alarm| alarm.change.first)
}

fn of_counted(entries: &[Entry]) -> impl Iterator<Item = &Entry> {
    entries.iter().filter(|entry| entry.is_counted)
}

/// The last value of a trend that is shown.
fn shown(trend: Option<&Trend>) -> Option<Estimate> {
    let trend = trend?;
    let [slope, half] = trend.per_day();
    let [value, half_width] = trend.at(trend.last_days);
    (slope.abs() > half).then_some(Estimate { value, half_width })
}

/// The mean at mean temperature.
fn level(rows: &[Vec<f64>], values: &[f64]) -> Option<Estimate> {
    let fit = Regression::of(rows, values);
    if let Some(fit) = fit.filter(|fit| fit.freedom > 0) {
        let mut row = vec![0.0; fit.coefficients.len()];
        row[0] = 1.0;
        return Some(Estimate { value: fit.at(&row), half_width: fit.half_width(&row) });
    }
    (!values.is_empty()).then(|| Estimate { value: mean(values.iter().copied()), half_width: f64::INFINITY })
}

/// Which figures are counted: those that are certain, with an interval not much wider than before.
fn counted(figures: Vec<(usize, Figure)>) -> Vec<Entry> {
    let mut half_widths: Vec<f64> = Vec::new();
    let entry = |(record, figure): (usize, Figure)| {
        let usual = median(&half_widths);
        let is_too_wide = figure.half_width.zip(usual).is_some_and(|(half, usual)| half > TOO_WIDE * usual);
        let is_counted = figure.trust.is_counted() && !is_too_wide;
        if is_counted {
            half_widths.extend(figure.half_width);
        }
        Entry { record, figure, is_counted }
    };
    figures.into_iter().map(entry).collect()
}

/// Mean cost of an effect before the first change, and its last cost, on the motion on which it costs most at the end.
fn costs(name: &Name, records: &[Record], before: &[usize]) -> Option<[Cost; 2]> {
    let key = (name.axis.clone(), name.of.clone());
    let last = records.iter().rev().find_map(|record| record.costs.get(&key))?;
    let same = before.iter().filter_map(|record| records[*record].costs.get(&key));
    let first: Vec<f64> = same.filter(|cost| cost.motion == last.motion).map(|cost| cost.um_rms).collect();
    let first = Cost { motion: last.motion.clone(), um_rms: mean(first) };
    (name.group == Group::Effect && first.um_rms.is_finite()).then(|| [first, last.clone()])
}
