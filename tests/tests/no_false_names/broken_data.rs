//! Broken channels in the logs of the second simulator; those of the demo machine are in `data_faults.rs`.

use std::collections::BTreeSet;

use files::log::{Channel, Log};
use model::effects::Stage;
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

/// A scale in inches was "100000 µm/m less far", a reversed one "100 ms late", a command in µm "explained", and a force that
/// does not change a constant load.
#[test]
fn a_wrong_unit_or_sign_and_a_dead_force_are_named_and_no_effect() {
    let machine = TestMachine::new(3);
    let trace = machine.trace_of(|log| {
        scaled(log, 0, Channel::Table, 1.0 / 25.4);
        scaled(log, 0, Channel::Tool, -1.0);
        scaled(log, 1, Channel::Command, 1e3);
        log.axes[1].force.as_mut().unwrap().fill(50.0);
    });
    let expected = [
        ("x", Some("table"), FaultKind::Unit),
        ("x", Some("tool"), FaultKind::Sign),
        ("y", Some("command"), FaultKind::Unit),
        ("y", Some("force"), FaultKind::Dead),
    ];
    assert_eq!(faults(&trace), expected.into(), "{}", context(&trace));
    assert_named(&trace, &[]);
    // The corrected logs are those of the sound machine: the residuals of all stages are the noise. Without the force, the
    // friction is less well known.
    for error in trace.axes.iter().flat_map(|axis| &axis.errors) {
        let [fit, validate] = [error.after.fit, error.after.validate].map(|rms| rms / error.noise);
        assert!((0.9..1.4).contains(&fit) && (0.9..1.4).contains(&validate), "{error:?}");
    }
    let stages =
        |axis: usize| trace.axes[axis].errors.iter().map(|error| error.stage).collect::<BTreeSet<_>>();
    let all = BTreeSet::from([Stage::Force, Stage::Table, Stage::Motor, Stage::Tool]);
    assert_eq!(stages(0), all);
    assert_eq!(&all - &stages(1), [Stage::Force].into());
}
