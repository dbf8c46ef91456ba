//! Broken channels in the logs of the second simulator; those of the demo machine are in `data_faults.rs`.

use std::collections::BTreeSet;

use files::log::{Channel, Log};
use model::effects::Stage;
use trace::Identification;
use trace::data_faults::FaultKind;

use super::machine::TestMachine;
use super::reported::{assert_named, context};

fn scaled(log: &mut Log, axis: usize, channel: Channel, factor: f64) {
    log.axes[axis].channel_mut(channel).as_mut().unwrap().iter_mut().for_each(|value| *value *= factor);
}

/// Axis, channel and kind of the faults, without those that repeat them in other logs.
fn faults(trace: &Identification) -> BTreeSet<(&str, Option<&str>, FaultKind)> {
    let faults = trace.axes().iter().flat_map(|axis| &axis.data_faults);
    faults.map(|fault| (fault.axis.as_str(), fault.channel.map(Channel::word), fault.kind)).collect()
}

/// The drive's force with the wrong sign was "Coulomb friction 22.53 ± 0.06 % below the declared one".
#[test]
fn a_reversed_force_is_a_fault_and_not_a_friction() {
    let machine = TestMachine::new(3);
    let reversed = machine.trace_of(|log| scaled(log, 0, Channel::Force, -1.0));
    assert_eq!(faults(&reversed), [("x", Some("force"), FaultKind::Sign)].into(), "{}", context(&reversed));
    assert_named(&reversed, &[]);
    // The corrected log is that of the sound machine, to the last bit.
    let sound = machine.trace();
    let values = |trace: &Identification| trace.axes()[0].declared_values.clone();
    assert_eq!(values(&reversed), values(&sound));
    assert!(values(&reversed).iter().all(|value| !value.is_beyond_tolerance), "{}", context(&reversed));
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
    for error in trace.axes().iter().flat_map(|axis| &axis.residuals) {
        let [fit, validate] = [error.after.fit, error.after.validate].map(|rms| rms / error.noise);
        assert!((0.9..1.4).contains(&fit) && (0.9..1.4).contains(&validate), "{error:?}");
    }
    let stages =
        |axis: usize| trace.axes()[axis].residuals.iter().map(|error| error.stage).collect::<BTreeSet<_>>();
    let all = BTreeSet::from([Stage::Force, Stage::Table, Stage::Motor, Stage::Tool]);
    assert_eq!(stages(0), all);
    assert_eq!(&all - &stages(1), [Stage::Force].into());
}

/// A probe that wanders by up to 0.3 mm leaves the model of x undescribed: what is found beside it is not certain.
#[test]
fn no_effect_is_certain_beside_a_gross_residual() {
    let machine = TestMachine::new(5).with_mechanics(0, |mechanics| {
        (mechanics.stribeck_n, mechanics.stribeck_m_per_s) = (120.0, 6e-3);
    });
    let wander_mm = |i: usize| 0.3 * (1.0e-3 * i as f64).sin() * (1.7e-3 * i as f64).sin();
    let certainty = |change: &dyn Fn(&mut Log)| {
        let json = serde_json::json!(trace::json::effects(&machine.trace_of(change)));
        let mut effects = json.as_array().unwrap().iter();
        let stribeck = effects.find(|effect| effect["name"] == "stribeck" && effect["axis"] == "x").unwrap();
        stribeck["certainty"].clone()
    };
    assert_eq!(certainty(&|_| {}), "certain");
    let wandering = |log: &mut Log| {
        log.axes[0].tool.iter_mut().flatten().enumerate().for_each(|(i, mm)| *mm += wander_mm(i));
    };
    assert_eq!(certainty(&wandering), "ambiguous");
}
