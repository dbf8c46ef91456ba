//! Rows at any times as samples of a uniform clock.
//!
//! Rows that repeat a time are left out; few lost rows are bridged by straight lines; where many are lost, the longest part without such
//! a gap is taken; rows at uneven times are interpolated. Each is counted, and the samples that are no measurement are marked.

use std::ops::Range;

use files::error::InputError;
use files::log::{AxisLog, Channel, Log, Rows, TIME};
use files::table::MAX_MEASURED;

use crate::columns::{Chosen, ChosenChannel, TimeColumn};
use crate::conversion::Conversion;
use crate::format::Format;
use crate::integral;
use crate::table::{ForeignColumn, ForeignTable};

/// Greatest number of lost rows in a place that a straight line bridges: at 1 kHz 10 ms, in which an axis at 1 m/s² departs from it by
/// 12 µm.
const BRIDGED: usize = 10;

/// Deviation from the uniform clock, in samples, from which a row is late or early. Times printed with one more digit than the period
/// deviate by less.
const LATE: f64 = 0.1;

/// Greatest part of samples that may be late or early and are left out; of a clock that is uneven throughout, nothing would be left.
const MOST_LATE: f64 = 0.2;

/// Greatest part of rows that may repeat a time.
const MOST_REPEATED: f64 = 0.2;

/// Makes a log of the chosen columns.
///
/// # Errors
/// If there is no time and no rate, or the times are not those of rows in their order.
pub fn uniform(
    table: &ForeignTable,
    chosen: Chosen,
    rate_hz: Option<f64>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Log, InputError> {
    let times_s = times_s(table, &chosen, rate_hz, source)?;
    let rows = valid_rows(table, &chosen, &times_s, source, notes)?;
    let too_few = |count| InputError::expected(source, "two rows at different times or more", count);
    if rows.len() < 2 {
        return Err(too_few(rows.len()));
    }
    let grid = Grid::of(&times_s, &rows, notes);
    if grid.rows.len() < 2 {
        return Err(too_few(grid.rows.len()));
    }
    let rate = grid.period_s.recip();
    notes.push(format!("{} samples at {rate:.6} Hz: sample_rate_hz of the machine file", grid.samples()));
    let mut axes: Vec<AxisLog> = Vec::new();
    for column in chosen.channels {
        let values = grid.sampled(&table.columns[column.column].values);
        let values: Vec<f64> = values.into_iter().map(|value| column.conversion.factor * value).collect();
        let values = if column.conversion.is_rate { integral::of(&values, grid.period_s) } else { values };
        let is_measured = |value: f64| value.is_finite() && value.abs() <= MAX_MEASURED;
        if let Some(value) = values.iter().find(|value| !is_measured(**value)) {
            let name = AxisLog::new(column.axis.as_str(), column.unit).column(column.channel);
            let expected = "numbers from −1e9 to 1e9 in the unit of the log (is --unit right?)";
            return Err(InputError::expected(source, expected, value).at_key(&name));
        }
        let known = axes.iter().position(|axis| axis.name == column.axis);
        let axis = known.unwrap_or_else(|| {
            axes.push(AxisLog::new(column.axis, column.unit));
            axes.len() - 1
        });
        *axes[axis].channel_mut(column.channel) = Some(values);
    }
    let start_s = times_s[grid.rows[0].row];
    let interpolated = grid.interpolated(notes);
    Ok(Log { interpolated, ..Log::new(source, start_s, grid.period_s, axes) })
}

/// Makes a log of the rows of one of ours whose times are uneven.
///
/// # Errors
/// If many times go back.
pub fn of_rows(rows: Rows, source: &str, notes: &mut Vec<String>) -> Result<Log, InputError> {
    let mut columns = vec![ForeignColumn::new(TIME.to_owned(), None, rows.times_s)];
    let mut channels = Vec::new();
    for mut of_axis in rows.axes {
        for channel in Channel::ALL {
            let Some(values) = of_axis.channel_mut(channel).take() else { continue };
            let conversion = Conversion { factor: 1.0, is_rate: false };
            let (axis, unit) = (of_axis.name.clone(), of_axis.unit);
            channels.push(ChosenChannel { axis, channel, unit, column: columns.len(), conversion });
            columns.push(ForeignColumn::new(String::new(), None, values));
        }
    }
    let table = ForeignTable { format: Format::Text, columns, period_s: None, header_line: Some(1) };
    let chosen = Chosen { time: Some(TimeColumn { column: 0, factor: Some(1.0) }), channels };
    uniform(&table, chosen, None, source, notes)
}

/// Number of rows of the chosen columns, which are of equal length.
fn rows(table: &ForeignTable, chosen: &Chosen) -> usize {
    chosen.channels.first().map_or(0, |channel| table.columns[channel.column].values.len())
}

/// The time of each row, s; NaN where its cell is empty.
fn times_s(
    table: &ForeignTable,
    chosen: &Chosen,
    rate_hz: Option<f64>,
    source: &str,
) -> Result<Vec<f64>, InputError> {
    let period_s = rate_hz.map(f64::recip).or(table.period_s);
    let needed = || {
        let expected = "a column of times (--map time_s=THEIRS), or --rate HZ";
        InputError::expected(source, expected, "neither")
    };
    if let Some(time) = chosen.time {
        let factor = time.factor.map_or_else(|| period_s.ok_or_else(needed), Ok)?;
        return Ok(table.columns[time.column].values.iter().map(|value| factor * value).collect());
    }
    let period_s = period_s.ok_or_else(needed)?;
    Ok((0..rows(table, chosen)).map(|row| period_s * row as f64).collect())
}

/// The rows that have all values, at times that increase.
fn valid_rows(
    table: &ForeignTable,
    chosen: &Chosen,
    times_s: &[f64],
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<usize>, InputError> {
    let columns = || chosen.channels.iter().map(|channel| &table.columns[channel.column].values);
    let is_whole = |&row: &usize| times_s[row].is_finite() && columns().all(|column| column[row].is_finite());
    let all = rows(table, chosen);
    let whole: Vec<usize> = (0..all).filter(is_whole).collect();
    let incomplete = all - whole.len();
    if incomplete > 0 {
        notes.push(format!("{incomplete} of {all} rows have an empty cell and are left out"));
    }
    let mut rows: Vec<usize> = Vec::new();
    let count = whole.len();
    for row in whole {
        if rows.last().is_none_or(|&last| times_s[row] > times_s[last]) {
            rows.push(row);
        }
    }
    let repeated = count - rows.len();
    if repeated as f64 > MOST_REPEATED * count as f64 {
        let found = format!("{repeated} of {count} that repeat a time or go back");
        return Err(InputError::expected(source, "rows in the order of their times", found));
    }
    if repeated > 0 {
        notes.push(format!("{repeated} of {count} rows repeat a time or go back, and are left out"));
    }
    Ok(rows)
}

/// A row on a uniform clock.
struct PlacedRow {
    /// Its number in the table.
    row: usize,
    /// The sample that it is nearest to, counted from the first.
    sample: usize,
    /// Its time, in samples.
    position: f64,
}

impl PlacedRow {
    /// Whether it is late or early.
    fn is_late(&self) -> bool {
        (self.position - self.sample as f64).abs() > LATE
    }
}

/// A uniform clock with the rows that it has.
struct Grid {
    period_s: f64,
    rows: Vec<PlacedRow>,
    /// Number of rows that are late or early.
    late: usize,
}

impl Grid {
    fn of(times_s: &[f64], rows: &[usize], notes: &mut Vec<String>) -> Self {
        let steps: Vec<f64> = rows.windows(2).map(|two| times_s[two[1]] - times_s[two[0]]).collect();
        let median_s = numerics::median(&steps).unwrap_or(1.0);
        let part = longest_part(&steps, median_s);
        let left_out = rows.len() - part.len();
        if left_out > 0 {
            notes.push(format!(
                "more than {BRIDGED} rows are lost in one place: the longest part without such a gap is taken, from {:.3} to {:.3} s; \
                 {left_out} rows are left out",
                times_s[rows[part.start]],
                times_s[rows[part.end - 1]]
            ));
        }
        let rows = &rows[part];
        let whole_steps = |two: &[usize]| ((times_s[two[1]] - times_s[two[0]]) / median_s).round().max(1.0);
        let samples: f64 = rows.windows(2).map(whole_steps).sum();
        let [first_s, last_s] = [times_s[rows[0]], times_s[rows[rows.len() - 1]]];
        let period_s = if samples > 0.0 { (last_s - first_s) / samples } else { median_s };
        let mut placed: Vec<PlacedRow> = Vec::new();
        for &row in rows {
            let position = (times_s[row] - first_s) / period_s;
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "from zero to the number of samples"
            )]
            let sample = position.round() as usize;
            if placed.last().is_none_or(|last| sample > last.sample) {
                placed.push(PlacedRow { row, sample, position });
            }
        }
        let late = placed.iter().filter(|row| row.is_late()).count();
        if late > 0 {
            notes.push(format!(
                "{late} of {} rows are late or early by more than {LATE} samples: interpolated",
                placed.len()
            ));
        }
        let grid = Self { period_s, rows: placed, late };
        let lost = grid.samples() - grid.rows.len();
        if lost > 0 {
            notes.push(format!(
                "{lost} of {} rows are lost and bridged by straight lines, which take no part in a trace",
                grid.samples()
            ));
        }
        grid
    }

    /// Number of samples from the first to the last row.
    fn samples(&self) -> usize {
        self.rows.last().map_or(0, |last| last.sample + 1)
    }

    /// The samples that are no measurement: those without a row, and, unless they are many, those whose row is late or early.
    fn interpolated(&self, notes: &mut Vec<String>) -> Vec<Range<usize>> {
        let is_late_throughout = self.late as f64 > MOST_LATE * self.rows.len() as f64;
        let mut is_measured = vec![false; self.samples()];
        for row in self.rows.iter().filter(|row| is_late_throughout || !row.is_late()) {
            is_measured[row.sample] = true;
        }
        if is_late_throughout {
            notes.push(
                "so many rows are late or early that their interpolated values take part in a trace"
                    .to_owned(),
            );
        } else if self.late > 0 {
            notes.push("the rows that are late or early take no part in a trace".to_owned());
        }
        let mut ranges: Vec<Range<usize>> = Vec::new();
        for sample in (0..is_measured.len()).filter(|&sample| !is_measured[sample]) {
            match ranges.last_mut() {
                Some(last) if last.end == sample => last.end += 1,
                _ => ranges.push(sample..sample + 1),
            }
        }
        // A longer range has rows, which are late.
        ranges.retain(|range| range.len() <= BRIDGED);
        ranges
    }

    /// The values of a column at the samples.
    fn sampled(&self, values: &[f64]) -> Vec<f64> {
        // Where a row is, in samples.
        let at = |row: &PlacedRow| if self.late > 0 { row.position } else { row.sample as f64 };
        let mut next = 1;
        let value = |sample: usize| {
            while next + 1 < self.rows.len() && at(&self.rows[next]) < sample as f64 {
                next += 1;
            }
            let (before, after) = (&self.rows[next - 1], &self.rows[next]);
            let share = ((sample as f64 - at(before)) / (at(after) - at(before))).clamp(0.0, 1.0);
            (1.0 - share) * values[before.row] + share * values[after.row]
        };
        (0..self.samples()).map(value).collect()
    }
}

/// The longest range of rows between gaps that are not bridged; `steps`: from each row to the next.
fn longest_part(steps: &[f64], median_s: f64) -> Range<usize> {
    let limit_s = (BRIDGED as f64 + 1.5) * median_s;
    let mut longest = 0..0;
    let mut start = 0;
    for end in 0..=steps.len() {
        if end == steps.len() || steps[end] > limit_s {
            if end + 1 - start > longest.len() {
                longest = start..end + 1;
            }
            start = end + 1;
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use crate::{Imported, Request, of_bytes};

    fn imported(text: &str, rate_hz: Option<f64>) -> Result<Imported, String> {
        let mappings = vec!["x_motor_mm=x".parse().unwrap()];
        of_bytes(text.as_bytes(), "a.csv", &Request { mappings, rate_hz, ..Request::default() })
            .map_err(|error| error.to_string())
    }

    /// A line of 3 mm/s at 1 kHz, printed to 0.1 µm, with some of its rows.
    fn line(keep: impl Fn(usize) -> bool, late_ms: impl Fn(usize) -> f64) -> String {
        let rows = (0..400).filter(|&i| keep(i)).map(|i| {
            let t_ms = i as f64 + late_ms(i);
            format!("{t_ms:.4},{:.6}\n", 3e-3 * t_ms)
        });
        format!("t (ms),x\n{}", rows.collect::<String>())
    }

    /// Whether the samples are those of the line.
    fn assert_on_line(imported: &Imported, samples: usize, first_mm: f64) {
        let x = imported.log.axes[0].motor.as_ref().unwrap();
        assert_eq!(x.len(), samples, "{:?}", imported.notes);
        assert!((imported.log.sample_time_s - 1e-3).abs() < 1e-9, "{}", imported.log.sample_time_s);
        for (i, x) in x.iter().enumerate() {
            assert!((x - first_mm - 3e-3 * i as f64).abs() < 2e-6, "{i}: {x}");
        }
    }

    fn has(imported: &Imported, note: &str) -> bool {
        imported.notes.iter().any(|other| other.contains(note))
    }

    #[test]
    fn lost_rows_are_bridged_and_counted() {
        let imported = imported(&line(|i| i % 97 != 5, |_| 0.0), None).unwrap();
        assert_on_line(&imported, 400, 0.0);
        assert!(has(&imported, "5 of 400 rows are lost and bridged"), "{:?}", imported.notes);
    }

    #[test]
    fn rows_at_uneven_times_are_interpolated() {
        let jitter = |i: usize| 0.3 * ((i * 7919) % 101) as f64 / 101.0;
        let jitter = |i: usize| if i == 0 || i == 399 { 0.0 } else { jitter(i) };
        let imported = imported(&line(|_| true, jitter), None).unwrap();
        assert_on_line(&imported, 400, 0.0);
        assert!(has(&imported, "late or early"), "{:?}", imported.notes);
    }

    #[test]
    fn repeated_rows_are_left_out() {
        let text = line(|_| true, |_| 0.0);
        let doubled: String = text.lines().enumerate().fold(String::new(), |all, (i, line)| {
            let again = if i > 0 && i % 50 == 0 { format!("{line}\n") } else { String::new() };
            all + line + "\n" + &again
        });
        let imported = imported(&doubled, None).unwrap();
        assert_on_line(&imported, 400, 0.0);
        assert!(has(&imported, "8 of 408 rows repeat a time"), "{:?}", imported.notes);
    }

    #[test]
    fn beyond_a_long_gap_the_longest_part_is_taken() {
        let imported = imported(&line(|i| !(100..150).contains(&i), |_| 0.0), None).unwrap();
        assert_on_line(&imported, 250, 0.45);
        assert!((imported.log.start_s - 0.15).abs() < 1e-12);
        assert!(has(&imported, "100 rows are left out"), "{:?}", imported.notes);
    }

    /// No row has both values.
    #[test]
    fn rows_that_are_all_incomplete_are_an_error() {
        let message = imported("t,x,z\n0,,1\n,1,2\n1,,3\n,2,4\n", None).unwrap_err();
        assert!(message.contains("two rows at different times or more, found 0"), "{message}");
    }

    #[test]
    fn without_times_the_rate_is_asked_for() {
        let rows: String = (0..400).map(|i| format!("{:.6}\n", 3e-3 * f64::from(i))).collect();
        let text = format!("x\n{rows}");
        assert!(imported(&text, None).unwrap_err().contains("--rate HZ"));
        assert_on_line(&imported(&text, Some(1000.0)).unwrap(), 400, 0.0);
    }
}
