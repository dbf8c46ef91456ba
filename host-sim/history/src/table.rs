//! All figures of a history as Parquet: a row for each figure of each trace, with machine and serial number, so that the files of many
//! machines are one table.

use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int32Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;

use crate::History;
use crate::record::Record;
use crate::series::{Entry, Series};

const SCHEMA: &str = "message history {
    optional binary machine (UTF8);
    optional binary serial (UTF8);
    required int32 date (DATE);
    required binary file (UTF8);
    optional double temperature_c;
    required binary group (UTF8);
    required binary axis (UTF8);
    required binary of (UTF8);
    required binary key (UTF8);
    required double value;
    optional double half_width;
    required binary certainty (UTF8);
    required boolean is_counted;
    required boolean is_alarm;
}";

/// The file.
///
/// # Errors
/// If the values do not fit into the format.
pub fn parquet(history: &History) -> Result<Vec<u8>> {
    let schema = Arc::new(parse_message_type(SCHEMA)?);
    let properties = WriterProperties::builder()
        .set_created_by("lost-motion".to_owned())
        .set_compression(Compression::SNAPPY)
        .build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties))?;
    let rows: Vec<Row> = history.series.iter().flat_map(|series| rows(history, series)).collect();
    let mut group = writer.next_row_group()?;
    let text = |group: &mut _, of: &dyn Fn(&Row) -> String| {
        column::<ByteArrayType>(
            group,
            &rows.iter().map(|row| of(row).into_bytes().into()).collect::<Vec<_>>(),
        )
    };
    let optional_text = |group: &mut _, of: &dyn Fn(&Row) -> Option<String>| {
        let bytes = |row: &Row| of(row).map(|text| ByteArray::from(text.into_bytes()));
        optional::<ByteArrayType>(group, rows.iter().map(bytes).collect())
    };
    optional_text(&mut group, &|row| row.record.machine.clone())?;
    optional_text(&mut group, &|row| row.record.serial.clone())?;
    column::<Int32Type>(&mut group, &rows.iter().map(Row::epoch_days).collect::<Vec<_>>())?;
    text(&mut group, &|row| row.record.source.clone())?;
    optional::<DoubleType>(&mut group, rows.iter().map(|row| row.record.temperature_c).collect())?;
    text(&mut group, &|row| row.series.name.group.word().to_owned())?;
    text(&mut group, &|row| row.series.name.axis.clone())?;
    text(&mut group, &|row| row.series.name.of.clone())?;
    text(&mut group, &|row| row.series.name.key.clone())?;
    column::<DoubleType>(&mut group, &rows.iter().map(|row| row.entry.figure.value).collect::<Vec<_>>())?;
    optional::<DoubleType>(&mut group, rows.iter().map(|row| row.entry.figure.half_width).collect())?;
    text(&mut group, &|row| row.entry.figure.trust.word().to_owned())?;
    column::<BoolType>(&mut group, &rows.iter().map(|row| row.entry.is_counted).collect::<Vec<_>>())?;
    column::<BoolType>(&mut group, &rows.iter().map(|row| row.is_alarm).collect::<Vec<_>>())?;
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

struct Row<'a> {
    record: &'a Record,
    series: &'a Series,
    entry: &'a Entry,
    is_alarm: bool,
}

impl Row<'_> {
    /// Days since 1970-01-01.
    fn epoch_days(&self) -> i32 {
        (self.record.day - jiff::civil::Date::constant(1970, 1, 1)).get_days()
    }
}

fn rows<'a>(history: &'a History, series: &'a Series) -> impl Iterator<Item = Row<'a>> {
    let alarms: Vec<usize> =
        series.alarms.iter().filter_map(|alarm| series.counted(alarm.at).map(|entry| entry.record)).collect();
    series.entries.iter().map(move |entry| Row {
        record: &history.records[entry.record],
        series,
        entry,
        is_alarm: entry.is_counted && alarms.contains(&entry.record),
    })
}

type Group<'a, 'b> = SerializedRowGroupWriter<'a, &'b mut Vec<u8>>;

/// Writes a column without gaps.
fn column<T: DataType>(group: &mut Group, values: &[T::T]) -> Result<()> {
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(values, None, None)?;
        column.close()?;
    }
    Ok(())
}

/// Writes a column with gaps.
fn optional<T: DataType>(group: &mut Group, values: Vec<Option<T::T>>) -> Result<()> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    if let Some(mut column) = group.next_column()? {
        column.typed::<T>().write_batch(&values, Some(&levels), None)?;
        column.close()?;
    }
    Ok(())
}
