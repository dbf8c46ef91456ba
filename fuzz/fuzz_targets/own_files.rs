//! Any text as each file that a person writes or a command reads again: an error is one line without control characters.
#![no_main]

use std::path::Path;

use commissioning::compensate::file::CompensationFile;
use files::error::InputError;
use friction_map::FrictionMap;
use libfuzzer_sys::fuzz_target;
use model::machine::Machine;
use motion::Motion;
use volume::survey::Survey;

/// A machine whose compensation is read.
const MACHINE: &str = "name = 'm'\nsample_rate_hz = 1000.0\n[axis.x]\n[axis.y]\n";

fn check<T>(read: Result<T, InputError>) -> Option<T> {
    match read {
        Ok(value) => Some(value),
        Err(error) => {
            let text = error.to_string();
            assert!(!text.contains(char::is_control), "{text:?}");
            None
        }
    }
}

// An input is the number of a reader, then the file.
fuzz_target!(|data: &[u8]| {
    let Some((reader, bytes)) = data.split_first() else { return };
    let as_text = || str::from_utf8(bytes).unwrap_or_default();
    match reader % 9 {
        0 => {
            // What is read is written, and read as the same machine.
            if let Some(machine) = check(Machine::parse(as_text(), "a")) {
                assert!(Machine::parse(&machine.to_toml(), "b").is_ok_and(|again| again == machine));
            }
        }
        1 => drop(check(Motion::parse(as_text(), "a"))),
        2 => {
            let machine = Machine::parse(MACHINE, "m").expect("a machine");
            check(CompensationFile::parse(as_text(), "a", &machine));
        }
        3 => drop(check(Survey::parse(as_text(), Path::new("a")))),
        4 => drop(check(positions::read(bytes, "a", &positions::columns::Request::default()))),
        5 => drop(check(FrictionMap::parse(bytes, "a"))),
        6 => drop(check(history::trace_json::read(as_text(), "a", None))),
        7 => drop(check(history::model_file::read(as_text(), "a", None))),
        _ => drop(check(import::accelerations::parse(as_text(), "a"))),
    }
});
