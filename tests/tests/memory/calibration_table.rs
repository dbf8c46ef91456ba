//! Parameters and memory of a trace are bounded, whatever the machine file declares.

use crate::{ALLOCATOR, ONE_AT_A_TIME};
use std::fmt::Write;

use files::log::Log;
use model::effects::Stage;
use model::machine::Machine;
use trace::TraceOptions;
use trace::fit::axis_model::AxisModel;
use trace::fit::held_effects::MAX_FITTED;
use trace::fit::scope::{Mechanics, Scope, ShownIn};

/// The demo's machine with a calibration table of axis x: a wave of 1 µm. Without points: no table.
fn machine(points: u32) -> Machine {
    let mut text = demo::MACHINE.to_owned();
    if points > 0 {
        let list = |value: &dyn Fn(f64) -> f64| {
            let at = |i| value(-100.0 + 200.0 * f64::from(i) / f64::from(points - 1));
            (0..points).map(|i| format!("{:.6}", at(i))).collect::<Vec<_>>().join(", ")
        };
        let (positions, errors) = (list(&|mm| mm), list(&|mm| (0.05 * mm).sin()));
        write!(
            text,
            "\n[[axis.x.effect]]\nname = \"pitch_map\"\npositions_mm = [{positions}]\nerror_um = [{errors}]\n"
        )
        .unwrap();
    }
    Machine::parse(&text, "m.toml").unwrap()
}

fn parameters(points: u32) -> usize {
    let machine = machine(points);
    let model = AxisModel::new(&machine.axis["x"], machine.rates(), TraceOptions::default().model);
    let scope = Scope {
        stages: vec![Stage::Table, Stage::Force],
        mechanics: Mechanics::All,
        shown_in: ShownIn::default(),
    };
    model.free_parameters(&scope).len()
}

/// Peak memory of a trace, bytes beyond that before it.
fn peak_bytes(machine: &Machine, log: &Log) -> usize {
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let trace = trace::trace(machine, std::slice::from_ref(log), &[], &|_| {}).unwrap();
    assert!(!trace.axes().is_empty());
    ALLOCATOR.peak_usage() - before
}

/// Once, a table of 300 points took 574 MB and 13 s for a log of 4.8 s, one of 1000 points more than 200 s.
#[test]
fn a_calibration_table_does_not_multiply_parameters_and_memory() {
    let _guard = ONE_AT_A_TIME.lock().unwrap();
    let without = parameters(0);
    // Mean and slope of a map are not fitted.
    assert_eq!(parameters(25), without + 23);
    assert_eq!(parameters(98), without + MAX_FITTED);
    for points in [99, 300, 2000] {
        assert_eq!(parameters(points), without, "{points}");
    }
    let log = demo::log(&machine(300), model::examples::DEMO_CIRCLE, 0.0, 1).unwrap();
    let [plain, small, large] = [0, 300, 2000].map(|points| peak_bytes(&machine(points), &log));
    // Without the table, its error is found as another effect: a trace with it needs no more. A model with 2000 points is copied for
    // each candidate: less than 10 MB for 60 copies of 100 kB.
    assert!(small < plain + (10 << 20) && large < plain + (10 << 20), "{plain}, {small}, {large} bytes");
    // What docs/speed.md states for a log with few effects; half of it is the log itself with its filtered signals.
    let per_sample = plain / (log.len() * log.axes.len());
    assert!((500..8_000).contains(&per_sample), "{per_sample} bytes per sample and axis");
}
