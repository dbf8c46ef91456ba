//! Circles with known deviations.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::{assert_near, motion};
use crate::evaluation::ContourError;
use crate::logged::LoggedMotion;
use crate::path::NominalPath;
use motion::{PathBlock, PathShape};

const RADIUS_M: f64 = 0.05;

/// Samples of a turn: 31 mm/s.
const SAMPLES: u32 = 10_000;

/// The angle from the sector's middle to its ends is 1/8°, so that sectors miss a point by this factor of the curvature at
/// most: (π/1440)²/2. Polylines of the command miss the circle by R·(π/10 000)²/2 = 2.5 nm.
const WITHIN_UM: f64 = 0.005;

/// A turn counter-clockwise and one clockwise from `start_rad` about a centre, with a standstill between. The radial
/// deviation (µm) is a function of angle and sense (1, −1); the tool lags by `lag_rad`.
fn circle(
    centre: [f64; 2],
    start_rad: f64,
    lag_rad: f64,
    deviation_um: impl Fn(f64, f64) -> f64,
) -> LoggedMotion {
    let mut points = Vec::new();
    for sense in [1.0, -1.0] {
        for i in 0..=SAMPLES {
            let angle = start_rad + sense * TAU * f64::from(i) / f64::from(SAMPLES);
            let command = [centre[0] + RADIUS_M * angle.cos(), centre[1] + RADIUS_M * angle.sin()];
            // The lag builds up over a tenth of a turn and decays over another tenth.
            let part = 10.0 * f64::from(i.min(SAMPLES - i)) / f64::from(SAMPLES);
            let behind = angle - sense * lag_rad * part.min(1.0);
            let r = RADIUS_M + 1e-6 * deviation_um(behind, sense);
            let tool = [centre[0] + r * behind.cos(), centre[1] + r * behind.sin()];
            points.push((command, [tool[0] - command[0], tool[1] - command[1]]));
        }
        points.extend(vec![points[points.len() - 1]; 100]);
    }
    motion(&points)
}

/// The blocks of [`circle`].
fn blocks(centre_m: [f64; 2]) -> Vec<PathBlock> {
    let turn = |turns| PathBlock::new(PathShape::Arc { plane: [0, 1], centre_m, turns }, 0.03, 1.0);
    vec![PathBlock::dwell(0.4), turn(1.0), PathBlock::dwell(0.1), turn(-1.0), PathBlock::dwell(0.1)]
}

/// r = 4·cos θ + 3·cos 2θ: F from −11/3 (cos θ = −1/3) to 7; the first term is an eccentricity, which G leaves out,
/// G = 2·3; rms √((4² + 3²)/2).
fn assert_harmonics(error: &ContourError) {
    let [circle] = &error.circles[..] else { panic!("{} circles", error.circles.len()) };
    assert_near(circle.radius, RADIUS_M, 1e-8);
    assert_eq!(circle.laps.iter().map(|lap| lap.is_clockwise).collect::<Vec<_>>(), [false, true]);
    for lap in &circle.laps {
        assert_near(lap.radial_um[0], -11.0 / 3.0, WITHIN_UM);
        assert_near(lap.radial_um[1], 7.0, WITHIN_UM);
        assert_near(lap.circular_um, 6.0, WITHIN_UM);
        // See `reversal_spike`; the mean of cos 2·angle from 6° to 10° is 0.960.
        for (spike, sign) in lap.spikes_um.into_iter().zip([1.0, -1.0, 1.0, -1.0]) {
            assert_near(spike, sign * 3.0 * (1.0 - 0.960), 0.01);
        }
    }
    assert_near(circle.bidirectional_um.unwrap(), 6.0, WITHIN_UM);
    assert!(circle.hysteresis_um.unwrap() < WITHIN_UM);
    assert_near(error.max_um, 7.0, WITHIN_UM);
    // 200 of 20 000 samples stand still at 7 µm, and 100 in front.
    let mean_square = (20_002.0 * 12.5 + 300.0 * 49.0) / 20_302.0;
    assert_near(error.rms_um, f64::sqrt(mean_square), 2.0 * WITHIN_UM);
}

#[test]
fn harmonics_of_a_circle_have_their_closed_forms_on_both_kinds_of_path() {
    let harmonics = |angle: f64, _| 4.0 * angle.cos() + 3.0 * (2.0 * angle).cos();
    let centre = [0.1, -0.02];
    let run = circle(centre, 0.0, 0.0, harmonics);
    assert_harmonics(&run.contour_error().unwrap());
    let path = NominalPath::of_blocks(&[centre[0] + RADIUS_M, centre[1]], &blocks(centre));
    let error = run.contour_error_on(&path).unwrap();
    assert_harmonics(&error);
    assert_eq!(error.blocks.iter().map(|block| block.block).collect::<Vec<_>>(), [1, 3]);
}

/// A lag of 0.02 rad is 1 mm along the path, and 200 times the deviation.
#[test]
fn a_lag_along_the_path_is_no_contour_error() {
    let error = circle([0.0; 2], 0.3, 0.02, |_, _| 5.0).contour_error().unwrap();
    assert_near(error.rms_um, 5.0, WITHIN_UM);
    assert_near(error.max_um, 5.0, WITHIN_UM);
    assert!(error.corners.iter().all(|corner| corner.turn_rad > 3.0), "only the reversal is a corner");
}

/// Lost motion of w = 8 µm on x: r = (w/2)·cos θ against the velocity of x. It is orthogonal to the least-squares circle, so
/// that G is the range of F, w. It is a step, not a peak. Both directions differ by up to w.
#[test]
fn lost_motion_is_a_step_without_peaks() {
    let lost = |angle: f64, sense: f64| 4.0 * (sense * angle.sin()).signum() * angle.cos();
    let error = circle([0.0; 2], 1.0, 0.0, lost).contour_error().unwrap();
    let circle = &error.circles[0];
    for lap in &circle.laps {
        // The sector at the step may contain samples of both sides, the next one is 0.25° from it.
        assert_near(lap.circular_um, 8.0, 0.01);
        assert_near(lap.radial_um[1], 4.0, 0.01);
        // The levels 6 to 10° away are 1 % below the step's ends: 4·(1 − cos 8°).
        assert!(lap.spikes_um.iter().all(|um| um.abs() < 0.05), "{:?}", lap.spikes_um);
    }
    assert_near(circle.hysteresis_um.unwrap(), 8.0, 0.02);
    // √(mean of 16·cos²) = 4/√2; the standstills, 1.5 % of the samples, are at 4·cos(1 rad) = 2.16.
    assert_near(error.rms_um, 4.0 / f64::sqrt(2.0), 0.02);
}

/// A peak of 5 µm, exp(−u²) with u in degrees, 1° after each reversal.
#[test]
fn peaks_at_the_reversals_are_found_with_their_sign() {
    for sign in [1.0, -1.0] {
        let peak = |angle: f64, sense: f64| {
            let from_reversal =
                (angle + TAU / 8.0).rem_euclid(TAU / 4.0) - TAU / 8.0 - sense * 1_f64.to_radians();
            sign * 5.0 * (-(from_reversal.to_degrees() / 1.0).powi(2)).exp()
        };
        let error = circle([0.0; 2], 0.5, 0.0, peak).contour_error().unwrap();
        for lap in &error.circles[0].laps {
            for spike in lap.spikes_um {
                // The mean over a sector that begins or ends at the peak is lower by 0.25²/3 = 2.1 %.
                assert!(sign * spike < 5.0 && sign * spike > 0.978 * 5.0, "{spike}");
            }
        }
    }
}

#[test]
fn a_circle_with_a_missing_part_has_no_circular_deviation() {
    let mut run = circle([0.0; 2], 0.0, 0.0, |_, _| 1.0);
    // The first turn starts with sample 400; 7 % of a turn are 25°.
    let cut = 1100;
    run.command_m.iter_mut().chain(&mut run.measured_m).for_each(|axis| drop(axis.drain(..cut)));
    let error = run.contour_error().unwrap();
    let directions: Vec<bool> = error.circles[0].laps.iter().map(|lap| lap.is_clockwise).collect();
    assert_eq!(directions, [true], "the first turn is not full");
    assert_eq!(error.circles[0].bidirectional_um, None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// The figures do not depend on where the circle lies and where it starts.
    #[test]
    fn figures_are_invariant_to_translation_and_start(
        x in -0.3..0.3, y in -0.3..0.3, start in 0.0..TAU,
    ) {
        let deviation =
            |angle: f64, sense: f64| 2.0 * (2.0 * angle).sin() + sense * (3.0 * angle).cos();
        let reference = circle([0.0; 2], 0.0, 0.001, deviation).contour_error().unwrap();
        let moved = circle([x, y], start, 0.001, deviation).contour_error().unwrap();
        prop_assert_eq!(moved.circles.len(), 1);
        prop_assert!((moved.max_um - reference.max_um).abs() < WITHIN_UM);
        let of = |error: &ContourError| -> Vec<f64> {
            let circle = &error.circles[0];
            let laps = circle.laps.iter().flat_map(|lap| [lap.circular_um, lap.radial_um[0], lap.radial_um[1]]);
            laps.chain([circle.bidirectional_um.unwrap(), circle.hysteresis_um.unwrap()]).collect()
        };
        for (a, b) in of(&moved).into_iter().zip(of(&reference)) {
            // Samples lie elsewhere within the sectors: 3·2 µm/rad over 0.125° is 0.013 µm.
            prop_assert!((a - b).abs() < 0.015, "{} {}", a, b);
        }
    }
}
