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
        // The mode may also be its own rival, with its damper at the table.
        let mut names = [vec![found.effect.name()], found.rival_names()].concat();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names, ["intalk", "resonance"], "{}", context(&trace));
    }
}

/// Once 200 Hz was an in-talk, too. The noise of the scale excites the model of the mode, so that the fit chooses more damping (0.093
/// at 200 Hz), which the interval has to contain. At 200 Hz the lag of 2ζ/ω is less than the tenth of a sample to which the instants of the
/// readings are known: the logs do not tell whether the damper is at the ground or at the table.
#[test]
fn a_fast_mode_has_its_frequency_and_damping() {
    for (frequency_hz, max_damping_half_width) in [(100.0, 0.005), (150.0, 0.01), (200.0, 0.1)] {
        let trace = with_mode(frequency_hz).trace();
        assert_named(&trace, &[("x", "resonance")]);
        let found = found(&trace, 0, "resonance");
        let rivals: &[&str] = if frequency_hz < 200.0 { &[] } else { &["resonance"] };
        assert_eq!(found.rival_names(), rivals, "{}", context(&trace));
        assert_value(found, "frequency_hz", frequency_hz, 0.05 * frequency_hz);
        assert_value(found, "damping_ratio", 0.05, max_damping_half_width);
    }
}

/// A damper between table and tool, where the transfer function has 2ζωs in the numerator as well. Once: beside a mode with a damper at the ground
/// a tool that is logged early by 2ζ/ω, 0.4 to 0.8 ms. With it the mode is as before: at 60 Hz, ζ of 0.05 is the time of 0.27 ms. The bounds
/// of the half widths are those of the modes of 100 Hz.
#[test]
fn the_damper_of_a_mode_is_found_where_it_is() {
    for (frequency_hz, zeta) in [(40.0, 0.05), (60.0, 0.15)] {
        for is_on_table in [true, false] {
            let mut machine = TestMachine::new(3);
            let x = &mut machine.drawn.axes[0];
            x.resonance = Some([TAU * frequency_hz, zeta]);
            x.is_tool_damped_by_table = is_on_table;
            let trace = machine.trace();
            assert_named(&trace, &[("x", "resonance")]);
            let found = found(&trace, 0, "resonance");
            assert!(is_certain(&trace.axes()[0], found), "{}", context(&trace));
            let mode = found.effect.mode().unwrap();
            assert_eq!(!mode.damped_against.is_ground(), is_on_table, "{}", context(&trace));
            assert_value(found, "frequency_hz", frequency_hz, 0.05 * frequency_hz);
            assert_value(found, "damping_ratio", zeta, 0.005);
        }
    }
}

/// Two modes with dampers between table and tool, in whose place two with dampers at the ground and an early reading stood. The bounds are those of
/// [`two_modes_of_the_tool_are_both_found`].
#[test]
fn two_modes_with_dampers_at_the_table_are_both_found() {
    let zeta = 0.08;
    let mut machine = TestMachine::new(8);
    let x = &mut machine.drawn.axes[0];
    [x.resonance, x.second_resonance] = MODES_HZ.map(|hertz| Some([TAU * hertz, zeta]));
    x.is_tool_damped_by_table = true;
    let trace = machine.trace();
    assert_named(&trace, &[("x", "resonance"), ("x", "resonance")]);
    let mut modes: Vec<_> = trace.axes()[0].found.iter().collect();
    modes.sort_by(|a, b| a.effect.values()[0].total_cmp(&b.effect.values()[0]));
    for (mode, hertz) in modes.into_iter().zip(MODES_HZ) {
        // Never certain with the wrong damper.
        let is_right = !mode.effect.mode().unwrap().damped_against.is_ground();
        assert!(is_right || !is_certain(&trace.axes()[0], mode), "{}", context(&trace));
        assert_value(mode, "frequency_hz", hertz, 0.05 * hertz);
        // Without a lag at a steady speed, only the oscillation shows the damping.
        assert_value(mode, "damping_ratio", zeta, 0.15 * zeta);
        assert_value(mode, "participation", 1.0, 0.1);
    }
}

/// Of a small motion beside the noise of the tool, the logs show the slow part of a mode at 150 Hz and its lag, which a late or early reading is as
/// well. Whatever is stated of the damper as a fact is true.
#[test]
fn a_damper_that_the_logs_do_not_show_is_no_fact() {
    for is_on_table in [true, false] {
        for frequency_hz in [150.0, 250.0] {
            let mut machine = with_mode(frequency_hz);
            machine.drawn.axes[0].is_tool_damped_by_table = is_on_table;
            machine.drawn.axes[0].tool_delay_s = 0.5e-3;
            let trace = machine.trace();
            for found in trace.axes()[0].found.iter().filter(|found| is_certain(&trace.axes()[0], found)) {
                let Some(mode) = found.effect.mode() else { continue };
                assert_eq!(!mode.damped_against.is_ground(), is_on_table, "{}", context(&trace));
            }
        }
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
