//! Probes and scales that are not exact: once each of them was a cause in the machine, certain.
//!
//! The channels of the second simulator's logs are changed by the equations of the sensors.

use files::log::{AxisLog, Log};
use model::effects::{Effect, GrowingPart};
use trace::Identification;
use trace::certainty::is_certain;
use trace::verdict::{self, Verdict};

use super::machine::{TestMachine, wave_um};
use super::reported::{assert_named, assert_value, context, found};

/// A machine whose loops are closed by the motors, so that the errors of a scale are in the log alone.
fn machine() -> TestMachine {
    let is_motor_alone = |machine: &TestMachine| {
        machine.drawn.declared.iter().all(|axis| axis.text.contains("feedback = \"motor\""))
    };
    (3..40).map(TestMachine::new).find(is_motor_alone).unwrap()
}

fn assert_certain(trace: &Identification, axis: usize, name: &str) {
    assert!(is_certain(&trace.axes()[axis], found(trace, axis, name)), "{}", context(trace));
}

/// The effect is ambiguous, with this rival.
fn assert_rival(trace: &Identification, axis: usize, name: &str, rival: &str) {
    let found = found(trace, axis, name);
    let rivals = found.rival_names();
    assert!(!is_certain(&trace.axes()[axis], found) && rivals.contains(&rival), "{}", context(trace));
}

fn tool(axis: &mut AxisLog) -> &mut Vec<f64> {
    axis.tool.as_mut().unwrap()
}

/// What a probe reads that is turned by an angle (rad) about the third axis and has a gain: (1 + gain)·(x + angle·y) and
/// (1 + gain)·(y − angle·x).
pub(super) fn mount(log: &mut Log, angle: f64, gain: f64) {
    let [x, y] = &mut log.axes[..] else { panic!() };
    for (x, y) in tool(x).iter_mut().zip(tool(y)) {
        (*x, *y) = ((1.0 + gain) * (*x + angle * *y), (1.0 + gain) * (*y - angle * *x));
    }
}

/// A probe turned by 0.01° and 300 µm/m too large. Once: squareness of −174.5 ± 0.01 µm/m, certain, and seven ambiguous names.
/// Half widths: noise of 40 nm over some thousand samples and 50 mm gives 0.05 µm/m.
#[test]
fn a_turned_probe_is_no_squareness() {
    let angle = 0.01f64.to_radians();
    let trace = machine().trace_of(|log| mount(log, angle, 300e-6));
    assert_named(
        &trace,
        &[("x", "probe_gain"), ("x", "probe_rotation"), ("y", "probe_gain"), ("y", "probe_rotation")],
    );
    for axis in [0, 1] {
        assert_value(found(&trace, axis, "probe_rotation"), "um_per_m", 1e6 * angle * 1.0003, 0.5);
        assert_value(found(&trace, axis, "probe_gain"), "um_per_m", 300.0, 0.5);
        assert_certain(&trace, axis, "probe_rotation");
    }
}

/// Axes out of square by 60 µm/m under a probe that is turned by −300 µm/m; and by −60, so that the first axis shows nothing.
#[test]
fn a_squareness_is_measured_by_a_turned_probe() {
    for angle in [-300e-6, -60e-6] {
        let mut machine = machine();
        machine.drawn.axes[0].squareness = 60e-6;
        let trace = machine.trace_of(|log| mount(log, angle, 0.0));
        assert_named(&trace, &[("x", "probe_rotation"), ("x", "squareness"), ("y", "probe_rotation")]);
        assert_value(found(&trace, 0, "squareness"), "um_per_m", 60.0, 0.5);
        assert_certain(&trace, 0, "squareness");
        assert_value(found(&trace, 1, "probe_rotation"), "um_per_m", 1e6 * angle, 0.5);
    }
}

/// The alignment of ordinary probes beside a true squareness. Once: "the model does not fit", seven ambiguous names, true effects missed.
#[test]
fn a_squareness_is_measured_by_a_probe_that_is_turned_and_has_a_gain() {
    for (angle, gain) in [(0.6e-3, 0.6e-3), (0.2e-3, 0.2e-3)] {
        let mut machine = machine();
        machine.drawn.axes[0].squareness = 60e-6;
        let trace = machine.trace_of(|log| mount(log, angle, gain));
        let expected = [
            ("x", "probe_gain"),
            ("x", "probe_rotation"),
            ("x", "squareness"),
            ("y", "probe_gain"),
            ("y", "probe_rotation"),
        ];
        assert_named(&trace, &expected);
        assert_certain(&trace, 0, "squareness");
        assert_value(found(&trace, 0, "squareness"), "um_per_m", 60.0 * (1.0 + gain), 0.5);
        for axis in [0, 1] {
            assert_value(found(&trace, axis, "probe_gain"), "um_per_m", 1e6 * gain, 0.5);
            assert_value(found(&trace, axis, "probe_rotation"), "um_per_m", 1e6 * angle * (1.0 + gain), 0.5);
        }
        assert!(verdict::of(&trace) < Verdict::ModelDoesNotFit, "{}", context(&trace));
    }
}

/// Without the probe's reading of the second axis, nothing tells a squareness from the angle of the probe.
#[test]
fn a_squareness_without_the_second_axis_is_ambiguous() {
    let mut machine = machine();
    machine.drawn.axes[0].squareness = 60e-6;
    assert_certain(&machine.trace(), 0, "squareness");
    let trace = machine.trace_of(|log| log.axes[1].tool = None);
    assert_rival(&trace, 0, "squareness", "probe_rotation");
}

fn stretch(values: &mut Option<Vec<f64>>, gain: f64) {
    values.as_mut().unwrap().iter_mut().for_each(|mm| *mm *= 1.0 + gain);
}

/// A scale that reads 50 µm/m short: the table stage has this slope, the tool stage the opposite one. Once: the screw moves the table
/// 50.03 µm/m less, certain. A screw of this error leaves the tool with the scale, and is certain.
#[test]
fn a_scale_that_is_too_short_is_not_the_screw() {
    let trace = machine().trace_of(|log| stretch(&mut log.axes[0].table, -50e-6));
    assert_named(&trace, &[("x", "scale_gain")]);
    assert_value(found(&trace, 0, "scale_gain"), "um_per_m", -50.0, 0.5);
    assert_certain(&trace, 0, "scale_gain");

    let screw = machine().with_mechanics(0, |mechanics| mechanics.pitch_slope = -50e-6);
    let trace = screw.trace();
    assert_named(&trace, &[("x", "pitch_progressive")]);
    assert_certain(&trace, 0, "pitch_progressive");
    let trace = screw.trace_of(|log| log.axes[0].tool = None);
    assert_rival(&trace, 0, "pitch_progressive", "scale_gain");
}

/// A scale that is too short under a probe whose gain is off by 200 µm/m: neither slope is that of one sensor alone.
#[test]
fn a_slope_that_two_sensors_share_is_ambiguous() {
    let trace = machine().trace_of(|log| {
        stretch(&mut log.axes[0].table, -50e-6);
        mount(log, 0.0, 200e-6);
    });
    assert_rival(&trace, 0, "pitch_progressive", "scale_gain");
}

/// A wave of 3 µm of the scale's mounting, which the probe does not see, with a period that is none of the screw. Once: a periodic
/// error of the screw, certain. The same wave of a belt is certain, and ambiguous without the probe.
#[test]
fn a_wave_of_the_scale_is_not_the_screw() {
    let wave = |mm: f64| 3e-3 * (std::f64::consts::TAU * mm / 37.0 + 0.4).sin();
    let trace = machine().trace_of(|log| {
        log.axes[0].table.as_mut().unwrap().iter_mut().for_each(|mm| *mm += wave(*mm));
    });
    assert_named(&trace, &[("x", "scale_cyclic")]);
    assert_value(found(&trace, 0, "scale_cyclic"), "amplitude_um", 3.0, 0.05);
    assert_certain(&trace, 0, "scale_cyclic");

    let mut belt = machine();
    belt.drawn.axes[0].mechanics.pitch = wave_um(3.0, 37.0, 0.4);
    let trace = belt.trace();
    assert_named(&trace, &[("x", "pitch_cyclic")]);
    assert_certain(&trace, 0, "pitch_cyclic");
    let trace = belt.trace_of(|log| log.axes[0].tool = None);
    assert_rival(&trace, 0, "pitch_cyclic", "scale_cyclic");
}

/// A wave of the scale that is about as long as the travel. Once: an error map of the screw, certain, although the probe contradicts it.
#[test]
fn a_long_error_of_the_scale_is_no_certain_map_of_the_screw() {
    let wave = |mm: f64| 2.7e-3 * (std::f64::consts::TAU * mm / 90.0 + 0.4).sin();
    let trace = machine().trace_of(|log| {
        log.axes[1].table.as_mut().unwrap().iter_mut().for_each(|mm| *mm += wave(*mm));
    });
    let of_screw = ["pitch_map", "pitch_cyclic", "pitch_progressive"];
    let y = &trace.axes()[1];
    let certain: Vec<&str> =
        y.found.iter().filter(|found| is_certain(y, found)).map(|found| found.effect.name()).collect();
    assert!(!certain.iter().any(|name| of_screw.contains(name)), "{}", context(&trace));
}

/// Adds a displacement (µm) over the time of the session (s) to the tool of x.
fn drift(log: &mut Log, um: impl Fn(f64) -> f64) {
    let (start_s, sample_s) = (log.start_s, log.sample_time_s);
    for (i, mm) in tool(&mut log.axes[0]).iter_mut().enumerate() {
        *mm += 1e-3 * um(start_s + i as f64 * sample_s);
    }
}

/// 6 µm at 8 s and 12 µm at 400 s, of which the logs of some 75 s hold hardly more than the rate. Once: 7.7 ± 0.2 µm with a time constant
/// of 13 s, certain.
#[test]
fn a_drift_with_two_time_constants_is_not_one_with_a_third() {
    let part = |um: f64, tau_s: f64, s: f64| um * (1.0 - (-s / tau_s).exp());
    let trace = machine().trace_of(|log| drift(log, |s| part(6.0, 8.0, s) + part(12.0, 400.0, s)));
    assert_named(&trace, &[("x", "thermal_drift"), ("x", "thermal_drift")]);
    let mut drifts: Vec<_> = trace.axes()[0].found.iter().collect();
    drifts.sort_by(|a, b| a.effect.values()[1].total_cmp(&b.effect.values()[1]));
    for (drift, (amplitude_um, tau_s)) in drifts.iter().zip([(6.0, 8.0), (12.0, 400.0)]) {
        assert_value(drift, "amplitude_um", amplitude_um, 0.3 * amplitude_um);
        assert_value(drift, "time_constant_s", tau_s, 0.3 * tau_s);
        let is_held = tau_s < 70.0;
        let rivals = drift.rival_names();
        assert_eq!(is_certain(&trace.axes()[0], drift), is_held, "{}", context(&trace));
        assert!(is_held || rivals.contains(&"thermal_rate"), "{rivals:?}");
    }
}

/// A linear drift. Once: 70 µm with a time constant of 1359 s, certain.
#[test]
fn a_linear_drift_is_a_rate() {
    let trace = machine().trace_of(|log| drift(log, |s| 3.0 * s / 60.0));
    assert_named(&trace, &[("x", "thermal_rate")]);
    assert_value(found(&trace, 0, "thermal_rate"), "um_per_min", 3.0, 0.02);
    assert_certain(&trace, 0, "thermal_rate");
}

/// Displacement of a mass by a mode (rad/s, damping ratio) against a table, mm: d'' + 2ζω·(d' + v) + ω²·d = −a, from its samples,
/// between which the table moves on cubics, in steps of 1/20 ms.
fn mode_mm(table_mm: &[f64], omega: f64, zeta: f64) -> Vec<f64> {
    const STEPS: u32 = 20;
    let h = 1e-3 / f64::from(STEPS);
    let at = |i: usize, u: f64| {
        let p = |k: usize| table_mm[(i + k).saturating_sub(1).min(table_mm.len() - 1)];
        let [a, b, c, d] = [p(0), p(1), p(2), p(3)];
        b + 0.5 * u * (c - a + u * (2.0 * a - 5.0 * b + 4.0 * c - d + u * (3.0 * (b - c) + d - a)))
    };
    let (mut mass, mut velocity) = (table_mm[0], 0.0);
    let mut offsets = Vec::with_capacity(table_mm.len());
    for (i, table) in table_mm.iter().enumerate() {
        offsets.push(mass - table);
        for step in 0..STEPS {
            let middle = at(i, (f64::from(step) + 0.5) / f64::from(STEPS));
            velocity = (velocity * (1.0 - h * zeta * omega) + h * omega * omega * (middle - mass))
                / (1.0 + h * zeta * omega);
            mass += h * velocity;
        }
    }
    offsets
}

/// Two modes of the tool of x, of 32 Hz and 85 Hz, whose participations add up to 1. Once: one mode, an in-talk and a late reading, all
/// certain, with eight times the noise left.
#[test]
fn two_modes_are_found() {
    const MODES: [(f64, f64, f64); 2] = [(32.0, 0.05, 0.6), (85.0, 0.04, 0.4)];
    let trace = machine().trace_of(|log| {
        let table = log.axes[0].table.clone().unwrap();
        for (hertz, zeta, participation) in MODES {
            let offsets = mode_mm(&table, std::f64::consts::TAU * hertz, zeta);
            let tool = tool(&mut log.axes[0]);
            tool.iter_mut().zip(offsets).for_each(|(mm, offset)| *mm += participation * offset);
        }
    });
    assert_named(&trace, &[("x", "resonance"), ("x", "resonance")]);
    let mut modes: Vec<_> = trace.axes()[0].found.iter().collect();
    modes.sort_by(|a, b| a.effect.values()[0].total_cmp(&b.effect.values()[0]));
    for (mode, (hertz, zeta, participation)) in modes.iter().zip(MODES) {
        let values = mode.effect.values();
        let context = context(&trace);
        assert!((values[0] / hertz - 1.0).abs() < 0.02, "{context}");
        assert!((values[1] / zeta - 1.0).abs() < 0.3, "{context}");
        assert!((values[2] / participation - 1.0).abs() < 0.1, "{context}");
    }
}

/// A scale that grows by 30 µm/m with 20 s, and a screw that does. Once: a slope of the pitch, certain.
#[test]
fn heat_that_grows_an_axis_is_no_slope_of_the_pitch() {
    let grown = |s: f64, mm: f64| 30e-6 * (1.0 - (-s / 20.0).exp()) * mm;
    let add = |log: &mut Log, sign: f64, with_tool: bool| {
        let (start_s, sample_s) = (log.start_s, log.sample_time_s);
        let AxisLog { table, tool, .. } = &mut log.axes[0];
        let channels = [Some(table), with_tool.then_some(tool)];
        for channel in channels.into_iter().flatten().flatten() {
            for (i, mm) in channel.iter_mut().enumerate() {
                *mm += sign * grown(start_s + i as f64 * sample_s, *mm);
            }
        }
    };
    for (sign, with_tool, part) in [(-1.0, false, GrowingPart::Scale), (1.0, true, GrowingPart::Screw)] {
        let trace = machine().trace_of(|log| add(log, sign, with_tool));
        assert_named(&trace, &[("x", "thermal_growth")]);
        let growth = found(&trace, 0, "thermal_growth");
        let Effect::ThermalGrowth(effect) = &growth.effect else { panic!() };
        assert_eq!(effect.part, part, "{}", context(&trace));
        assert_value(growth, "um_per_m", 30.0, 1.0);
        assert_certain(&trace, 0, "thermal_growth");
    }
    let trace = machine().trace_of(|log| {
        add(log, -1.0, false);
        log.axes[0].tool = None;
    });
    assert_rival(&trace, 0, "thermal_growth", "thermal_growth");
}
