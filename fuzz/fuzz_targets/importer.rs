//! What is asserted of an imported file, for every reader.

use files::head::Head;
use import::any_log;
use import::format::Format;
use import::request::Request;
use import::{Foreign, Imported};

/// Imports bytes with a preset, as a log and as a ballbar's table, and reads them as every command does that takes a log: an error is one line
/// without control characters; a log has finite samples, as many in every channel, and is written and read back; so is a table.
pub fn import(preset: Option<Format>, bytes: &[u8]) {
    let log = ["x_motor_mm=1", "x_command_mm=2"];
    let table = ["angle_deg=1", "radius_um=2"];
    let units = ["x_command_mm=mm/s"];
    for (names, units) in [(&log[..0], &units[..0]), (&log[..1], &[]), (&log, &units), (&table, &[])] {
        let request = Request {
            mappings: names.iter().map(|name| name.parse().expect("a mapping")).collect(),
            units: units.iter().map(|unit| unit.parse().expect("a unit")).collect(),
            rate_hz: Some(1000.0),
            preset,
        };
        check(import::foreign(bytes, "a", &request));
    }
    let head = Head::of(Box::new(bytes), "a").expect("memory can be read");
    check(any_log::log_or_ballbar(head, "a", &Request { preset, ..Request::default() }));
}

fn check(read: Result<Foreign, files::error::InputError>) {
    let (notes, csv) = match read {
        Ok(Foreign::Log(Imported { log, notes })) => {
            assert!(log.len() >= 2);
            let mut csv = Vec::new();
            log.write_csv(&mut csv).expect("memory");
            (notes, String::from_utf8(csv).expect("a text"))
        }
        Ok(Foreign::Ballbar(table)) => (table.notes.clone(), table.csv()),
        Err(error) => return assert!(!error.to_string().contains(char::is_control), "{error:?}"),
    };
    for cell in csv.lines().skip(1).flat_map(|line| line.split(',')).filter(|cell| !["+", "-"].contains(cell))
    {
        assert!(cell.parse::<f64>().expect("a number").is_finite());
    }
    for note in notes {
        assert!(!note.contains(char::is_control), "{note:?}");
    }
}
