//! Slices of a log of a machine without undeclared effects. Once 8 of 173 named an effect.

use std::path::Path;

use files::log::Log;
use model::machine::Machine;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tests::cases;
use trace::trace;

use super::machine::TestMachine;
use super::reported::assert_named;

/// Length of the slices of every log.
const ROWS: usize = 700;

/// Log, first row and length of slices in which an effect was named: a bent guideway of 885 ± 446 µm/m², forces along the travel
/// of −57 ± 36 to −161 ± 22 N/m (on an arc, that of a spring is the force of a mass), an error of the pitch of 0.002 µm.
const NAMED: [(&str, usize, usize); 6] = [
    ("fit_circle", 14_482, 700),
    ("fit_circle", 3_636, 1_500),
    ("fit_circle", 15_164, 4_000),
    ("validate_circle", 562, 1_500),
    ("validate_circle", 6_191, 1_500),
    ("validate_circle", 9_005, 1_500),
];

/// Asserts that a slice of a log, with its last quarter held out, shows no effect.
fn assert_nothing_is_named(machine: &Machine, log: &Log, first_row: usize, rows: usize) {
    let slice = log.slice(first_row..first_row + rows);
    let trace = trace(machine, &[slice], &[], &|_| {}).unwrap();
    assert_named(&trace, &[]);
}

/// Lengths of the slices of a sweep, samples of 1 ms.
const LENGTHS: [usize; 3] = [700, 1_500, 4_000];

/// Slices of logs at random places, the lengths in turn, that name an effect without a rival: log, first row and length. In
/// steady motion a following error may be that of any setting of the controller; then all of them are named.
fn named_slices(
    machine: &Machine,
    logs: &[Log],
    slices_per_log: usize,
    seed: u64,
) -> Vec<(String, usize, usize)> {
    let place = |(number, log): (usize, &Log)| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(number as u64);
        let mut slice = |index: usize| {
            let rows = LENGTHS[index % LENGTHS.len()].min(log.len());
            (number, random.random_range(0..=log.len() - rows), rows)
        };
        (0..slices_per_log).map(&mut slice).collect::<Vec<_>>()
    };
    let places: Vec<(usize, usize, usize)> = logs.iter().enumerate().flat_map(place).collect();
    let names = |&(number, first_row, rows): &(usize, usize, usize)| {
        let log = &logs[number];
        let trace = trace(machine, &[log.slice(first_row..first_row + rows)], &[], &|_| {}).unwrap();
        let mut found = trace.axes().iter().flat_map(|axis| &axis.found);
        let is_named = found.any(|found| found.rivals.is_empty());
        is_named.then(|| (log.source.clone(), first_row, rows))
    };
    places.iter().filter_map(names).collect()
}

/// A slice that cannot bear its blocks, whose first samples have an unknown friction, or whose last quarter contradicts it
/// decides nothing. Once a corner, in most of which the axis moves at one speed, had a position gain 0.5 % above the declared one: the
/// zero of its scale, which the loop uses, was 1.6 µm off beside a late reading.
#[test]
fn random_slices_of_simulated_logs_without_effects_have_none() {
    let machine = TestMachine::new(1);
    let [fit, validate] = machine.logs();
    assert_eq!(named_slices(&machine.file(), &[fit, validate].concat(), 12, 1), []);
}

/// Slices of the first blind case.
#[test]
fn random_slices_of_a_log_without_effects_have_none() {
    let Some(folders) = cases::folders() else { return };
    let machine = Machine::read(&folders[0].join("machine.toml")).unwrap();
    let paths = [cases::logs(&folders[0], "fit_"), cases::logs(&folders[0], "validate_")].concat();
    let logs: Vec<Log> = paths.iter().map(|path| Log::read(path).unwrap()).collect();
    assert_eq!(named_slices(&machine, &logs, 24, 2), []);
}

/// An arc of the second simulator: once −83 ± 26 N/m.
#[test]
fn an_arc_has_no_force_along_the_travel() {
    let machine = TestMachine::new(1);
    let [fit, _] = machine.logs();
    let circle = fit.iter().find(|log| log.source == "fit_circle").unwrap();
    assert_nothing_is_named(&machine.file(), circle, 711, 1_500);
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
            assert_nothing_is_named(&machine, &log, first_row, ROWS);
        }
        for (_, first_row, rows) in
            NAMED.into_iter().filter(|(name, ..)| path.ends_with(format!("{name}.csv.gz")))
        {
            assert_nothing_is_named(&machine, &log, first_row, rows);
        }
    }
}
