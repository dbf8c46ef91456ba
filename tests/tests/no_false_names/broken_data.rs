//! Broken channels in the logs of the second simulator; those of the demo machine are in `data_faults.rs`.

use std::collections::BTreeSet;

use files::log::{Channel, Log};
use trace::Trace;
use trace::data_faults::FaultKind;

use super::machine::TestMachine;
use super::reported::{assert_named, context};

fn scaled(log: &mut Log, axis: usize, channel: Channel, factor: f64) {
    log.axes[axis].channel_mut(channel).as_mut().unwrap().iter_mut().for_each(|value| *value *= factor);
}

/// Axis, channel and kind of the faults, without those that repeat them in other logs.
fn faults(trace: &Trace) -> BTreeSet<(&str, Option<&str>, FaultKind)> {
    let faults = trace.axes.iter().flat_map(|axis| &axis.data_faults);
    faults.map(|fault| (fault.axis.as_str(), fault.channel.map(Channel::word), fault.kind)).collect()
}

/// A scale in inches was "100000 µm/m less far", a reversed one "100 ms late", a command in µm "explained".
#[test]
fn a_wrong_unit_or_sign_is_named_and_no_effect() {
    let machine = TestMachine::new(3);
    let trace = machine.trace_of(|log| {
        scaled(log, 0, Channel::Table, 1.0 / 25.4);
        scaled(log, 0, Channel::Tool, -1.0);
        scaled(log, 1, Channel::Command, 1e3);
    });
    let expected = [
        ("x", Some("table"), FaultKind::Unit),
        ("x", Some("tool"), FaultKind::Sign),
        ("y", Some("command"), FaultKind::Unit),
    ];
    assert_eq!(faults(&trace), expected.into(), "{}", context(&trace));
    assert_named(&trace, &[]);
    // The corrected logs are those of the sound machine: all stages are evaluated, and their residuals are the noise.
    for error in trace.axes.iter().flat_map(|axis| &axis.errors) {
        let [fit, validate] = [error.after.fit, error.after.validate].map(|rms| rms / error.noise);
        assert!((0.9..1.3).contains(&fit) && (0.9..1.3).contains(&validate), "{error:?}");
    }
    assert!(trace.axes.iter().all(|axis| axis.errors.len() == 4), "{}", context(&trace));
}
