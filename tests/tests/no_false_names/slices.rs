//! Slices of a log of a machine without undeclared effects: 8 of 173 named an effect.

use std::path::Path;

use files::log::Log;
use model::machine::Machine;
use tests::cases;
use trace::trace;

use super::reported::assert_named;

/// Length of the slices: that of the one in which a bent guideway of 885 ± 446 µm/m² was named.
const ROWS: usize = 700;
/// Its first row.
const NAMED_ROW: usize = 14_482;

/// Asserts that a slice of a log, with its last quarter held out, shows no effect.
fn assert_nothing_is_named(machine: &Machine, log: &Log, first_row: usize) {
    let slice = log.slice(first_row..first_row + ROWS);
    let trace = trace(machine, &[slice], &[], &|_| {}).unwrap();
    assert_named(&trace, &[]);
}

/// The first blind case has no effects.
#[test]
fn slices_of_a_log_without_effects_have_none() {
    let Some(folders) = cases::folders() else { return };
    let folder: &Path = &folders[0];
    assert_eq!(folder.file_name().unwrap(), "case-1");
    let machine = Machine::read(&folder.join("machine.toml")).unwrap();
    let paths = [cases::logs(folder, "fit_"), cases::logs(folder, "validate_")].concat();
    assert_eq!(paths.len(), 5);
    for path in paths {
        let log = Log::read(&path).unwrap();
        let spare = log.len() - ROWS;
        for first_row in [spare / 5, 3 * spare / 4] {
            assert_nothing_is_named(&machine, &log, first_row);
        }
        if path.ends_with("fit_circle.csv.gz") {
            assert_nothing_is_named(&machine, &log, NAMED_ROW);
        }
    }
}
