//! The memory of a trace does not grow with the part of a log that is not searched.

use crate::{ALLOCATOR, ONE_AT_A_TIME};

use files::log::Log;
use model::machine::Machine;
use trace::TraceOptions;

/// Samples in which effects are searched for here: a tenth of the default, so that a log of a minute is a long one.
const MAX_SAMPLES: usize = 9_600;

/// The circle of the demo, back and forth, as often as asked; each pair of circles takes 10 s.
fn log(machine: &Machine, circles: usize) -> Log {
    let (head, _) = model::examples::DEMO_CIRCLE.split_once("[[block]]").unwrap();
    let arc = |turns: i32| {
        format!(
            "[[block]]\narc = {{ plane = [\"x\", \"y\"], centre_mm = {{ x = 0.0, y = 0.0 }}, turns = {turns}.0 }}\n"
        )
    };
    let motion = format!("{head}{}", (arc(1) + &arc(-1)).repeat(circles));
    demo::log(machine, &motion, 0.0, 1).unwrap()
}

/// Peak memory of a trace, bytes beyond that before it.
fn peak_bytes(machine: &Machine, log: &Log) -> usize {
    let mut options = TraceOptions::default();
    options.admission.max_samples = MAX_SAMPLES;
    options.admission.searched_samples = MAX_SAMPLES / 2;
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let logs = std::slice::from_ref(log);
    let traced = trace::trace_with(&options, machine, [logs, &[]], &|_| {}).unwrap();
    assert!(
        traced.notes().iter().any(|note| note.contains("effects are searched for in")),
        "{:?}",
        traced.notes()
    );
    ALLOCATOR.peak_usage() - before
}

/// A search stores up to 8 kB for each sample of an axis that is searched (docs/speed.md), and nothing for others. Of these there are
/// only the log and its filtered signals, which take less than 600 bytes; stored by the search, they would take ten times as much.
#[test]
fn memory_grows_with_a_long_log_by_its_signals_alone() {
    let _guard = ONE_AT_A_TIME.lock().unwrap();
    let machine = Machine::parse(demo::MACHINE, "demo.toml").unwrap();
    let [short, long] = [3, 9].map(|circles| log(&machine, circles));
    assert!(short.len() > 2 * MAX_SAMPLES && long.len() > 5 * MAX_SAMPLES, "{} {}", short.len(), long.len());
    for log in [&short, &long] {
        let axes = log.axes.len();
        let bytes = peak_bytes(&machine, log);
        let (searched, all) = (MAX_SAMPLES * axes, log.len() * axes);
        // At least the five channels of 8 bytes of the part that is searched.
        assert!(
            (40 * searched..8_000 * searched).contains(&bytes),
            "{bytes} bytes, {searched} of {all} searched"
        );
        assert!(bytes < 4_000 * searched + 600 * all, "{bytes} bytes, {searched} of {all} searched");
    }
}
