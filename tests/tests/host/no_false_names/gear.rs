//! The gear of a joint: its hysteresis and its kinematic error.

use self_test::joint::slipping;

use super::machine::{TestMachine, wave_um};
use super::reported::{assert_named, certain, context, found};

/// Torsion after which 1 − 1/e of the torque is reached.
const TRAVEL_MDEG: f64 = 1.2;

/// Torque of the friction within the gear, N·m.
const TORQUE_NM: f64 = 80.0;

/// Stiffness of the gear over that of the drawn screw.
const SOFTER: f64 = 0.4;

/// A strain wave gear has both: a hysteresis, and an error twice per turn of its wave generator. The other joint has neither and gets none.
#[test]
fn a_strain_wave_gear_has_hysteresis_and_an_error_twice_per_turn() {
    let machine = TestMachine::new(2);
    let turn_mm = machine.declared(0, "lead_mm");
    let machine = machine.with_declared(0, "stiffness_n_per_um", |stiffness| SOFTER * stiffness);
    let machine = machine.with_mechanics(0, |mechanics| {
        mechanics.stiffness_n_per_m *= SOFTER;
        mechanics.slipping = slipping(TORQUE_NM, 1e-6 * TRAVEL_MDEG);
        mechanics.screw_waves = vec![wave_um(3.0, 0.5 * turn_mm, 0.7)];
    });
    let trace = machine.trace_as_joints();
    assert_named(&trace, &[("x", "gear_hysteresis"), ("x", "pitch_cyclic")]);
    assert!(certain(&trace).contains(&("x", "gear_hysteresis")), "{}", context(&trace));
    let value = |name: &str, key: &str| {
        let parameters = found(&trace, 0, name).effect.parameters();
        parameters.into_iter().find(|(known, _)| *known == key).unwrap().1
    };
    // The model has eight elements, the gear twelve: the last of eight slips at 4.47 travels, that of twelve at 4.96, some 10 % later, of which the fit makes a part.
    let truths = [("force_n", TORQUE_NM), ("travel_um", TRAVEL_MDEG)];
    for (key, truth) in truths {
        let found = value("gear_hysteresis", key);
        assert!((found / truth - 1.0).abs() < 0.05, "{key} {found}");
    }
    // What the ratio of both leaves open where the torsion stays below its travel: 40 %, and more by what the noise adds.
    for (half, (_, truth)) in found(&trace, 0, "gear_hysteresis").half_widths.iter().zip(truths) {
        assert!((0.35..0.5).contains(&(half / truth)), "{half}");
    }
    assert!((value("pitch_cyclic", "amplitude_um") / 3.0 - 1.0).abs() < 0.03, "{}", context(&trace));
    assert!((value("pitch_cyclic", "period_mm") / (0.5 * turn_mm) - 1.0).abs() < 0.02, "{}", context(&trace));
}

/// A gear without hysteresis has none, as softer as it may be than declared.
#[test]
fn a_soft_gear_is_a_windup() {
    let machine = TestMachine::new(2).with_mechanics(0, |mechanics| mechanics.stiffness_n_per_m *= 0.6);
    assert_named(&machine.trace_as_joints(), &[("x", "windup")]);
}
