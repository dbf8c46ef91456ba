//! Parquet files: flat columns of numbers, packed by Snappy or Zstandard or not at all.
//!
//! Pages packed by gzip, Brotli and LZ4 are not read: nothing would limit what they unpack to.

use std::panic::{self, AssertUnwindSafe};

use bytes::Bytes;
use files::error::{InputError, quoted};
use parquet::basic::{CompressionCodec, ConvertedType, LogicalType, TimeUnit, Type};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::RowGroupMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::budget::Budget;
use crate::table::ForeignColumn;

/// Rows that are read at once.
const BATCH: usize = 1 << 16;

/// Packings whose output is limited by the length that a page tells.
const PACKINGS: [CompressionCodec; 3] =
    [CompressionCodec::UNCOMPRESSED, CompressionCodec::SNAPPY, CompressionCodec::ZSTD];

/// Reads the columns of numbers; others are told.
///
/// The crate `parquet` 60 panics on some broken pages (in `byte_stream_split_decoder.rs`, for one): that is an error of the file here. The
/// message of the panic is not printed; the hook that prints it is exchanged while the file is read.
///
/// # Errors
/// If the file is broken, or unpacks to more than `budget`.
pub fn columns(
    bytes: &[u8],
    budget: Budget,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<ForeignColumn>, InputError> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let columns = panic::catch_unwind(AssertUnwindSafe(|| read(bytes, budget, source, notes)));
    panic::set_hook(hook);
    columns.unwrap_or_else(|_| Err(InputError::expected(source, "a Parquet file", "a broken page")))
}

fn read(
    bytes: &[u8],
    budget: Budget,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<ForeignColumn>, InputError> {
    let reader =
        SerializedFileReader::new(Bytes::copy_from_slice(bytes)).map_err(|cause| broken(source, &cause))?;
    let mut chunks = reader.metadata().row_groups().iter().flat_map(RowGroupMetaData::columns);
    if let Some(other) = chunks.find(|chunk| !PACKINGS.contains(&chunk.compression_codec())) {
        let found = format!("{:?}", other.compression_codec());
        return Err(InputError::expected(
            source,
            "columns that are packed by Snappy, Zstandard or not at all",
            found,
        ));
    }
    let mut reading = Reading { budget, source };
    let mut columns = Vec::new();
    for (index, column) in reader.metadata().file_metadata().schema_descr().columns().iter().enumerate() {
        let name = column.path().string();
        match why_not(column) {
            None => {
                let values = reading.column(&reader, index, column.max_def_level())?;
                columns.push(ForeignColumn::new(name, time_unit(column).map(str::to_owned), values));
            }
            Some(what) => notes.push(format!("not read: {}, {what}", quoted(&name))),
        }
    }
    Ok(columns)
}

fn broken(source: &str, cause: &ParquetError) -> InputError {
    InputError::expected(source, "a Parquet file", cause)
}

/// What a column is that is not read.
fn why_not(column: &ColumnDescriptor) -> Option<&'static str> {
    match column.physical_type() {
        _ if column.max_rep_level() > 0 => Some("a list"),
        _ if column.converted_type() == ConvertedType::DECIMAL => Some("decimals"),
        Type::BOOLEAN | Type::INT32 | Type::INT64 | Type::FLOAT | Type::DOUBLE => None,
        _ => Some("no numbers"),
    }
}

/// Unit of a column of dates.
fn time_unit(column: &ColumnDescriptor) -> Option<&'static str> {
    match column.logical_type_ref() {
        Some(LogicalType::Timestamp(time)) => Some(match time.unit {
            TimeUnit::MILLIS => "ms",
            TimeUnit::MICROS => "us",
            TimeUnit::NANOS => "ns",
        }),
        _ => match column.converted_type() {
            ConvertedType::TIMESTAMP_MILLIS => Some("ms"),
            ConvertedType::TIMESTAMP_MICROS => Some("us"),
            _ => None,
        },
    }
}

struct Reading<'a> {
    budget: Budget,
    source: &'a str,
}

impl Reading<'_> {
    /// All values of a column; `most` is the level of definition of a value that is there.
    fn column(
        &mut self,
        reader: &SerializedFileReader<Bytes>,
        index: usize,
        most: i16,
    ) -> Result<Vec<f64>, InputError> {
        let mut values = Vec::new();
        for group in 0..reader.num_row_groups() {
            let chunk = reader.get_row_group(group).and_then(|group| group.get_column_reader(index));
            let chunk = chunk.map_err(|cause| broken(self.source, &cause))?;
            let mut part = match chunk {
                ColumnReader::BoolColumnReader(chunk) => {
                    self.chunk(chunk, most, |&value| f64::from(u8::from(value)))
                }
                ColumnReader::Int32ColumnReader(chunk) => self.chunk(chunk, most, |&value| f64::from(value)),
                ColumnReader::Int64ColumnReader(chunk) => self.chunk(chunk, most, |&value| value as f64),
                ColumnReader::FloatColumnReader(chunk) => self.chunk(chunk, most, |&value| f64::from(value)),
                ColumnReader::DoubleColumnReader(chunk) => self.chunk(chunk, most, |&value| value),
                _ => Ok(Vec::new()),
            }?;
            values.append(&mut part);
        }
        Ok(values)
    }

    /// The values of a chunk, NaN where there is none.
    fn chunk<T: DataType>(
        &mut self,
        mut chunk: ColumnReaderImpl<T>,
        most: i16,
        number: impl Fn(&T::T) -> f64,
    ) -> Result<Vec<f64>, InputError> {
        let mut values = Vec::new();
        loop {
            let (mut read, mut levels) = (Vec::new(), Vec::new());
            let count = chunk.read_records(BATCH, Some(&mut levels), None, &mut read);
            let (count, ..) = count.map_err(|cause| broken(self.source, &cause))?;
            if count == 0 {
                return Ok(values);
            }
            self.budget.spend(8 * count as u64, self.source)?;
            let mut read = read.iter().map(&number);
            if most == 0 {
                values.extend(read);
            } else {
                let value = |level: &i16| if *level == most { read.next() } else { None };
                values.extend(levels.iter().map(value).map(|value| value.unwrap_or(f64::NAN)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use parquet::basic::Compression;
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;
    use parquet::schema::parser::parse_message_type;

    use super::*;

    /// Two groups of rows: times in µs, a position of which the second value is missing, a name.
    fn file() -> Vec<u8> {
        let schema = "message m { required int64 t (TIMESTAMP(MICROS,true)); optional double x; required binary what (UTF8); }";
        let schema = Arc::new(parse_message_type(schema).unwrap());
        let properties = Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, schema, properties).unwrap();
        for start in [0, 3000] {
            let mut group = writer.next_row_group().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            column
                .typed::<Int64Type>()
                .write_batch(&[start, start + 1000, start + 2000], None, None)
                .unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<DoubleType>().write_batch(&[0.1, 0.3], Some(&[1, 0, 1]), None).unwrap();
            column.close().unwrap();
            let mut column = group.next_column().unwrap().unwrap();
            let name = ByteArray::from("a");
            column
                .typed::<ByteArrayType>()
                .write_batch(&[name.clone(), name.clone(), name], None, None)
                .unwrap();
            column.close().unwrap();
            group.close().unwrap();
        }
        writer.close().unwrap();
        bytes
    }

    #[test]
    fn groups_of_rows_times_and_empty_cells_are_read() {
        let mut notes = Vec::new();
        let columns = columns(&file(), Budget::file(), "a.parquet", &mut notes).unwrap();
        assert_eq!((columns[0].name.as_str(), columns[0].unit.as_deref()), ("t", Some("us")));
        assert_eq!(columns[0].values, [0.0, 1e3, 2e3, 3e3, 4e3, 5e3]);
        let x = &columns[1].values;
        let whole: Vec<f64> = x.iter().copied().filter(|x| !x.is_nan()).collect();
        assert_eq!(whole, [0.1, 0.3, 0.1, 0.3]);
        assert!(x[1].is_nan() && x[4].is_nan() && x.len() == 6 && columns.len() == 2);
        assert_eq!(notes, ["not read: \"what\", no numbers"]);
    }

    #[test]
    fn the_size_is_limited_and_a_broken_file_is_an_error() {
        let bytes = file();
        let error = |bytes: &[u8], budget| {
            columns(bytes, budget, "a.parquet", &mut Vec::new()).unwrap_err().to_string()
        };
        assert!(error(&bytes, Budget::new(64)).contains("at most 64 bytes, unpacked"));
        for end in 0..bytes.len() {
            let message = error(&bytes[..end], Budget::file());
            assert!(message.contains("a Parquet file") && message.lines().count() == 1, "{end}: {message}");
        }
    }
}
