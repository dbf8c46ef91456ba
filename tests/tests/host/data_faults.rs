//! Broken data are named before any effect is looked for, and what is sound is traced.

use files::log::{AxisLog, Channel, Log};
use model::effects::Stage;
use model::machine::Machine;
use report::sentences;
use tests::cases;
use trace::data_faults::{self, FaultKind};
use trace::verdict::{self, Verdict};
use trace::{Identification, TraceOptions, trace};

fn declared() -> Machine {
    Machine::parse(demo::MACHINE, "m.toml").unwrap()
}

/// A log to fit and a log to validate of a machine.
fn logs(machine: &Machine) -> [Log; 2] {
    let log = |motion, start_s, seed| demo::log(machine, motion, start_s, seed).unwrap();
    [log(model::examples::DEMO_CIRCLE, 0.0, 1), log(model::examples::DEMO_BALLBAR, 40.0, 2)]
}

fn traced([fit, validate]: [Log; 2]) -> Identification {
    trace(&declared(), &[fit], &[validate], &|_| {}).unwrap()
}

/// The logs of the declared machine, both changed.
fn changed(change: impl Fn(&mut Log)) -> [Log; 2] {
    logs(&declared()).map(|mut log| {
        change(&mut log);
        log
    })
}

fn on_x(channel: Channel, change: impl Fn(&mut [f64])) -> impl Fn(&mut Log) {
    move |log| change(log.axes[0].channel_mut(channel).as_mut().unwrap())
}

/// Axis, channel and kind of the faults, without repetitions.
fn named(trace: &Identification) -> Vec<(String, Option<Channel>, FaultKind)> {
    let faults = trace.axes().iter().flat_map(|axis| &axis.data_faults);
    let mut named: Vec<_> = faults.map(|fault| (fault.axis.clone(), fault.channel, fault.kind)).collect();
    named.dedup();
    named
}

fn residual(trace: &Identification, stage: Stage) -> [f64; 3] {
    let error = trace.axes()[0].residuals.iter().find(|error| error.stage == stage).unwrap();
    [error.after.fit, error.after.validate, error.noise]
}

/// Adds to all readings from the sample at which the axis is fastest.
fn slip(values: &mut [f64], mm: f64) {
    let speed = |sample: &usize| (values[sample + 50] - values[sample - 50]).abs();
    let fastest = (1000..values.len() - 1000).max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap();
    values[fastest..].iter_mut().for_each(|value| *value += mm);
}

fn repeat(values: &mut [f64], every: usize) {
    for sample in (every..values.len()).step_by(every) {
        values[sample] = values[sample - 1];
    }
}

/// Each fault is named; noise and residuals are those of the sound logs, to within what the excluded samples and the noise of
/// a corrected step contribute; no effect is found and the summary begins with the fault.
#[test]
fn a_corrected_fault_leaves_the_result_of_the_sound_logs() {
    type Change = Box<dyn Fn(&mut Log)>;
    let sound = traced(logs(&declared()));
    assert_eq!(named(&sound), []);
    let table = Channel::Table;
    let cases: Vec<(FaultKind, Channel, Change)> = vec![
        (FaultKind::Sign, table, Box::new(on_x(table, |v| v.iter_mut().for_each(|mm| *mm = -*mm)))),
        (FaultKind::Unit, table, Box::new(on_x(table, |v| v.iter_mut().for_each(|mm| *mm *= 1e3)))),
        (
            FaultKind::Unit,
            Channel::Force,
            Box::new(on_x(Channel::Force, |v| v.iter_mut().for_each(|n| *n *= 1e-3))),
        ),
        (FaultKind::Slip, table, Box::new(on_x(table, |v| slip(v, 0.02)))),
        (FaultKind::Slip, Channel::Motor, Box::new(on_x(Channel::Motor, |v| slip(v, -5.0)))),
        (
            FaultKind::Stuck,
            table,
            Box::new(on_x(table, |v| {
                let held = v[2999];
                v[3000..3300].fill(held);
            })),
        ),
        (FaultKind::Stuck, table, Box::new(on_x(table, |v| repeat(v, 20)))),
        (
            FaultKind::Spike,
            table,
            Box::new(on_x(table, |v| v.iter_mut().skip(700).step_by(900).for_each(|mm| *mm += 1.0))),
        ),
    ];
    for (kind, channel, change) in cases {
        let trace = traced(changed(change));
        assert_eq!(named(&trace), [("x".to_owned(), Some(channel), kind)]);
        let errors = [&trace, &sound]
            .map(|trace| [Stage::Motor, Stage::Table, Stage::Force].map(|stage| residual(trace, stage)));
        assert_eq!(verdict::of(&trace), verdict::of(&sound), "{kind:?}: {errors:?}");
        assert!(
            trace.axes().iter().all(|axis| axis.found.is_empty()),
            "{kind:?}: {:?}",
            trace.axes()[0].found
        );
        for stage in [Stage::Motor, Stage::Table, Stage::Force] {
            let pairs = residual(&trace, stage).into_iter().zip(residual(&sound, stage));
            for (number, (with, without)) in pairs.enumerate() {
                // A step that is wrong by 0.05 µm, one standard deviation of the difference of two readings, leaves half of
                // that if it is in the middle of a log.
                let step = if kind == FaultKind::Slip && stage != Stage::Force { 0.025 } else { 0.0 };
                let largest = f64::hypot(1.1 * without, step);
                let context = format!("{kind:?} {channel:?} {stage:?} {number}: {with} {without}");
                assert!((0.9 * without..largest).contains(&with), "{context}");
            }
        }
        let json = trace::json::Document::of(&trace, &[], false).value();
        let fault = &json["data_faults"][0];
        assert_eq!((&fault["axis"], &fault["kind"]), (&"x".into(), &kind.name().into()));
        let summary = sentences::summary(&trace, None);
        assert!(summary[0].starts_with("x: data fault in "), "{summary:?}");
        assert!(summary.iter().all(|line| !line.starts_with("x: no undeclared effect found")), "{summary:?}");
    }
}

/// A motor reading that is 1.6 times the motion: lead 10 mm declared as 16 mm.
#[test]
fn a_channel_with_an_unknown_factor_is_not_used() {
    let trace = traced(changed(on_x(Channel::Motor, |v| v.iter_mut().for_each(|mm| *mm *= 1.6))));
    assert_eq!(named(&trace), [("x".to_owned(), Some(Channel::Motor), FaultKind::Unit)]);
    let axis = &trace.axes()[0];
    assert!((axis.data_faults[0].size.unwrap() / 1.6 - 1.0).abs() < 1e-3, "{:?}", axis.data_faults);
    let missing: Vec<Stage> = axis.not_testable.iter().map(|stage| stage.stage).collect();
    for stage in [Stage::Motor, Stage::Table, Stage::Force] {
        assert!(missing.contains(&stage), "{missing:?}");
    }
    assert!(axis.not_testable[0].needs.contains("a motor channel without the fault \"unit\""), "{axis:?}");
    assert!(axis.found.is_empty(), "{:?}", axis.found);
    assert!(verdict::of(&trace) >= Verdict::Unexplained);
    assert!(!trace.axes()[1].residuals.is_empty(), "y is traced");
}

#[test]
fn exchanged_scales_are_exchanged_back() {
    let trace = traced(changed(|log| {
        let [x, y] = &mut log.axes[..] else { panic!("two axes") };
        std::mem::swap(&mut x.table, &mut y.table);
    }));
    let kind = (Some(Channel::Table), FaultKind::Exchanged);
    assert_eq!(named(&trace), ["x", "y"].map(|axis| (axis.to_owned(), kind.0, kind.1)));
    assert!(trace.axes().iter().all(|axis| axis.found.is_empty()), "{:?}", trace.axes()[0].found);
    let sound = residual(&traced(logs(&declared())), Stage::Table);
    assert!((residual(&trace, Stage::Table)[0] / sound[0] - 1.0).abs() < 1e-9);
}

#[test]
fn a_slip_of_the_probe_does_not_hide_a_thermal_drift() {
    let effect = "[[axis.x.effect]]\nname = \"thermal_drift\"\namplitude_um = 12.0\ntime_constant_s = 10.0\n\n[axis.y]";
    let truth = Machine::parse(&demo::MACHINE.replacen("[axis.y]", effect, 1), "m.toml").unwrap();
    let [mut fit, validate] = logs(&truth);
    // The drift within the 11 s of this log is 8 µm.
    fit.axes[0].tool.as_mut().unwrap()[5000..].iter_mut().for_each(|mm| *mm -= 0.008);
    let trace = traced([fit, validate]);
    assert_eq!(named(&trace), [("x".to_owned(), Some(Channel::Tool), FaultKind::Slip)]);
    // The probe has 0.1 µm of noise; lines through 32 samples on either side, 0.14·4/√64: 0.07 µm.
    let size = trace.axes()[0].data_faults[0].size.unwrap();
    assert!((size + 8.0).abs() < 0.3, "{size}");
    let [found] = &trace.axes()[0].found[..] else { panic!("{:?}", trace.axes()[0].found) };
    assert_eq!(found.effect.name(), "thermal_drift");
    let [amplitude, time_constant] = [0, 1].map(|i| found.effect.parameters()[i].1);
    assert!((amplitude / 12.0 - 1.0).abs() < 0.05 && (time_constant / 10.0 - 1.0).abs() < 0.1, "{found:?}");
}

#[test]
fn a_late_command_is_shifted_back() {
    for late in [1, 20] {
        let trace = traced(changed(on_x(Channel::Command, |v| {
            v.copy_within(..v.len() - late, late);
            let first = v[0];
            v[..late].fill(first);
        })));
        assert_eq!(named(&trace), [("x".to_owned(), Some(Channel::Command), FaultKind::Shifted)], "{late}");
        let sizes: Vec<f64> = trace.axes()[0].data_faults.iter().filter_map(|fault| fault.size).collect();
        // 1 kHz: one sample is 1 ms.
        assert!(sizes.len() == 2 && sizes.iter().all(|ms| (ms - late as f64).abs() < 1e-9), "{sizes:?}");
        assert!(trace.axes()[0].found.is_empty(), "{late}: {:?}", trace.axes()[0].found);
    }
}

/// Wrong gains delay the motor like a late command, and are not one.
#[test]
fn a_wrong_gain_or_feedforward_is_not_a_late_command() {
    let replaced = |old: &str, new: &str| {
        assert!(demo::MACHINE.contains(old), "{old}");
        Machine::parse(&demo::MACHINE.replacen(old, new, 1), "m.toml").unwrap()
    };
    for truth in [
        replaced("position_gain_per_s = 50.0", "position_gain_per_s = 52.6"),
        replaced("position_gain_per_s = 50.0", "position_gain_per_s = 60.0"),
        replaced("position_gain_per_s = 50.0", "position_gain_per_s = 90.0"),
        replaced("feedforward_percent = 60.0", "feedforward_percent = 65.0"),
        replaced("feedforward_percent = 60.0", "feedforward_percent = 90.0"),
    ] {
        assert_eq!(named(&traced(logs(&truth))), []);
    }
}

#[test]
fn a_dead_scale_is_not_used_and_the_rest_is_traced() {
    let trace = traced(changed(on_x(Channel::Table, |v| v.fill(5.0))));
    assert_eq!(named(&trace), [("x".to_owned(), Some(Channel::Table), FaultKind::Dead)]);
    assert!(trace.axes()[0].residuals.iter().any(|error| error.stage == Stage::Force));
    assert!(trace.axes()[0].residuals.iter().all(|error| error.stage != Stage::Table));
    assert!(verdict::of(&trace) >= Verdict::Unexplained);
}

#[test]
fn a_log_shorter_than_its_settling_is_refused() {
    let [fit, _] = logs(&declared());
    let error = trace(&declared(), &[fit.slice(2000..2290)], &[], &|_| {}).unwrap_err().to_string();
    assert!(
        error.ends_with(
            "expected a log longer than the 0.3 s at its start that are not evaluated, found 0.290 s"
        ),
        "{error}"
    );
}

/// The faults of logs at their own rate.
fn examined(machine: &Machine, logs: &[Log]) -> Vec<data_faults::DataFault> {
    let options = TraceOptions::default();
    let interpolated = data_faults::interpolate_lost_rows(machine, [logs, &[]], &options);
    data_faults::examine(machine, interpolated, &options).unwrap().faults
}

#[test]
fn no_fault_is_found_in_logs_of_demo_machines() {
    for seed in 1..=10 {
        let declared = declared();
        let [fit, validate] = demo::logs(&demo::draw(&declared, seed).truth, seed).unwrap();
        let faults = examined(&declared, &[fit, validate].concat());
        assert!(faults.is_empty(), "seed {seed}: {faults:?}");
    }
}

#[test]
fn no_fault_is_found_in_blind_cases_and_measured_data() {
    let Some(folders) = cases::folders() else { return };
    let measured = ["data/emps", "data/kuka"].map(|name| tests::data::data_folder(name).unwrap());
    for folder in folders.into_iter().chain(measured) {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let paths =
            ["fit_", "validate_", "train", "recording"].map(|prefix| cases::logs(&folder, prefix)).concat();
        assert!(!paths.is_empty(), "{}", folder.display());
        let logs: Vec<Log> = paths.iter().map(|path| Log::read(path).unwrap()).collect();
        assert_eq!(examined(&machine, &logs), [], "{}", folder.display());
    }
}

/// Slips and spikes from 5 µm on, stuck readings and wrong factors in the blind cases: each is found, in the right channel,
/// and nothing else.
#[test]
fn faults_in_blind_cases_are_found() {
    let Some(folders) = cases::folders() else { return };
    let break_at = |axis: &mut AxisLog, channel: Channel, kind: FaultKind, number: usize| {
        let values = axis.channel_mut(channel).as_mut().unwrap();
        let start = 400 + (number * 7919) % (values.len() - 1400);
        let mm = [0.005, -0.02, 0.5, -10.0][number % 4];
        match kind {
            FaultKind::Slip => values[start..].iter_mut().for_each(|value| *value += mm),
            FaultKind::Spike => values[start] += mm,
            FaultKind::Sign => values.iter_mut().for_each(|value| *value = -*value),
            _ => values.iter_mut().for_each(|value| *value *= [25.4, 1e3, 2.0, 0.5][number % 4]),
        }
    };
    let sensors = [Channel::Motor, Channel::Table, Channel::Tool];
    for (number, folder) in folders.iter().enumerate() {
        let machine = Machine::read(&folder.join("machine.toml")).unwrap();
        let sound = Log::read(&cases::logs(folder, "fit_").into_iter().next().unwrap()).unwrap();
        for kind in [FaultKind::Slip, FaultKind::Spike, FaultKind::Sign, FaultKind::Unit] {
            for (shift, channel) in sensors.into_iter().enumerate() {
                let mut log = sound.clone();
                break_at(&mut log.axes[shift % 2], channel, kind, number + 3 * shift);
                let faults = examined(&machine, &[log]);
                let [fault] = &faults[..] else {
                    panic!("{} {channel:?} {kind:?}: {faults:?}", folder.display())
                };
                let expected = (&sound.axes[shift % 2].name, Some(channel), kind);
                assert_eq!((&fault.axis, fault.channel, fault.kind), expected, "{}", folder.display());
            }
        }
    }
}
