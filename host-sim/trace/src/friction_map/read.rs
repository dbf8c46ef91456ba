//! Reading a friction map: strict, so that nothing is computed from a table that is not what it seems.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord};

use super::{FrictionMap, Run, Unit};
use files::error::{InputError, quoted};
use files::log::read::{checked_text, table_bytes};
use files::number;

const ALLOWED: &str = "speed_rpm and torque_mnm, with speed_sd_rpm, torque_sd_mnm and samples where known; \
                       or velocity_mm_s and force_n, with velocity_sd_mm_s, force_sd_n and samples";

/// The columns of one unit: speed, force, their deviations.
const COLUMNS: [(Unit, [&str; 4]); 2] = [
    (Unit::Rotary, ["speed_rpm", "torque_mnm", "speed_sd_rpm", "torque_sd_mnm"]),
    (Unit::Linear, ["velocity_mm_s", "force_n", "velocity_sd_mm_s", "force_sd_n"]),
];

const SAMPLES: &str = "samples";

impl FrictionMap {
    /// Reads a map from a CSV file, packed or not; `-` is standard input.
    ///
    /// # Errors
    /// If it cannot be read, is no table of the known columns, or holds too few runs.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = path.display().to_string();
        Self::parse(&table_bytes(path, &source)?, &source)
    }

    /// Reads a map from the bytes of a CSV file; `source` is for messages.
    ///
    /// # Errors
    /// If it is no table of the known columns, or holds too few runs.
    pub fn parse(bytes: &[u8], source: &str) -> Result<Self, InputError> {
        let text = checked_text(bytes, source)?;
        let mut rows = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut header: Option<Header> = None;
        let mut runs = Vec::new();
        let mut record = StringRecord::new();
        loop {
            let more = rows.read_record(&mut record);
            if !more.map_err(|error| InputError::saying(source, error.to_string()))? {
                break;
            }
            let start = record.position().map_or(0, csv::Position::byte);
            let line = line_of(text, usize::try_from(start).unwrap_or(usize::MAX));
            match &header {
                None => header = Some(Header::parse(source, &record).map_err(|error| error.at_line(line))?),
                Some(header) => runs.push(header.run(source, &record).map_err(|error| error.at_line(line))?),
            }
        }
        let unit = header.map_or(Unit::Linear, |header| header.unit);
        Self::new(source, unit, runs)
    }
}

/// The line of a row that begins at a byte: blank lines in front of it are skipped.
fn line_of(text: &str, start: usize) -> usize {
    let bytes = text.as_bytes();
    let start = start.min(bytes.len());
    let blank = bytes[start..].iter().take_while(|byte| b"\r\n".contains(byte)).count();
    files::error::line_at(bytes, start + blank)
}

/// Which column holds what.
struct Header {
    unit: Unit,
    names: Vec<String>,
    speed: usize,
    force: usize,
    deviation: Option<usize>,
    samples: Option<usize>,
}

impl Header {
    fn parse(source: &str, record: &StringRecord) -> Result<Self, InputError> {
        let names: Vec<String> = record.iter().map(|name| name.trim().to_owned()).collect();
        let place = |name: &str| names.iter().position(|n| n == name);
        let known = |name: &str| name == SAMPLES || COLUMNS.iter().any(|(_, all)| all.contains(&name));
        if let Some(name) = names.iter().find(|name| !known(name)) {
            return Err(InputError::expected(source, format!("columns {ALLOWED}"), quoted(name)));
        }
        if let Some((i, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
            return Err(InputError::expected(source, "each column once", quoted(name))
                .at_key(&format!("column {}", i + 1)));
        }
        let given = |all: &[&str; 4]| names.iter().find(|name| all.contains(&name.as_str()));
        if let [(_, rotary), (_, linear)] = &COLUMNS
            && let (Some(a), Some(b)) = (given(rotary), given(linear))
        {
            return Err(InputError::expected(source, "columns of one unit", format!("{a} beside {b}")));
        }
        let (unit, columns) = COLUMNS.into_iter().find(|(_, all)| given(all).is_some()).unwrap_or(COLUMNS[0]);
        let [speed, force] = [columns[0], columns[1]].map(|name| {
            place(name).ok_or_else(|| InputError::expected(source, "this column", "none").at_key(name))
        });
        let (speed, force) = (speed?, force?);
        let (deviation, samples) = (place(columns[3]), place(SAMPLES));
        Ok(Self { unit, names, speed, force, deviation, samples })
    }

    fn run(&self, source: &str, record: &StringRecord) -> Result<Run, InputError> {
        if record.len() != self.names.len() {
            let what = format!("{} values as in the header", self.names.len());
            return Err(InputError::expected(source, what, record.len()));
        }
        let refuse = |i: usize, what: &str| {
            let found = number::found(record.get(i).unwrap_or_default().as_bytes());
            InputError::expected(source, what, found).at_key(&self.names[i])
        };
        let mut values = Vec::with_capacity(record.len());
        for (i, (field, name)) in record.iter().zip(&self.names).enumerate() {
            let value = number::measured(field.trim().as_bytes()).map_err(|what| refuse(i, what))?;
            if name.contains("_sd_") && value < 0.0 {
                return Err(refuse(i, "a number not below 0"));
            }
            if name == SAMPLES && value < 1.0 {
                return Err(refuse(i, "a number of at least 1"));
            }
            values.push(value);
        }
        let deviation = self.deviation.map(|i| values[i]);
        let samples = self.samples.map(|i| values[i]);
        let error = deviation.zip(samples).map(|(deviation, samples)| deviation / samples.sqrt());
        Ok(Run { velocity: values[self.speed], force: values[self.force], deviation, error })
    }
}
