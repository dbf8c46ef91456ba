//! Offsets of readings that look like displacements of the tool and forces on the table.

use std::f64::consts::TAU;

use trace::Identification;

use super::machine::TestMachine;
use super::probe_and_scale::mount;
use super::reported::{assert_value, beyond_tolerance, certain, context, found};

/// Samples on either side over which an acceleration is taken.
const HALF_SPAN: usize = 8;

/// Second difference of positions in mm, m/s²; zero at both ends.
fn acceleration(mm: &[f64], sample_s: f64) -> Vec<f64> {
    let mut result = vec![0.0; mm.len()];
    let span_s = HALF_SPAN as f64 * sample_s;
    for (window, acceleration) in mm.windows(2 * HALF_SPAN + 1).zip(&mut result[HALF_SPAN..]) {
        let difference_mm = window[0] - 2.0 * window[HALF_SPAN] + window[2 * HALF_SPAN];
        *acceleration = 1e-3 * difference_mm / (span_s * span_s);
    }
    result
}

/// The trace of a machine whose reading head of the axis `head` is displaced by the acceleration of the axis `by`, µm per m/s².
fn with_displaced_head(seed: u64, [head, by]: [usize; 2], um_s2_per_m: f64) -> Identification {
    TestMachine::new(seed).trace_of(|log| {
        let accelerations = acceleration(log.axes[by].table.as_ref().unwrap(), log.sample_time_s);
        let readings = log.axes[head].table.as_mut().unwrap();
        readings.iter_mut().zip(accelerations).for_each(|(mm, a)| *mm += 1e-3 * um_s2_per_m * a);
    })
}

/// Once: an in-talk of −0.4 µm per m/s², certain; below that, the stretch of the drive absorbs it: masses 12 to 20 % beyond their
/// tolerance.
#[test]
fn a_displaced_head_is_no_certain_intalk_and_no_other_mass() {
    for (seed, um_s2_per_m) in [(1, 0.1), (2, 0.1), (1, -0.2), (1, 0.4)] {
        let trace = with_displaced_head(seed, [0, 0], um_s2_per_m);
        assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
        let intalk = found(&trace, 0, "intalk");
        assert!(intalk.rival_names().contains(&"scale_head"), "{}", context(&trace));
        // The tool does not follow the head.
        assert_value(intalk, "um_s2_per_m", -um_s2_per_m, 0.01);
    }
}

/// Once: a cross-talk, certain. The motor, which the scale does not follow, shows that it is none.
#[test]
fn a_head_displaced_by_the_other_axis_is_no_certain_crosstalk() {
    for um_s2_per_m in [0.1, 0.5] {
        let trace = with_displaced_head(1, [0, 1], um_s2_per_m);
        assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
        let rivals = found(&trace, 0, "crosstalk").rival_names();
        assert_eq!(rivals, ["scale_head"], "{}", context(&trace));
    }
}

/// Where the scale follows the motor, the tool is displaced.
#[test]
fn displacements_of_the_tool_are_certain_if_the_scale_follows_the_motor() {
    let mut machine = TestMachine::new(1);
    machine.drawn.axes[0].intalk_s2 = 0.8e-6;
    machine.drawn.axes[1].crosstalk_s2 = 0.5e-6;
    let trace = machine.trace();
    assert_eq!(certain(&trace), [("x", "intalk"), ("y", "crosstalk")], "{}", context(&trace));
}

/// Without a command there is no loop: nothing tells an offset of the log from a force that the drive balances.
#[test]
fn an_offset_of_the_force_without_a_loop_is_no_certain_load() {
    let trace = TestMachine::new(1).trace_of(|log| {
        log.axes.iter_mut().for_each(|axis| axis.command = None);
        log.axes[0].force.as_mut().unwrap().iter_mut().for_each(|force_n| *force_n += 35.0);
    });
    assert_eq!((certain(&trace), beyond_tolerance(&trace)), (vec![], vec![]), "{}", context(&trace));
    let load = found(&trace, 0, "constant_load");
    assert_eq!(load.rival_names(), ["force_offset"], "{}", context(&trace));
    assert_value(load, "force_n", 35.0, 1.0);
}

/// A tool with an in-talk and a mode on one axis, which a turned probe reads on the other one, too: 0.87 mrad of 21 µm per m/s². Once: a
/// cross-talk of 0.021 ± 0.001 µm per m/s², certain. A true one is larger.
#[test]
fn what_a_turned_probe_reads_of_a_displacement_is_no_certain_crosstalk() {
    for (axis, crosstalk_s2) in [(0, 0.0), (1, 0.0), (0, 0.8e-6)] {
        let mut machine = TestMachine::new(1);
        machine.drawn.axes[axis].intalk_s2 = -2.3e-6;
        machine.drawn.axes[axis].resonance = Some([TAU * 34.5, 0.04]);
        let other = ["y", "x"][axis];
        machine.drawn.axes[1 - axis].crosstalk_s2 = crosstalk_s2;
        let trace = machine.trace_of(|log| mount(log, 0.87e-3, 0.0));
        let is_certain = certain(&trace).contains(&(other, "crosstalk"));
        assert_eq!(is_certain, crosstalk_s2 != 0.0, "{}", context(&trace));
    }
}
