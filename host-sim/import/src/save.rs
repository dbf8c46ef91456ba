//! Writing a log in the format that the name of the file says: CSV, Parquet or MCAP.

use std::collections::BTreeMap;
use std::error::Error;
use std::io::{self, Cursor};
use std::path::Path;
use std::sync::Arc;

use files::log::{Channel, Log, TIME};
use files::output::{OutputError, write_whole};
use indexmap::IndexMap;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use parquet::basic::Compression as Packing;
use parquet::data_type::DoubleType;
use parquet::errors::Result as ParquetResult;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

/// Topic of the messages of a log.
const TOPIC: &str = "log";

/// Writes a log completely or not at all: as Parquet (`.parquet`), as MCAP (`.mcap`), or else as CSV (packed if `.gz`).
///
/// Parquet and MCAP have the columns of the CSV, with all digits.
///
/// # Errors
/// If the file cannot be written.
pub fn write(log: &Log, path: &Path) -> Result<(), OutputError> {
    let has = |name: &str| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(name));
    let packed = match () {
        () if has("parquet") => parquet(log).map_err(io::Error::other),
        () if has("mcap") => mcap(log).map_err(io::Error::other),
        () => return log.write(path),
    };
    write_whole(path, |out| out.write_all(&packed?))
}

/// Name and values of each column of a log, without the samples that were interpolated.
fn columns(log: &Log) -> Vec<(String, Vec<f64>)> {
    let measured: Vec<usize> = (0..log.len()).filter(|&sample| log.is_measured(sample)).collect();
    let times_s = measured.iter().map(|&sample| log.time_s(sample)).collect();
    let mut columns = vec![(TIME.to_owned(), times_s)];
    for axis in &log.axes {
        let channels = Channel::ALL
            .into_iter()
            .filter_map(|channel| Some((axis.column(channel), axis.channel(channel)?)));
        let of_rows = |values: &[f64]| measured.iter().map(|&sample| values[sample]).collect();
        columns.extend(channels.map(|(name, values)| (name, of_rows(values))));
    }
    columns
}

/// A log as Parquet: one group of rows, packed by Snappy.
fn parquet(log: &Log) -> ParquetResult<Vec<u8>> {
    let columns = columns(log);
    let fields: String = columns.iter().map(|(name, _)| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message log {{ {fields} }}"))?);
    let properties = WriterProperties::builder()
        .set_created_by("lost-motion".to_owned())
        .set_compression(Packing::SNAPPY)
        // Measured values rarely repeat.
        .set_dictionary_enabled(false)
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut values = columns.iter().map(|(_, values)| values);
    while let (Some(mut column), Some(values)) = (group.next_column()?, values.next()) {
        column.typed::<DoubleType>().write_batch(values, None, None)?;
        column.close()?;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

/// A log as MCAP: a message in JSON for each row, logged at its time. A log whose clock starts before zero, which times of MCAP cannot,
/// is logged from zero on; its column of times is unchanged.
fn mcap(log: &Log) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
    let columns = columns(log);
    let mut writer = WriteOptions::new()
        .library("lost-motion")
        .compression(Some(Compression::Zstd))
        // The same bytes on any number of processors.
        .compression_threads(0)
        .create(Cursor::new(Vec::new()))?;
    let number = serde_json::json!({ "type": "number" });
    let properties: serde_json::Map<_, _> =
        columns.iter().map(|(name, _)| (name.clone(), number.clone())).collect();
    let schema = serde_json::json!({ "title": TOPIC, "type": "object", "properties": properties });
    let schema = writer.add_schema(TOPIC, "jsonschema", &serde_json::to_vec(&schema)?)?;
    let channel_id = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
    let offset_s = log.start_s.min(0.0);
    for (row, time_s) in columns[0].1.iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from zero on; saturates"
        )]
        let log_time = ((time_s - offset_s) * 1e9).round() as u64;
        let sequence = u32::try_from(row).unwrap_or(u32::MAX);
        let message: IndexMap<&str, f64> =
            columns.iter().map(|(name, values)| (name.as_str(), values[row])).collect();
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, &serde_json::to_vec(&message)?)?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

#[cfg(test)]
mod tests {
    use files::log::{AxisLog, Unit};

    use super::*;
    use crate::of_bytes;
    use crate::request::Request;

    /// Values without a short decimal form, at 8192 Hz from `start_s`.
    fn log(start_s: f64) -> Log {
        let values = |factor: f64| Some((0..500).map(|i| factor * (0.37 * f64::from(i)).sin()).collect());
        let mut x = AxisLog::new("x", Unit::Millimetre);
        (x.command, x.motor, x.force) = (values(250.0), values(1.0 / 3.0), values(1e-7));
        let mut c = AxisLog::new("c", Unit::Degree);
        c.added_force = values(1e8);
        Log::new("log", start_s, 1.0 / 8192.0, [x, c])
    }

    fn read(bytes: &[u8]) -> Log {
        of_bytes(bytes, "log", &Request::default()).unwrap().log
    }

    #[test]
    fn what_is_written_is_read_back_to_the_bit() {
        for start_s in [0.0, 17.25, -1.5] {
            let log = log(start_s);
            for bytes in [parquet(&log).unwrap(), mcap(&log).unwrap()] {
                let found = read(&bytes);
                assert_eq!(found.start_s.to_bits(), log.start_s.to_bits());
                // The period is that of the last time.
                assert!(
                    (found.sample_time_s / log.sample_time_s - 1.0).abs() < 1e-13,
                    "{}",
                    found.sample_time_s
                );
                assert!(found.axes == log.axes, "{start_s}");
            }
        }
    }

    #[test]
    fn the_same_log_gives_the_same_bytes() {
        let log = log(0.0);
        assert!(
            parquet(&log).unwrap() == parquet(&log).unwrap() && mcap(&log).unwrap() == mcap(&log).unwrap()
        );
    }

    #[test]
    fn the_name_of_the_file_says_the_format() {
        let folder = tempfile::tempdir().unwrap();
        for (name, start) in
            [("a.parquet", &b"PAR1"[..]), ("a.MCAP", b"\x89MCAP"), ("a.csv", b"time_s,x_command_mm")]
        {
            let path = folder.path().join(name);
            write(&log(0.0), &path).unwrap();
            assert!(std::fs::read(&path).unwrap().starts_with(start), "{name}");
        }
    }
}
