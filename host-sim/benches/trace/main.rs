//! Speed of the tracer: a rigid model fitted to 24.8 s of a ball-screw axis at 1 kHz, the signals of that log, and whole
//! traces of two machines of the self-test.
//!
//! With `LOST_MOTION_DATA` the log is a recorded one (EMPS); without it one of the same length from the equation of the
//! model, with noise.

#![expect(clippy::unwrap_used, reason = "a benchmark that cannot run stops")]

use std::hint::black_box;
use std::path::Path;

use criterion::{Criterion, criterion_group, criterion_main};
use files::log::{AxisLog, Log, Unit};
use model::machine::Machine;
use self_test::case::Case;
use self_test::kind::Kind;
use trace::TraceOptions;
use trace::fit::axis_model::AxisModel;
use trace::fit::fit_data::FitData;
use trace::fit::least_squares::fit;
use trace::fit::testable_scopes::scopes;
use trace::input::signals::Signals;

/// Limit of the steps of a fit; it is not reached.
const STEPS: usize = 10;

fn machine_and_log() -> (Machine, Log) {
    let recorded = std::env::var("LOST_MOTION_DATA").ok().and_then(|data| {
        let folder = Path::new(&data).join("data/emps");
        Some((Machine::read(&folder.join("machine.toml")).ok()?, Log::read(&folder.join("train.csv")).ok()?))
    });
    recorded.unwrap_or_else(synthetic)
}

/// A rigid axis that oscillates over 200 mm under the force of its model, whose parameters differ by 5 % from the declared ones.
fn synthetic() -> (Machine, Log) {
    let text = "name = \"rigid\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncoulomb_n = 20.0\n\
                viscous_n_s_per_m = 200.0\nplant_tolerance_percent = 10.0\n[[axis.x.effect]]\n\
                name = \"constant_load\"\nforce_n = -3.0\n";
    let machine = Machine::parse(text, "rigid").unwrap();
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
    };
    let omega = 2.0;
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    let phase = |i: u32| omega * 1e-3 * f64::from(i);
    axis.motor = Some((0..24_840).map(|i| 100.0 * phase(i).sin() + 1e-4 * noise()).collect());
    let force = |i: u32| {
        let (velocity, acceleration) = (0.1 * omega * phase(i).cos(), -0.1 * omega * omega * phase(i).sin());
        105.0 * acceleration + 21.0 * velocity.signum() + 190.0 * velocity - 3.1 + 2.0 * noise()
    };
    axis.force = Some((0..24_840).map(force).collect());
    (machine, Log::new("synthetic", 0.0, 1e-3, [axis]))
}

fn rigid(criterion: &mut Criterion) {
    let (machine, log) = machine_and_log();
    let names: Vec<String> = machine.axis.keys().cloned().collect();
    let options = TraceOptions::default();
    let logs = [Signals::new(&log, &names, &options.samples)];
    let data = FitData::new(&logs, &names, 0, machine.rates(), &options);
    let axis = &machine.axis[0];
    let (scopes, _) = scopes(axis, &data);
    let start = AxisModel::new(axis, data.rates, options.model);
    criterion.bench_function("rigid model fitted to the force of 24.8 s", |bench| {
        bench.iter(|| black_box(fit(&data, &start, &scopes[0], STEPS)));
    });
    criterion.bench_function("signals of 24.8 s", |bench| {
        bench.iter(|| black_box(Signals::new(&log, &names, &options.samples)));
    });
}

/// Cases of the self-test with seed 1, and effects of each: one of the known kind, and one with a pitch error over the
/// position beside a backlash and a late channel.
const CASES: [(Kind, u64, &[&str]); 2] = [
    (Kind::Textbook, 1, &["squareness", "friction_asymmetry"]),
    (Kind::Shape, 7, &["pitch_map", "backlash", "latency"]),
];

/// Five logs of two axes, about 40 s, of which three are fitted: without reading, from the logs to the result.
fn whole(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("trace of five logs");
    // A trace takes seconds: the least number of samples, each of one trace.
    group.sample_size(10);
    for (kind, number, expected) in CASES {
        let case = Case::draw_kind(kind, 1, number).unwrap();
        let trace = || trace::trace(&case.machine, &case.fit, &case.validate, &|_| {}).unwrap();
        let checked = || {
            let trace = trace();
            let names = || trace.axes().iter().flat_map(|axis| &axis.found).map(|found| found.effect.name());
            assert!(expected.iter().all(|name| names().any(|found| found == *name)));
            trace
        };
        group.bench_function(case.name(), |bench| bench.iter(|| black_box(checked())));
    }
}

criterion_group!(benches, rigid, whole);
criterion_main!(benches);
