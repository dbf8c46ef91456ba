//! Reading a friction map.

use std::path::Path;

use super::map::{FrictionMap, Run, Unit};
use files::error::{InputError, quoted};
use files::table::{Row, Table};

/// The columns of both units, for error messages.
const ALLOWED: &str = "speed_rpm and torque_mnm, with speed_sd_rpm, torque_sd_mnm and samples where known; \
                       or velocity_mm_s and force_n, with velocity_sd_mm_s, force_sd_n and samples";

/// The columns of each unit: speed, force, and their standard deviations within a run.
const COLUMNS: [(Unit, [&str; 4]); 2] = [
    (Unit::Rotary, ["speed_rpm", "torque_mnm", "speed_sd_rpm", "torque_sd_mnm"]),
    (Unit::Linear, ["velocity_mm_s", "force_n", "velocity_sd_mm_s", "force_sd_n"]),
];

/// Column with the number of samples of a run.
const SAMPLES: &str = "samples";

impl FrictionMap {
    /// Reads a map from a CSV file, which may be compressed by gzip; `-` is standard input.
    ///
    /// # Errors
    /// If the file cannot be read, is not a table with the known columns, or contains too few runs.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = path.display().to_string();
        Self::of_table(Table::open(path, &source)?, &source)
    }

    /// Reads a map from the bytes of a CSV file; `source` names it in error messages.
    ///
    /// # Errors
    /// If it is not a table with the known columns, or contains too few runs.
    pub fn parse(bytes: &[u8], source: &str) -> Result<Self, InputError> {
        Self::of_table(Table::parse(bytes, source)?, source)
    }

    fn of_table(mut table: Table<'_>, source: &str) -> Result<Self, InputError> {
        let header = Header::parse(&table)?;
        let mut runs = Vec::new();
        while let Some(row) = table.next_row()? {
            runs.push(header.run(&row)?);
        }
        Self::new(source, header.unit, runs)
    }
}

/// Index of each column.
struct Header {
    unit: Unit,
    speed: usize,
    force: usize,
    speed_deviation: Option<usize>,
    force_deviation: Option<usize>,
    samples: Option<usize>,
    /// Number of columns.
    columns: usize,
}

impl Header {
    fn parse(table: &Table<'_>) -> Result<Self, InputError> {
        let names = table.names();
        let position = |name: &str| names.iter().position(|n| n == name);
        let known = |name: &str| name == SAMPLES || COLUMNS.iter().any(|(_, all)| all.contains(&name));
        if let Some(name) = names.iter().find(|name| !known(name)) {
            return Err(table.header_error(format!("columns {ALLOWED}"), quoted(name)));
        }
        if let Some((i, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            let error = table.header_error("each column once", quoted(name));
            return Err(error.at_key(&format!("column {}", i + 1)));
        }
        let first_of = |all: &[&str; 4]| names.iter().find(|name| all.contains(&name.as_str()));
        if let [(_, rotary), (_, linear)] = &COLUMNS
            && let (Some(a), Some(b)) = (first_of(rotary), first_of(linear))
        {
            return Err(table.header_error("columns of one unit", format!("{a} and {b}")));
        }
        let (unit, columns) =
            COLUMNS.into_iter().find(|(_, all)| first_of(all).is_some()).unwrap_or(COLUMNS[0]);
        let required =
            |name: &str| position(name).ok_or_else(|| table.header_error("this column", "none").at_key(name));
        Ok(Self {
            unit,
            speed: required(columns[0])?,
            force: required(columns[1])?,
            speed_deviation: position(columns[2]),
            force_deviation: position(columns[3]),
            samples: position(SAMPLES),
            columns: names.len(),
        })
    }

    fn run(&self, row: &Row<'_, '_>) -> Result<Run, InputError> {
        let value = |column: usize| {
            let value = row.measured(column)?;
            let is_deviation = [self.speed_deviation, self.force_deviation].contains(&Some(column));
            if is_deviation && value < 0.0 {
                return Err(row.cell_error(column, "a number not below 0"));
            }
            if self.samples == Some(column) && value < 1.0 {
                return Err(row.cell_error(column, "a number of at least 1"));
            }
            Ok(value)
        };
        let values: Vec<f64> = (0..self.columns).map(value).collect::<Result<_, _>>()?;
        let deviation = self.force_deviation.map(|column| values[column]);
        let samples = self.samples.map(|column| values[column]);
        let error = deviation.zip(samples).map(|(deviation, samples)| deviation / samples.sqrt());
        Ok(Run { velocity: values[self.speed], force: values[self.force], deviation, error })
    }
}
