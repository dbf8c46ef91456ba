//! What is asserted of an imported file, for every reader.

use import::format::Format;
use import::request::Request;

/// Imports bytes with a preset: an error is one line without control characters; a log has finite samples, as many in every channel, and is
/// written
/// and read back.
pub fn import(preset: Option<Format>, bytes: &[u8]) {
    let names = ["x_motor_mm=1", "x_command_mm=2"];
    let units = ["x_command_mm=mm/s"];
    for mapped in 0..=names.len() {
        let request = Request {
            mappings: names[..mapped].iter().map(|name| name.parse().expect("a mapping")).collect(),
            units: units
                .iter()
                .filter(|_| mapped == names.len())
                .map(|unit| unit.parse().expect("a unit"))
                .collect(),
            rate_hz: Some(1000.0),
            preset,
        };
        match import::of_bytes(bytes, "a", &request) {
            Ok(imported) => {
                assert!(imported.log.len() >= 2);
                let mut csv = Vec::new();
                imported.log.write_csv(&mut csv).expect("memory");
                for cell in std::str::from_utf8(&csv)
                    .expect("a text")
                    .lines()
                    .skip(1)
                    .flat_map(|line| line.split(','))
                {
                    assert!(cell.parse::<f64>().expect("a number").is_finite());
                }
                for note in imported.notes {
                    assert!(!note.contains(char::is_control), "{note:?}");
                }
            }
            Err(error) => assert!(!error.to_string().contains(char::is_control), "{error:?}"),
        }
    }
}
