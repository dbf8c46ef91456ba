//! A mode of the tool above the frequencies of the motions.

use std::f64::consts::TAU;

use trace::certainty::is_certain;

use super::machine::TestMachine;
use super::reported::{assert_named, assert_value, context, found};

/// Frequencies of two modes of one tool.
const MODES_HZ: [f64; 2] = [40.0, 120.0];

/// A machine whose x axis has a mode of this frequency, with a damping ratio of 0.05.
fn with_mode(frequency_hz: f64) -> TestMachine {
    let mut machine = TestMachine::new(3);
    machine.drawn.axes[0].resonance = Some([TAU * frequency_hz, 0.05]);
    machine
}

/// Far below its frequency, the tool follows by −a/ω². Once: "the tool is displaced by −0.283 ± 0.004 µm per m/s² of
/// the axis's own acceleration", certain.
#[test]
fn a_mode_far_above_the_motion_is_not_certainly_an_intalk() {
    // 0.283 and 0.158 µm s²/m.
    for frequency_hz in [300.0, 400.0] {
        let trace = with_mode(frequency_hz).trace();
        let [found] = trace.axes()[0].found.as_slice() else { panic!("{}", context(&trace)) };
        let [rival] = found.rivals.as_slice() else { panic!("{}", context(&trace)) };
        let mut names = [found.effect.name(), rival.name()];
        names.sort_unstable();
        assert_eq!(names, ["intalk", "resonance"], "{}", context(&trace));
    }
}

/// Once 200 Hz was an in-talk, too. The noise of the scale excites the model of the mode, so that the fit chooses more damping (0.093
/// at 200 Hz), which the interval has to contain. It leaves 5 % more than the noise of the tool at 200 Hz: an in-talk, whose acceleration is
/// filtered wider, leaves as little.
#[test]
fn a_fast_mode_has_its_frequency_and_damping() {
    for (frequency_hz, max_damping_half_width) in [(100.0, 0.005), (150.0, 0.01), (200.0, 0.1)] {
        let trace = with_mode(frequency_hz).trace();
        assert_named(&trace, &[("x", "resonance")]);
        let found = found(&trace, 0, "resonance");
        let rivals: &[&str] = if frequency_hz < 200.0 { &[] } else { &["intalk"] };
        assert_eq!(found.rival_names(), rivals, "{}", context(&trace));
        assert_value(found, "frequency_hz", frequency_hz, 0.05 * frequency_hz);
        assert_value(found, "damping_ratio", 0.05, max_damping_half_width);
    }
}

/// Two modes whose deflections add up. Once: an in-talk and a late reading beside one mode, all certain, with eight times the noise left.
#[test]
fn two_modes_of_the_tool_are_both_found() {
    for (seed, zeta) in [(3, 0.05), (8, 0.08)] {
        let mut machine = TestMachine::new(seed);
        let x = &mut machine.drawn.axes[0];
        [x.resonance, x.second_resonance] = MODES_HZ.map(|hertz| Some([TAU * hertz, zeta]));
        let trace = machine.trace();
        assert_named(&trace, &[("x", "resonance"), ("x", "resonance")]);
        let mut modes: Vec<_> = trace.axes()[0].found.iter().collect();
        modes.sort_by(|a, b| a.effect.values()[0].total_cmp(&b.effect.values()[0]));
        for (mode, hertz) in modes.into_iter().zip(MODES_HZ) {
            assert!(is_certain(&trace.axes()[0], mode), "{}", context(&trace));
            // The same bound of the frequency as of a single mode, and ten times smaller ones of the damping than its value.
            assert_value(mode, "frequency_hz", hertz, 0.05 * hertz);
            assert_value(mode, "damping_ratio", zeta, 0.1 * zeta);
            assert_value(mode, "participation", 1.0, 0.1);
        }
    }
}
