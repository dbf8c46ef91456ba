//! MCAP files with messages in JSON, as PlotJuggler and Foxglove open them.
//!
//! Each number of a message is a column, `x` or `position.x` or `positions[0]`, of a file with several topics `TOPIC.x`. The times of a topic
//! are those at which its messages were logged. Messages in another encoding (Protobuf, CDR of ROS) are told and not read.

use std::collections::BTreeMap;

use files::error::{InputError, quoted};
use indexmap::IndexMap;
use mcap::McapError;
use mcap::io::MessageReader;
use mcap::sans_io::linear_reader::LinearReaderOptions;
use serde_json::Value;

use crate::budget::Budget;
use crate::mcap_chunks;
use crate::table::ForeignColumn;

/// Greatest length of a record, bytes; writers close a chunk after a few million.
const MOST_RECORD: usize = 1 << 26;

/// Greatest number of columns of a topic; what has more is a picture.
const MOST_COLUMNS: usize = 1000;

/// Greatest depth of objects in objects.
const MOST_DEPTH: usize = 8;

/// Reads the numbers of all messages.
///
/// # Errors
/// If the file is broken, or unpacks to more than `budget`.
pub fn columns(
    bytes: &[u8],
    mut budget: Budget,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<ForeignColumn>, InputError> {
    mcap_chunks::check(bytes, source)?;
    let options = LinearReaderOptions::default().with_record_length_limit(MOST_RECORD);
    let mut topics: IndexMap<String, Topic> = IndexMap::new();
    let mut others: BTreeMap<String, (String, usize)> = BTreeMap::new();
    for message in MessageReader::new_with_options(bytes, options) {
        let message =
            message.map_err(|cause: McapError| InputError::expected(source, "an MCAP file", cause))?;
        let name = &message.channel.topic;
        budget.spend(message.data.len() as u64, source)?;
        if message.channel.message_encoding != "json" {
            let encoding = message.channel.message_encoding.clone();
            others.entry(name.clone()).or_insert((encoding, 0)).1 += 1;
            continue;
        }
        // In the order of the message, which serde_json's own map would sort.
        let fields: IndexMap<String, Value> = serde_json::from_slice(&message.data)
            .map_err(|cause| InputError::expected(source, "messages in JSON", cause).at_key(&quoted(name)))?;
        let topic = topics.entry(name.clone()).or_default();
        // Times since the first message are exact, and those since 1970 are not.
        topic.times_ns.push(message.log_time as f64);
        fields.iter().for_each(|(name, value)| topic.add(value, &mut name.clone(), 1));
        // A cell for each column, as a message may lack some.
        budget.spend(8 * topic.columns.len() as u64, source)?;
    }
    for (name, (encoding, count)) in others {
        let encoding = if encoding.is_empty() { "no encoding".to_owned() } else { quoted(&encoding) };
        notes.push(format!("not read: topic {}, {count} messages in {encoding}", quoted(&name)));
    }
    let is_single = topics.len() == 1;
    let mut columns = Vec::new();
    for (name, topic) in topics {
        let prefix = if is_single { String::new() } else { format!("{name}.") };
        topic.finish(&name, &prefix, &mut columns);
    }
    Ok(columns)
}

/// The messages of a topic.
#[derive(Default)]
struct Topic {
    times_ns: Vec<f64>,
    columns: IndexMap<String, Vec<f64>>,
}

impl Topic {
    /// Adds the numbers of a message, whose time was added; `path` is the name of the value.
    fn add(&mut self, value: &Value, path: &mut String, depth: usize) {
        let number = match value {
            Value::Number(number) => number.as_f64(),
            Value::Bool(bool) => Some(f64::from(u8::from(*bool))),
            _ => None,
        };
        let before = path.len();
        let nested = |topic: &mut Self, path: &mut String, part: &str, value: &Value| {
            path.push_str(part);
            topic.add(value, path, depth + 1);
            path.truncate(before);
        };
        match value {
            Value::Object(fields) if depth < MOST_DEPTH => {
                fields.iter().for_each(|(name, value)| nested(self, path, &format!(".{name}"), value));
            }
            Value::Array(values) if depth < MOST_DEPTH => {
                let indexed = values.iter().enumerate().take(MOST_COLUMNS);
                indexed.for_each(|(index, value)| nested(self, path, &format!("[{index}]"), value));
            }
            _ => {
                if let Some(number) = number {
                    self.put(path, number);
                }
            }
        }
    }

    /// Puts a number into the row of the last time.
    fn put(&mut self, name: &str, number: f64) {
        let rows = self.times_ns.len();
        if let Some(column) = self.columns.get_mut(name) {
            column.resize(rows - 1, f64::NAN);
            column.push(number);
        } else if self.columns.len() < MOST_COLUMNS {
            let mut column = vec![f64::NAN; rows - 1];
            column.push(number);
            self.columns.insert(name.to_owned(), column);
        }
    }

    /// Appends its columns, and before them that of its times.
    fn finish(self, topic: &str, prefix: &str, columns: &mut Vec<ForeignColumn>) {
        let (times, rows) = (columns.len(), self.times_ns.len());
        let name = format!("times of {topic}");
        columns.push(ForeignColumn::new(name, Some("ns".to_owned()), self.times_ns));
        for (name, mut values) in self.columns {
            values.resize(rows, f64::NAN);
            let column = ForeignColumn::new(format!("{prefix}{name}"), None, values);
            columns.push(ForeignColumn { times: Some(times), ..column });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use mcap::records::MessageHeader;
    use mcap::{Compression, WriteOptions};

    use super::*;

    /// A file of messages: topic, encoding, time in ns, content.
    fn file(packing: Option<Compression>, messages: &[(&str, &str, u64, &[u8])]) -> Vec<u8> {
        let mut writer = WriteOptions::new().compression(packing).create(Cursor::new(Vec::new())).unwrap();
        for &(topic, encoding, log_time, data) in messages {
            let channel_id = writer.add_channel(0, topic, encoding, &BTreeMap::new()).unwrap();
            let header = MessageHeader { channel_id, sequence: 0, log_time, publish_time: log_time };
            writer.write_to_known_channel(&header, data).unwrap();
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }

    #[test]
    fn the_numbers_of_messages_are_columns() {
        let messages: [(&str, &str, u64, &[u8]); 5] = [
            ("/x", "json", 1000, br#"{"p": {"command": 1, "motor": 1.5}, "on": true, "name": "x"}"#),
            ("/t", "json", 1500, br#"{"v": [20, 21]}"#),
            ("/x", "json", 2000, br#"{"p": {"command": 2}}"#),
            ("/raw", "cdr", 2500, b"\x00\x01"),
            ("/x", "json", 3000, br#"{"p": {"command": 3, "motor": 3.5}}"#),
        ];
        for packing in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
            let mut notes = Vec::new();
            let columns = columns(&file(packing, &messages), Budget::file(), "a.mcap", &mut notes).unwrap();
            let names: Vec<_> = columns.iter().map(|column| (column.name.as_str(), column.times)).collect();
            assert_eq!(
                names,
                [
                    ("times of /x", None),
                    ("/x.p.command", Some(0)),
                    ("/x.p.motor", Some(0)),
                    ("/x.on", Some(0)),
                    ("times of /t", None),
                    ("/t.v[0]", Some(4)),
                    ("/t.v[1]", Some(4)),
                ]
            );
            assert_eq!(
                (&columns[0].values[..], &columns[1].values[..]),
                (&[1e3, 2e3, 3e3][..], &[1.0, 2.0, 3.0][..])
            );
            assert!(
                columns[2].values[1].is_nan()
                    && columns[3].values[1].is_nan()
                    && columns[3].values.len() == 3
            );
            assert_eq!(notes, ["not read: topic \"/raw\", 1 messages in \"cdr\""]);
        }
    }

    #[test]
    fn the_size_is_limited_and_a_broken_file_is_an_error() {
        let messages: Vec<(&str, &str, u64, &[u8])> =
            (0..1000).map(|i| ("/x", "json", i, &br#"{"p": 1}"#[..])).collect();
        let bytes = file(Some(Compression::Zstd), &messages);
        let error =
            |bytes: &[u8], budget| columns(bytes, budget, "a.mcap", &mut Vec::new()).unwrap_err().to_string();
        assert!(error(&bytes, Budget::new(1000)).contains("at most 1000 bytes, unpacked"));
        assert!(error(&bytes[..bytes.len() / 2], Budget::file()).contains("an MCAP file"));
        assert!(error(&file(None, &[("/x", "json", 0, b"{")]), Budget::file()).contains("messages in JSON"));
    }
}
