//! Lines and corners with known errors.

use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};

use proptest::prelude::*;

use super::{SAMPLE_S, assert_near, motion};
use crate::evaluation::Evaluation;
use crate::path::NominalPath;
use motion::{PathBlock, PathShape};

/// Points along lines between corners, 20 µm apart.
fn along(corners: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const STEP_M: f64 = 2e-5;
    let line = |ends: &[[f64; 2]]| {
        let [from, to] = [ends[0], ends[1]];
        let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) / STEP_M).round();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "thousands of steps")]
        let count = steps as u32;
        let at = move |k: f64| [0, 1].map(|i| from[i] + (to[i] - from[i]) * k / steps);
        (1..=count).map(move |k| at(f64::from(k))).collect::<Vec<_>>()
    };
    std::iter::once(corners[0]).chain(corners.windows(2).flat_map(line)).collect()
}

fn line(to_m: &[f64]) -> PathBlock {
    PathBlock::new(PathShape::Line { to_m: to_m.to_vec() }, 0.02, 1.0)
}

/// Nearest points beyond the ends of the path are its ends: the offset is across the line, the distance is the same there.
#[test]
fn a_constant_offset_from_a_line_is_its_distance_with_the_sign_of_the_side() {
    let offset_m = [-3e-6, 4e-6]; // 5 µm to the left of the direction (4, 3)/5
    let forward = along(&[[0.0, 0.0], [0.04, 0.03]]);
    let backward: Vec<[f64; 2]> = forward.iter().rev().copied().collect();
    for (points, sign) in [(forward, 1.0), (backward, -1.0)] {
        let run = motion(&points.iter().map(|point| (*point, offset_m)).collect::<Vec<_>>());
        let error = run.contour_error().unwrap();
        assert_near(error.max_um, 5.0, 1e-6);
        assert_near(error.rms_um, 5.0, 1e-6);
        assert!(error.noise_um < 1e-6 && error.corners.is_empty() && error.circles.is_empty());
        let path = NominalPath::of_command(&run.command_m, SAMPLE_S);
        let mut evaluation = Evaluation::new(&path, SAMPLE_S);
        let last = points
            .iter()
            .fold(None, |_, [x, y]| evaluation.add(&[*x, *y, 0.0], &[x + offset_m[0], y + offset_m[1], 0.0]));
        assert_near(last.unwrap(), sign * 5e-6, 1e-12);
    }
}

/// In space the distance has no sign: √(3² + 4²) = 5 µm across the line in x.
#[test]
fn the_distance_in_space_is_that_across_the_path() {
    let path = NominalPath::of_blocks(&[0.0; 3], &[line(&[0.05, 0.0, 0.0])]);
    let mut evaluation = Evaluation::new(&path, SAMPLE_S);
    for i in 0..2000 {
        let x = 2e-5 * f64::from(i);
        evaluation.add(&[x, 0.0, 0.0], &[x - 1e-3 * (x / 0.04), 3e-6, -4e-6]);
    }
    let error = evaluation.finish().unwrap();
    // 3 and 4 µm across; the lag of up to 1 mm is along the line.
    assert_near(error.max_um, 5.0, 1e-6);
    assert_near(error.rms_um, 5.0, 1e-6);
}

/// One axis has no direction across its path: the error is tool minus command, here 4 µm of lag.
#[test]
fn the_error_of_one_axis_is_along_it() {
    let path = NominalPath::of_blocks(&[0.0], &[line(&[0.05])]);
    let mut evaluation = Evaluation::new(&path, SAMPLE_S);
    let errors: Vec<Option<f64>> = (0..2000)
        .map(|i| {
            let x = 2e-5 * f64::from(i);
            evaluation.add(&[x, 0.0, 0.0], &[x - 4e-6, 0.0, 0.0])
        })
        .collect();
    assert!(errors[..300].iter().all(Option::is_none), "0.3 s are left out");
    assert_near(errors[1999].unwrap(), -4e-6, 1e-12);
    let error = evaluation.finish().unwrap();
    assert!(error.is_along_axis);
    assert_eq!(error.samples, 1700);
    assert_near(error.rms_um, 4.0, 1e-6);
}

/// A tool on a fillet of radius ρ in a square corner is at most ρ·(1 − 1/√2) from the path, and ρ·(√2 − 1) from the corner.
/// It does not overshoot.
#[test]
fn a_fillet_has_its_closed_forms() {
    const RHO_M: f64 = 1e-3;
    let corner = [0.03, 0.0];
    let command = along(&[[0.0, 0.0], corner, [0.03, 0.03]]);
    // The tool is on the fillet while the command is within ρ of the corner along both lines.
    let points: Vec<_> = command
        .iter()
        .map(|&[x, y]| {
            let progress = if y > 0.0 { y } else { x - corner[0] };
            let angle = (progress / RHO_M).clamp(-1.0, 1.0) * PI / 4.0 - PI / 4.0;
            let fillet = [corner[0] - RHO_M + RHO_M * angle.cos(), RHO_M + RHO_M * angle.sin()];
            let tool = if progress.abs() < RHO_M { fillet } else { [x, y] };
            ([x, y], [tool[0] - x, tool[1] - y])
        })
        .collect();
    let error = motion(&points).contour_error().unwrap();
    let [found] = &error.corners[..] else { panic!("{} corners", error.corners.len()) };
    assert_near(found.turn_rad, PI / 2.0, 1e-6);
    assert_near(found.point[0], corner[0], 1e-9);
    // The samples of the tool are 16 µm apart: at most 8 µm from the middle of the fillet, (8 µm)²/2ρ = 0.03 µm.
    assert_near(found.rounding_um, 1e3 * (SQRT_2 - 1.0), 0.1);
    // At the middle the distance from each of the two lines changes by 1/√2 of the way: 8 µm/√2.
    assert!(error.max_um <= 1e3 * (1.0 - FRAC_1_SQRT_2) + 1e-3, "{}", error.max_um);
    assert!(error.max_um >= 1e3 * (1.0 - FRAC_1_SQRT_2) - 6.0, "{}", error.max_um);
    assert!(found.overshoot_um < 1e-6, "{}", found.overshoot_um);
}

/// The tool runs 30 µm beyond a corner along the first line and comes back over 5 mm, to a steady 4 µm (on the outer side).
#[test]
fn the_overshoot_is_relative_to_the_steady_error() {
    for turn in [PI / 4.0, PI / 2.0, -PI / 2.0, 0.75 * PI] {
        let corner = [0.03, 0.0];
        let (sin, cos) = turn.sin_cos();
        let end = [corner[0] + 0.03 * cos, 0.03 * sin];
        // Unit vector across the second line, outwards.
        let outward = [sin.abs(), -turn.signum() * cos];
        let points: Vec<_> = along(&[[0.0, 0.0], corner, end])
            .into_iter()
            .map(|[x, y]| {
                let after_m = (x - corner[0]).hypot(y);
                let is_after = y != 0.0;
                let beyond = 4e-6 + 26e-6 * (1.0 - after_m / 5e-3).max(0.0);
                let tool = if is_after { outward.map(|o| beyond * o) } else { [0.0; 2] };
                ([x, y], tool)
            })
            .collect();
        let error = motion(&points).contour_error().unwrap();
        let [found] = &error.corners[..] else { panic!("{turn}: {} corners", error.corners.len()) };
        assert_near(found.turn_rad, turn.abs(), 1e-6);
        // 26 µm; the first sample after the corner is 20 of 5000 µm further: 0.4 % of 26 µm less.
        assert_near(found.overshoot_um, 26.0, 0.15);
        assert_near(error.max_um, 30.0, 0.15);
    }
}

/// There and back: the tool runs 7 µm beyond the reversal.
#[test]
fn the_overshoot_of_a_reversal_is_beyond_its_end() {
    let command = along(&[[0.0, 0.0], [0.02, 0.01], [0.0, 0.0]]);
    let direction = [2.0 / f64::sqrt(5.0), 1.0 / f64::sqrt(5.0)];
    let points: Vec<_> = command
        .iter()
        .enumerate()
        .map(|(i, point)| {
            let to_end = (point[0] - 0.02).hypot(point[1] - 0.01);
            let is_there = to_end < 1e-9 || (i > command.len() / 2 && to_end < 1e-4);
            let beyond = if is_there { to_end + 7e-6 } else { 0.0 };
            (*point, direction.map(|d| beyond * d))
        })
        .collect();
    let error = motion(&points).contour_error().unwrap();
    let [found] = &error.corners[..] else { panic!("{} corners", error.corners.len()) };
    assert_near(found.turn_rad, PI, 1e-6);
    assert_near(found.overshoot_um, 7.0, 1e-3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// White noise across a line: its deviation is that of the noise and of the error.
    #[test]
    fn the_noise_is_found(seed in 0..1000_u64, sigma_um in 0.01..5.0_f64) {
        use rand::SeedableRng;
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let points: Vec<_> = along(&[[0.0, 0.0], [0.1, 0.0]])
            .into_iter()
            .map(|point| (point, [0.0, 1e-6 * sigma_um * numerics::noise::box_muller(&mut random)]))
            .collect();
        let error = motion(&points).contour_error().unwrap();
        // 5000 samples; third differences are correlated: their variance has a relative standard error of about
        // √(2·(1 + 2·(15² + 6² + 1)/20²)/5000) = 0.03, the deviation half of it. Four times that. The 100 samples at standstill have
        // one error, whose differences are zero: 0.98 of the variance is left.
        prop_assert!((error.noise_um / (0.98_f64.sqrt() * sigma_um) - 1.0).abs() < 0.06, "{} of {}", error.noise_um, sigma_um);
        // √(1/(2·5000)) = 0.01: five times that. The 100 samples at standstill have one error, 0 to 4.2 deviations: the mean square
        // is 0.98 to 0.98 + 0.02·4.2² = 1.33 of the noise's.
        let ratio = error.rms_um / sigma_um;
        prop_assert!((0.94..1.21).contains(&ratio), "{} of {}", error.rms_um, sigma_um);
    }
}

/// Jumps of 10 µm every 50 samples are in four of 50 differences, whose magnitudes of 10 and 30 µm are more than five of their
/// deviations of √20·0.1 µm: they are left out. The rest has the standard error of 0.015·0.1 µm; three times that.
#[test]
fn jumps_of_the_error_are_not_noise() {
    use rand::SeedableRng;
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let points: Vec<_> = along(&[[0.0, 0.0], [0.1, 0.0]])
        .into_iter()
        .enumerate()
        .map(|(i, point)| {
            let jump = if (i / 50) % 2 == 0 { 10e-6 } else { 0.0 };
            (point, [0.0, jump + 0.1e-6 * numerics::noise::box_muller(&mut random)])
        })
        .collect();
    let error = motion(&points).contour_error().unwrap();
    assert_near(error.noise_um, 0.1, 0.0045);
}

/// A displacement (3, −2) µm of the tool on a circle: across the path it has the mean square (3² + 2²)/2 = 6.5 µm², as the direction
/// of travel turns evenly. Along x alone, only the −2 µm in y is known, and all of it counts.
#[test]
fn a_constant_displacement_of_the_tool_is_found_where_the_path_shows_it() {
    let circle: Vec<[f64; 2]> = (0..=8000)
        .map(|i| (std::f64::consts::TAU * f64::from(i) / 8000.0).sin_cos())
        .map(|(sin, cos)| [0.03 * cos, 0.03 * sin])
        .collect();
    let line = along(&[[0.0, 0.0], [0.1, 0.0]]);
    for (points, found_um, square_um2) in [(circle, [3.0, -2.0, 0.0], 6.5), (line, [0.0, -2.0, 0.0], 4.0)] {
        let error = motion(&points.into_iter().map(|point| (point, [3e-6, -2e-6])).collect::<Vec<_>>())
            .contour_error();
        let error = error.unwrap();
        // The first 0.3 s of the motion do not count: of the circle, the other directions are found all the same.
        for (found, expected) in error.across.displacement_um().into_iter().zip(found_um) {
            assert_near(found, expected, 0.03);
        }
        // The standstill of 100 samples at one end counts in one direction only: a hundredth.
        assert_near(error.rms_um.powi(2), square_um2, 0.02 * square_um2 + 0.1);
        // Displaced by as much again: four times the mean square, three times that are added.
        let added_um2 = error.across.added_um2(found_um, found_um);
        assert_near(added_um2, 3.0 * error.rms_um.powi(2), 0.02 * added_um2);
    }
}
