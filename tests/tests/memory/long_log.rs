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
    let arc = |turns| {
        format!(
            "[[block]]\narc = {{ plane = [\"x\", \"y\"], centre_mm = {{ x = 0.0, y = 0.0 }}, turns = {turns:.1} }}\n"
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
        traced.notes.iter().any(|note| note.contains("effects are searched for in")),
        "{:?}",
        traced.notes
    );
    ALLOCATOR.peak_usage() - before
}

/// A search stores 6.6 kB for each sample of an axis (docs/speed.md). Beyond the samples that are searched, only the log with its
/// filtered signals grows: five channels of 8 bytes at least, and 600 bytes at most.
#[test]
fn memory_grows_with_a_long_log_by_its_signals_alone() {
    let _guard = ONE_AT_A_TIME.lock().unwrap();
    let machine = Machine::parse(demo::MACHINE, "demo.toml").unwrap();
    let [short, long] = [3, 9].map(|circles| log(&machine, circles));
    let more_samples = (long.len() - short.len()) * long.axes.len();
    assert!(short.len() > 2 * MAX_SAMPLES && long.len() > 5 * MAX_SAMPLES, "{} {}", short.len(), long.len());
    let [small, large] = [&short, &long].map(|log| peak_bytes(&machine, log));
    let per_sample = large.saturating_sub(small) / more_samples;
    assert!((40..600).contains(&per_sample), "{per_sample} bytes per sample and axis: {small}, {large}");
}
