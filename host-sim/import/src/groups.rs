//! Columns of several clocks, or of several arrays, as rows of one clock.
//!
//! The clock is the fastest of those of the chosen columns. A column of another clock is interpolated at its times by straight lines;
//! before the first and after the last of its own times it has no value.

use files::error::{InputError, quoted};

use crate::columns::{Chosen, TimeColumn};
use crate::table::{ForeignColumn, ForeignTable};
use crate::unit::Quantity;

/// Gives the chosen columns equal length.
///
/// # Errors
/// If columns without times of their own differ in length, or a clock has fewer than two times.
pub fn join(
    table: &mut ForeignTable,
    chosen: &mut Chosen,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let clock_of = |column: usize| table.columns[column].times;
    let mut clocks: Vec<usize> =
        chosen.channels.iter().filter_map(|channel| clock_of(channel.column)).collect();
    clocks.sort_unstable();
    clocks.dedup();
    let shared = chosen.time.is_some_and(|time| {
        chosen.channels.iter().all(|channel| clock_of(channel.column) == clock_of(time.column))
    });
    if clocks.is_empty() || shared {
        return check_lengths(table, chosen, source);
    }
    let clocks: Vec<Clock> = clocks.into_iter().map(|column| Clock::of(table, column)).collect();
    let fastest =
        clocks.iter().filter(|clock| clock.step_s > 0.0).min_by(|a, b| a.step_s.total_cmp(&b.step_s));
    let Some(fastest) = fastest else {
        return Err(InputError::expected(source, "a column of times that increase", "none"));
    };
    for channel in &chosen.channels {
        let own = table.columns[channel.column].times;
        let Some(own) = clocks.iter().find(|clock| Some(clock.column) == own) else {
            let name = quoted(&table.columns[channel.column].name);
            return Err(InputError::expected(source, "columns with times", name));
        };
        if !own.is_same(fastest) {
            let column = &mut table.columns[channel.column];
            column.values = own.interpolated(&column.values, &fastest.times_s);
            notes.push(format!(
                "column {}, every {:.6} ms, is interpolated by straight lines at the times of another one, every {:.6} ms",
                quoted(&column.name),
                1e3 * own.step_s,
                1e3 * fastest.step_s
            ));
        }
    }
    chosen.time = Some(TimeColumn { column: fastest.column, factor: Some(fastest.factor) });
    Ok(())
}

/// Checks that the chosen columns are of equal length.
fn check_lengths(table: &ForeignTable, chosen: &Chosen, source: &str) -> Result<(), InputError> {
    let channels = chosen.channels.iter().map(|channel| channel.column);
    let mut columns =
        chosen.time.iter().map(|time| time.column).chain(channels).map(|column| &table.columns[column]);
    let Some(first) = columns.next() else { return Ok(()) };
    match columns.find(|other| other.values.len() != first.values.len()) {
        Some(other) => {
            let expected =
                format!("columns of equal length: {} has {} values", quoted(&first.name), first.values.len());
            Err(InputError::expected(source, expected, other.values.len()).at_key(&quoted(&other.name)))
        }
        None => Ok(()),
    }
}

/// A column of times.
struct Clock {
    column: usize,
    /// Seconds per unit of the column.
    factor: f64,
    times_s: Vec<f64>,
    /// Median of the positive steps, s; zero if there are none.
    step_s: f64,
}

impl Clock {
    fn of(table: &ForeignTable, column: usize) -> Self {
        let ForeignColumn { unit, values, .. } = &table.columns[column];
        let factor = unit.as_deref().and_then(|unit| Quantity::Time.factor(unit)).unwrap_or(1.0);
        let times_s: Vec<f64> = values.iter().map(|value| factor * value).collect();
        let steps: Vec<f64> =
            times_s.windows(2).map(|two| two[1] - two[0]).filter(|step| *step > 0.0).collect();
        let step_s = numerics::median(&steps).unwrap_or(0.0);
        Self { column, factor, times_s, step_s }
    }

    fn is_same(&self, other: &Self) -> bool {
        self.column == other.column || self.times_s == other.times_s
    }

    /// Values of this clock at other times, which need not be in order; NaN where this clock has none.
    fn interpolated(&self, values: &[f64], at_s: &[f64]) -> Vec<f64> {
        let mut known: Vec<(f64, f64)> = Vec::new();
        for (&time_s, &value) in self.times_s.iter().zip(values) {
            // A slow group is exported with its rows repeated, or with empty cells.
            if value.is_finite() && known.last().is_none_or(|(last_s, _)| time_s > *last_s) {
                known.push((time_s, value));
            }
        }
        let at = |&time_s: &f64| {
            let after = known.partition_point(|(known_s, _)| *known_s < time_s);
            match (known.get(after.wrapping_sub(1)), known.get(after)) {
                #[expect(clippy::float_cmp, reason = "a time that both clocks have")]
                (_, Some(&(known_s, value))) if known_s == time_s => value,
                (Some(&(before_s, before)), Some(&(after_s, after))) => {
                    before + (after - before) * (time_s - before_s) / (after_s - before_s)
                }
                _ => f64::NAN,
            }
        };
        at_s.iter().map(at).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::request::Request;
    use crate::{Imported, of_bytes};

    fn imported(text: &str, mappings: &[&str]) -> Result<Imported, String> {
        let mappings = mappings.iter().map(|mapping| mapping.parse().unwrap()).collect();
        of_bytes(text.as_bytes(), "a.csv", &Request { mappings, ..Request::default() })
            .map_err(|error| error.to_string())
    }

    /// Two groups on the lines x = 3·t and f = 5 − 2·t (t in ms): 1 ms from 0 to 199, and 4 ms from 0.5 ms on. By interpolation a line stays
    /// a
    /// line. Only the rows from the first to the last time of the slow group, 0.5 to 196.5 ms, have both.
    fn two_rates() -> String {
        let rows = (0..200).map(|i| {
            let (fast, slow) = (f64::from(i), 4.0 * f64::from(i) + 0.5);
            let slow = if i < 50 { format!("\t{slow}\t{}", 5.0 - 2.0 * slow) } else { String::new() };
            format!("{fast}\t{}{slow}\n", 3.0 * fast)
        });
        format!("Name\tx\tName\tf\n{}", rows.collect::<String>()).replace('.', ",")
    }

    #[test]
    fn a_slow_group_is_interpolated_at_the_times_of_a_fast_one() {
        let imported = imported(&two_rates(), &["x_motor_mm=x", "x_force_n=f"]).unwrap();
        let x = &imported.log.axes[0];
        let (motor, force) = (x.motor.as_ref().unwrap(), x.force.as_ref().unwrap());
        assert_eq!((motor.len(), force.len()), (196, 196));
        assert!(
            (imported.log.start_s - 1e-3).abs() < 1e-12 && (imported.log.sample_time_s - 1e-3).abs() < 1e-12
        );
        for (i, (motor, force)) in motor.iter().zip(force).enumerate() {
            let t_ms = 1.0 + i as f64;
            assert!((motor - 3.0 * t_ms).abs() < 1e-9 && (force - (5.0 - 2.0 * t_ms)).abs() < 1e-9, "{i}");
        }
        let is_said = |part: &str| imported.notes.iter().any(|note| note.contains(part));
        assert!(is_said("column \"f\", every 4.000000 ms, is interpolated"), "{:?}", imported.notes);
        assert!(is_said("4 of 200 rows have an empty cell"), "{:?}", imported.notes);
    }

    /// Mapped alone, the slow group keeps its own clock.
    #[test]
    fn only_clocks_that_are_used_count() {
        let imported = imported(&two_rates(), &["x_force_n=f"]).unwrap();
        assert_eq!(imported.log.len(), 50);
        assert!((imported.log.sample_time_s - 4e-3).abs() < 1e-12);
        assert!(imported.notes.iter().all(|note| !note.contains("interpolated")), "{:?}", imported.notes);
    }
}
