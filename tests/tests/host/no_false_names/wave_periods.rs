//! A lead in the machine file that is not that of the screw, while the readings are in mm.

use super::machine::{TestMachine, wave_um};
use super::reported::{assert_named, assert_value, found};

/// Leads of 16, 7 or 5 mm were declared: nothing was found. 20 mm: an error of the motor's reading.
#[test]
fn a_pitch_error_has_the_period_of_the_true_lead() {
    let (amplitude_um, lead_mm) = (5.0, 10.0);
    for (seed, declared_mm) in [(1, [16.0, 7.0]), (2, [5.0, 20.0])] {
        let mut machine = TestMachine::new(seed);
        for (axis, declared_mm) in declared_mm.into_iter().enumerate() {
            machine = machine
                .with_declared(axis, "lead_mm", |_| declared_mm)
                .with_mechanics(axis, |mechanics| mechanics.pitch = wave_um(amplitude_um, lead_mm, 0.7));
        }
        let trace = machine.trace();
        assert_named(&trace, &[("x", "pitch_cyclic"), ("y", "pitch_cyclic")]);
        for axis in [0, 1] {
            let wave = found(&trace, axis, "pitch_cyclic");
            assert_value(wave, "amplitude_um", amplitude_um, 0.01 * amplitude_um);
            // The second order of 20 mm is not fitted and has no interval.
            let period_mm = wave.effect.values()[1];
            assert!((period_mm - lead_mm).abs() < 1e-3 * lead_mm, "{period_mm}");
        }
    }
}

/// Of a resolver with three electrical periods per turn: once an error of the screw, a torque ripple and their harmonics.
#[test]
fn an_error_of_the_resolver_has_the_period_of_the_true_lead() {
    let (amplitude_um, period_mm, declared_mm) = (3.0, 10.0 / 3.0, [16.0, 7.0]);
    let mut machine = TestMachine::new(1);
    for (axis, declared_mm) in declared_mm.into_iter().enumerate() {
        machine = machine.with_declared(axis, "lead_mm", |_| declared_mm);
        machine.drawn.axes[axis].resolver = wave_um(amplitude_um, period_mm, 0.7);
    }
    let trace = machine.trace();
    assert_named(&trace, &[("x", "resolver_dividing"), ("y", "resolver_dividing")]);
    for axis in [0, 1] {
        let wave = found(&trace, axis, "resolver_dividing");
        assert_value(wave, "amplitude_um", amplitude_um, 0.01 * amplitude_um);
        // Over 109 mm, the phase changes by 2π·109·0.001/3.33² = 0.06 rad for a period that is wrong by 1 µm.
        assert_value(wave, "period_mm", period_mm, 1e-3);
    }
}
