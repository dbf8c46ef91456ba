//! Guides that are not straight, and carriages that turn, in the tool.

use std::f64::consts::TAU;

use model::effects::Effect;
use model::position_curve::PositionCurve;
use self_test::plant::Sinusoid;
use trace::Identification;

use super::machine::TestMachine;
use super::reported::{assert_named, assert_value, context, found};

/// Two waves of 3 and 1.5 µm over the travel of the other axis, m over m.
const WAVES: [Sinusoid; 2] = [
    Sinusoid { amplitude: 3e-6, period: 0.17, phase: 0.4 },
    Sinusoid { amplitude: 1.5e-6, period: 0.085, phase: 2.0 },
];

fn true_um(position_mm: f64) -> f64 {
    WAVES
        .iter()
        .map(|wave| 1e6 * wave.amplitude * (TAU * 1e-3 * position_mm / wave.period + wave.phase).sin())
        .sum()
}

/// The machine with the bent guide of the other axis in the tool of one.
fn bent(axis: usize) -> TestMachine {
    let mut machine = TestMachine::new(21);
    machine.drawn.axes[axis].guide_waves = WAVES.to_vec();
    machine
}

/// Largest deviation of the found map, with a slope (µm/m) added, from the true shape over the inner nine tenths of the travel, both without
/// their mean, µm.
fn deviation_um(traced: &Identification, axis: usize, slope_um_per_m: f64) -> f64 {
    let Effect::StraightnessMap(map) = &found(traced, axis, "straightness_map").effect else {
        panic!("{}", context(traced))
    };
    let (first, last) = (map.positions_mm[0], map.positions_mm[map.positions_mm.len() - 1]);
    let curve = PositionCurve::new(&map.positions_mm, &map.error_um);
    let at = |i: u32| first + (last - first) * (0.05 + 0.9 * f64::from(i) / 200.0);
    let differences: Vec<f64> =
        (0..=200).map(at).map(|mm| curve.value(mm) + 1e-3 * slope_um_per_m * mm - true_um(mm)).collect();
    let mean = numerics::mean(differences.iter().copied());
    differences.iter().fold(0.0, |largest, difference| largest.max((difference - mean).abs()))
}

/// The slope of the map is its own on the second axis. The probe's noise is 0.04 µm; a map of 20 knots of 80 000 samples has an error far below
/// it, and its spline leaves 5/384·(2πh/P)⁴ of a wave: 0.1 µm of the shorter one with a knot every 15 mm.
#[test]
fn a_bent_guide_in_the_second_axis() {
    let traced = bent(1).trace();
    assert_named(&traced, &[("y", "straightness_map")]);
    let deviation_um = deviation_um(&traced, 1, 0.0);
    assert!(deviation_um < 0.15, "{deviation_um}: {}", context(&traced));
}

/// Beside a squareness of 90 µm/m of the first axis, which keeps the slope.
#[test]
fn a_bent_guide_beside_a_squareness() {
    let mut machine = bent(0);
    machine.drawn.axes[0].squareness = 90e-6;
    let traced = machine.trace();
    assert_named(&traced, &[("x", "squareness"), ("x", "straightness_map")]);
    let slope_um_per_m = found(&traced, 0, "squareness").effect.values()[0] - 90.0;
    let deviation_um = deviation_um(&traced, 0, slope_um_per_m);
    assert!(deviation_um < 0.15, "{deviation_um}: {}", context(&traced));
}

/// 400 µm per m of travel and m of lever: 1.4 µm at 60 mm each. The probe's noise of 0.04 µm in some thousand independent samples, over
/// products of rms 1e-3 m², leaves less than 2 µm/m².
#[test]
fn a_carriage_that_turns_as_it_moves() {
    for (axis, name, um_per_m2) in [(0, "x", 400.0), (1, "y", -400.0)] {
        let mut machine = TestMachine::new(22);
        machine.drawn.axes[axis].yaw_per_m = 1e-6 * um_per_m2;
        let traced = machine.trace();
        assert_named(&traced, &[(name, "yaw")]);
        assert_value(found(&traced, axis, "yaw"), "um_per_m2", um_per_m2, 2.0);
    }
}

/// The three displacements of the tool by positions of the other axis are told apart: a slope, a bow and a lever.
#[test]
fn a_turning_carriage_beside_a_squareness_and_a_bow() {
    let mut machine = TestMachine::new(23);
    let axis = &mut machine.drawn.axes[0];
    (axis.squareness, axis.straightness_per_m, axis.yaw_per_m) = (90e-6, 300e-6, -500e-6);
    let traced = machine.trace();
    assert_named(&traced, &[("x", "squareness"), ("x", "straightness"), ("x", "yaw")]);
    assert_value(found(&traced, 0, "yaw"), "um_per_m2", -500.0, 2.0);
}
