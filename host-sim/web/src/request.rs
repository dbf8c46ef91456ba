//! What the page asks for.
//!
//! A request is the length of a JSON text (four bytes, little-endian), the text, and the bytes of the files that it lists, one after the other.

use import::format::Format;
use import::request::{Mapping, Request as Reading, UnitOf};
use serde::Deserialize;

/// A request.
#[derive(Debug)]
pub struct Request<'a> {
    /// What is to be done.
    pub task: Task,
    /// With these files.
    pub files: Vec<DroppedFile<'a>>,
}

/// What is to be done.
#[derive(Debug, Deserialize)]
#[serde(tag = "task", rename_all = "snake_case")]
pub enum Task {
    /// What each file is.
    Look,
    /// A machine file from logs.
    Init(Init),
    /// A trace.
    Trace(Trace),
    /// What a circle is made of.
    Circle(Circle),
    /// A compensation for a control.
    Compensate(Compensate),
}

/// A machine file from logs.
#[derive(Debug, Deserialize)]
pub struct Init {
    /// The text of a machine file with what is known; empty: nothing.
    pub machine: String,
    /// `AXIS.KEY=VALUE`, as `--set`.
    pub known: Vec<String>,
}

/// A trace.
#[derive(Debug, Deserialize)]
pub struct Trace {
    /// The text of the machine file.
    pub machine: String,
}

/// A circle.
#[derive(Debug, Deserialize)]
pub struct Circle {
    /// Nominal radius of a ballbar's table, mm.
    pub radius_mm: Option<f64>,
}

/// A compensation.
#[derive(Debug, Deserialize)]
pub struct Compensate {
    /// The text of the better machine file.
    pub model: String,
    /// Name of the control, as of `--format`.
    pub control: String,
}

/// A file that was dropped on the page.
#[derive(Debug)]
pub struct DroppedFile<'a> {
    /// Its name.
    pub name: String,
    /// Its content.
    pub bytes: &'a [u8],
    /// What the user says of its columns.
    pub reading: Reading,
    /// Not used in a fit, but to check it.
    pub is_held_out: bool,
}

#[derive(Deserialize)]
struct Text {
    #[serde(flatten)]
    task: Task,
    files: Vec<ListedFile>,
}

#[derive(Deserialize)]
struct ListedFile {
    name: String,
    length: usize,
    #[serde(default)]
    held_out: bool,
    /// `OURS=THEIRS`, as `--map`.
    #[serde(default)]
    map: Vec<String>,
    /// `OURS=UNIT`, as `--unit`.
    #[serde(default)]
    unit: Vec<String>,
    rate_hz: Option<f64>,
    preset: Option<String>,
}

impl<'a> Request<'a> {
    /// A request of its bytes.
    ///
    /// # Errors
    /// If it is none of the page's, or the user's words on a file are not understood.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, String> {
        let no_request = |problem: &str| format!("expected a request of the page: {problem}");
        let (length, rest) = bytes.split_first_chunk::<4>().ok_or_else(|| no_request("it has no length"))?;
        let length = u32::from_le_bytes(*length) as usize;
        let (text, mut rest) = rest.split_at_checked(length).ok_or_else(|| no_request("it is cut off"))?;
        let Text { task, files } =
            serde_json::from_slice(text).map_err(|error| no_request(&error.to_string()))?;
        let mut dropped = Vec::with_capacity(files.len());
        for file in files {
            let (bytes, others) =
                rest.split_at_checked(file.length).ok_or_else(|| no_request("a file is cut off"))?;
            rest = others;
            let reading = file.reading().map_err(|problem| format!("{}: {problem}", file.name))?;
            dropped.push(DroppedFile { name: file.name, bytes, reading, is_held_out: file.held_out });
        }
        Ok(Self { task, files: dropped })
    }
}

impl ListedFile {
    fn reading(&self) -> Result<Reading, String> {
        if let Some(rate) = self.rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            return Err(format!("expected a number of samples per second above 0, found {rate}"));
        }
        let mappings = self.map.iter().map(|text| text.parse::<Mapping>()).collect::<Result<_, _>>()?;
        let units = self.unit.iter().map(|text| text.parse::<UnitOf>()).collect::<Result<_, _>>()?;
        let preset = self.preset.as_deref().map(str::parse::<Format>).transpose()?;
        Ok(Reading { mappings, units, rate_hz: self.rate_hz, preset })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes(text: &str, files: &[u8]) -> Vec<u8> {
        let length = u32::try_from(text.len()).unwrap().to_le_bytes();
        [&length, text.as_bytes(), files].concat()
    }

    #[test]
    fn files_are_taken_apart_in_their_order() {
        let text = r#"{"task":"look","files":[{"name":"a","length":2,"map":["x_motor_mm=3"]},{"name":"b","length":3,"held_out":true}]}"#;
        let bytes = bytes(text, b"abcde");
        let request = Request::parse(&bytes).unwrap();
        assert!(matches!(request.task, Task::Look));
        let [a, b] = &request.files[..] else { panic!("{:?}", request.files) };
        assert_eq!((a.bytes, b.bytes), (&b"ab"[..], &b"cde"[..]));
        assert_eq!((a.is_held_out, b.is_held_out), (false, true));
        assert_eq!((a.reading.mappings.len(), b.reading.is_empty()), (1, true));
    }

    #[test]
    fn what_is_no_request_is_refused() {
        let refused = |bytes: &[u8]| Request::parse(bytes).unwrap_err();
        assert_eq!(refused(b"ab"), "expected a request of the page: it has no length");
        assert_eq!(refused(&9_u32.to_le_bytes()), "expected a request of the page: it is cut off");
        let long = r#"{"task":"look","files":[{"name":"a","length":2}]}"#;
        assert_eq!(refused(&bytes(long, b"a")), "expected a request of the page: a file is cut off");
        let words = r#"{"task":"look","files":[{"name":"a.txt","length":0,"map":["x_motor_mm"]}]}"#;
        assert_eq!(refused(&bytes(words, b"")), "a.txt: expected OURS=THEIRS");
    }
}
