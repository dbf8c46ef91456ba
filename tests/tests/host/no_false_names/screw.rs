//! Errors of the screw and gaps that vary along the travel: once a wave or a slope of the screw, or one backlash.

use std::f64::consts::TAU;

use model::effects::Effect;
use model::effects::{PitchMap, StiffnessMap};
use self_test::plant::Sinusoid;
use trace::Identification;
use trace::certainty::is_certain;

use super::machine::{TestMachine, wave_um};
use super::reported::{assert_named, assert_value, context, found, named};

/// The pitch map of an axis, and the slope beside it, µm/m.
fn map_and_slope(trace: &Identification, axis: usize) -> (PitchMap, f64) {
    let Effect::PitchMap(map) = found(trace, axis, "pitch_map").effect.clone() else {
        panic!("{}", context(trace))
    };
    let effects = trace.axes()[axis].found.iter().map(|found| &found.effect);
    let slopes = effects.filter(|effect| effect.name() == "pitch_progressive");
    (map, slopes.map(|effect| effect.values()[0]).sum())
}

/// Largest difference of two lists from their mean difference.
fn largest_difference(of: impl Iterator<Item = (f64, f64)>) -> f64 {
    let differences: Vec<f64> = of.map(|(a, b)| a - b).collect();
    let mean = numerics::mean(differences.iter().copied());
    numerics::max_abs(differences.iter().map(|difference| difference - mean))
}

/// Three waves of several µm over 140 and 110 mm of travel.
#[test]
fn a_smooth_pitch_error_is_a_map() {
    let waves = |phase: f64| {
        vec![wave_um(1.5, 60.0, phase), wave_um(2.5, 110.0, 2.0 * phase), wave_um(4.0, 180.0, 3.0 * phase)]
    };
    let phases = [1.0, 2.5];
    let machine = TestMachine::new(2)
        .with_mechanics(0, |x| x.screw_waves = waves(phases[0]))
        .with_mechanics(1, |y| y.screw_waves = waves(phases[1]));
    let trace = machine.trace();
    for (axis, phase) in phases.into_iter().enumerate() {
        let names: Vec<&str> = trace.axes()[axis].found.iter().map(|found| found.effect.name()).collect();
        assert!(
            names.contains(&"pitch_map")
                && names.iter().all(|name| ["pitch_map", "pitch_progressive"].contains(name)),
            "{}",
            context(&trace)
        );
        let (map, slope) = map_and_slope(&trace, axis);
        assert!(map.error_negative_um.is_none(), "{map:?}");
        // Of the whole error, only the mean is not determined: it is the zero of the scale.
        let pairs = map.positions_mm.iter().zip(&map.error_um).map(|(&mm, &um)| {
            let truth: f64 = waves(phase).iter().map(|wave| 1e6 * wave.at(1e-3 * mm)).sum();
            (um + 1e-3 * mm * slope, truth)
        });
        // A hundredth of the peak-to-peak error of 11 µm; the noise of a reading is 0.05 µm.
        let largest = largest_difference(pairs);
        assert!(largest < 0.1, "{largest} {map:?}");
        // The probe follows the table, so that the scale is right.
        assert!(is_certain(&trace.axes()[axis], found(&trace, axis, "pitch_map")), "{}", context(&trace));
    }
    let trace = machine.trace_of(|log| log.axes[0].tool = None);
    assert_eq!(found(&trace, 0, "pitch_map").rival_names(), ["scale_cyclic"], "{}", context(&trace));
}

/// Once a dividing error of the resolver or a torque ripple; the belt once a wave of one lead.
#[test]
fn a_second_harmonic_and_a_belt_are_waves_with_their_own_periods() {
    let (amplitude_um, belt_mm) = (2.5, 37.0);
    let machine = TestMachine::new(1);
    let lead_mm = machine.drawn.declared[1].lead_mm;
    let machine = machine
        .with_mechanics(0, |x| x.screw_waves = vec![wave_um(amplitude_um, belt_mm, 1.0)])
        .with_mechanics(1, |y| y.screw_waves = vec![wave_um(amplitude_um, 0.5 * lead_mm, 1.0)]);
    let trace = machine.trace();
    assert_named(&trace, &[("x", "pitch_cyclic"), ("y", "pitch_cyclic")]);
    let [belt, second] = [0, 1].map(|axis| found(&trace, axis, "pitch_cyclic"));
    for wave in [belt, second] {
        assert_value(wave, "amplitude_um", amplitude_um, 0.01 * amplitude_um);
    }
    // Over 136 mm, the phase at the ends changes by 2π·68/37 for a period that is wrong by its own length.
    assert_value(belt, "period_mm", belt_mm, 0.01);
    // An order of the lead is not fitted.
    assert_eq!(second.effect.values()[1].to_bits(), (0.5 * lead_mm).to_bits());
}

/// A belt on 109 and 110 mm of travel, of which it fills less than three waves: once a map, and a slope of 6 µm/m beside it.
#[test]
fn a_belt_of_less_than_three_waves_is_a_wave() {
    let (amplitude_um, belt_mm) = (2.5, 37.0);
    for seed in [1, 2] {
        let machine = TestMachine::new(seed);
        let machine =
            machine.with_mechanics(1, |y| y.screw_waves = vec![wave_um(amplitude_um, belt_mm, 1.0)]);
        let trace = machine.trace();
        assert_named(&trace, &[("y", "pitch_cyclic")]);
        let belt = found(&trace, 1, "pitch_cyclic");
        assert_value(belt, "amplitude_um", amplitude_um, 0.01 * amplitude_um);
        assert_value(belt, "period_mm", belt_mm, 0.01);
    }
}

/// Once one backlash, with most of the residual left, or nothing: a constant gap makes the force of one log worse.
#[test]
fn a_varying_gap_is_a_backlash_and_a_map_with_a_curve_for_each_direction() {
    assert_gaps(2, &[(0, (6.0, 0.5, 200.0)), (1, (8.0, 0.6, 180.0))]);
    assert_gaps(1, &[(1, (8.0, 0.6, 180.0))]);
}

/// Asserts that gaps of a width, µm, that vary by a fraction of it with a period, mm, are found on axes of a machine.
fn assert_gaps(seed: u64, gaps: &[(usize, (f64, f64, f64))]) {
    let gap = |(_, variation, period_mm): (f64, f64, f64)| Sinusoid {
        amplitude: variation,
        period: 1e-3 * period_mm,
        phase: 1.0,
    };
    let mut machine = TestMachine::new(seed);
    for &(axis, of_axis) in gaps {
        machine = machine.with_mechanics(axis, |mechanics| {
            mechanics.backlash_m = 1e-6 * of_axis.0;
            mechanics.backlash_wave = gap(of_axis);
        });
    }
    let trace = machine.trace();
    let names = |&(axis, _): &(usize, _)| ["backlash", "pitch_map"].map(|name| (["x", "y"][axis], name));
    let expected: Vec<_> = gaps.iter().flat_map(names).collect();
    assert_eq!(named(&trace), expected, "{}", context(&trace));
    for &(axis, (width_um, variation, period_mm)) in gaps {
        let mean_um = found(&trace, axis, "backlash").effect.values()[0];
        let (map, _) = map_and_slope(&trace, axis);
        let negative = map.error_negative_um.as_ref().unwrap();
        let curves = map.error_um.iter().zip(negative);
        for (mm, (plus, minus)) in map.positions_mm.iter().zip(curves) {
            let found_um = mean_um + minus - plus;
            let truth_um = width_um * (1.0 + variation * (TAU * mm / period_mm + 1.0).sin());
            // A twentieth of the gap; a spline through six knots over three quarters of a wave differs by some percent.
            assert!(
                (found_um - truth_um).abs() < 0.05 * width_um,
                "{axis} {mm}: {found_um} {truth_um} {map:?}"
            );
        }
    }
}

/// Stiffness 1 + amplitude·sin(2πx/0.33 m + phase) of the declared one, over a travel of 140 mm.
fn wave_of_stiffness(amplitude: f64, phase: f64) -> Sinusoid {
    Sinusoid { amplitude, period: 0.33, phase }
}

/// True compliance as a part of the declared one, divided by the found one, at the inner four fifths of a map: least and greatest.
fn compliance_ratios(map: &StiffnessMap, wave: &Sinusoid) -> [f64; 2] {
    let curve = map.curve();
    let (first, last) = (map.positions_mm[0], map.positions_mm[map.positions_mm.len() - 1]);
    let at = |i: u32| 1e-3 * (first + (last - first) * (0.1 + 0.8 * f64::from(i) / 100.0));
    let ratio = |m: f64| 1.0 / (1.0 + wave.at(m)) / (1.0 + curve.value(m));
    let ratios: Vec<f64> = (0..=100).map(|i| ratio(at(i))).collect();
    [numerics::min(ratios.iter().copied()), numerics::max_abs(ratios.iter().copied())]
}

/// A screw whose stiffness varies over the travel: of x about the declared one, of y far below it, so that a wind-up and a map belong
/// together. Once the residual was left and said to depend on the force.
#[test]
fn a_stiffness_that_varies_is_a_map() {
    let waves = [wave_of_stiffness(0.3, 0.0), wave_of_stiffness(0.45, 4.4)];
    let machine = TestMachine::new(3)
        .with_mechanics(0, |x| x.stiffness_wave = waves[0])
        .with_mechanics(1, |y| y.stiffness_wave = waves[1]);
    let trace = machine.trace();
    assert_named(&trace, &[("x", "stiffness_map"), ("y", "stiffness_map"), ("y", "windup")]);
    let declared = machine.file();
    for (axis, wave) in waves.iter().enumerate() {
        let Effect::StiffnessMap(map) = &found(&trace, axis, "stiffness_map").effect else {
            panic!("{}", context(&trace))
        };
        let [least, greatest] = compliance_ratios(map, wave);
        // The factor of both is that of the mean stiffness to the declared one. A stretch of 3 µm with a noise of 0.05 µm in 80 000 samples
        // shows a compliance far better than 2 %.
        assert!(greatest / least < 1.03, "{axis}: {least} {greatest} {map:?}");
        if axis == 1 {
            let stiffness = found(&trace, axis, "windup").effect.values()[0];
            let ratio = declared.axis["y"].settings.mechanics.stiffness_n_per_um.unwrap() / stiffness;
            assert!((ratio / least).max(greatest / ratio) < 1.04, "{ratio}: {least} {greatest}");
        }
    }
}
