//! The parts that are there are found, with intervals that contain the truth in about 95 % of the cases.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::generator::{Axis, covered, effect, normal, signed, without_line};

/// An axis with parts of random size, each there in half of the cases.
fn random_axis(random: &mut ChaCha8Rng) -> Axis {
    let mut axis = Axis::quiet(random.random_range(0.3..1.0));
    axis.offset_um = signed(random, 2.0, 20.0);
    if random.random::<bool>() {
        axis.slope_um_per_m = signed(random, 20.0, 100.0);
    }
    if random.random::<bool>() {
        axis.gap_um = random.random_range(3.0..20.0);
    }
    if random.random::<bool>() {
        axis.curve_um = (0..axis.targets_mm.len()).map(|_| 5.0 * normal(random)).collect();
    }
    if axis.gap_um > 0.0 && random.random::<bool>() {
        let curve: Vec<f64> = (0..axis.targets_mm.len()).map(|_| 2.0 * normal(random)).collect();
        let mean = curve.iter().sum::<f64>() / curve.len() as f64;
        axis.gap_curve_um = curve.iter().map(|um| um - mean).collect();
    }
    axis
}

#[test]
fn parts_are_found_and_their_intervals_contain_the_truth() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut hits, mut intervals, mut missed, mut false_names) = (0, 0, Vec::new(), Vec::new());
    for seed in 0..100 {
        let axis = random_axis(&mut random);
        let analysis = axis.analysed(seed, false);
        let has_curve = axis.curve_um.iter().any(|um| *um != 0.0);
        let differs = axis.gap_curve_um.iter().any(|um| *um != 0.0);
        let x = &axis.targets_mm;
        let line: Vec<f64> =
            x.iter().zip(&axis.curve_um).map(|(x, um)| 1e-3 * axis.slope_um_per_m * x + um).collect();
        let mean = axis.offset_um + line.iter().sum::<f64>() / line.len() as f64;
        let bent = without_line(x, &axis.curve_um);
        let straight: Vec<f64> = line.iter().zip(&bent).map(|(line, bent)| line - bent).collect();
        let slope = 1e3 * (straight[10] - straight[0]) / (x[10] - x[0]);
        let edge = |sign: f64| -> Vec<f64> {
            bent.iter().zip(&axis.gap_curve_um).map(|(um, gap)| um - 0.5 * sign * gap).collect()
        };
        let mut expected = vec![("offset", "um", vec![mean])];
        if slope != 0.0 {
            expected.push(("pitch_progressive", "slope_um_per_m", vec![slope]));
        }
        if axis.gap_um > 0.0 {
            expected.push(("backlash", "width_um", vec![axis.gap_um]));
        }
        if has_curve || differs {
            expected.push(("pitch_map", "error_um", edge(1.0)));
        }
        for (name, key, truth) in &expected {
            match effect(&analysis, name) {
                Some(found) => {
                    let (hit, count) = covered(found, key, truth);
                    hits += hit;
                    intervals += count;
                }
                // A slope that the curve makes by chance may be small.
                None if *name == "pitch_progressive" || truth[0].abs() < 0.3 => {}
                None => missed.push((seed, *name)),
            }
        }
        let names = analysis.effects.iter().map(|effect| effect.name);
        false_names.extend(names.filter(|name| expected.iter().all(|(other, ..)| other != name)));
        if let Some(map) = effect(&analysis, "pitch_map") {
            assert_eq!(map.parameters.contains_key("error_negative_um"), differs, "{seed}");
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
    assert!(false_names.len() <= 3, "{false_names:?}");
    let share = hits as f64 / intervals as f64;
    assert!(intervals > 500 && (0.93..0.985).contains(&share), "{hits} of {intervals}");
}

/// 120 µm rms before, the scatter of 0.5 µm after.
#[test]
fn the_residual_is_the_scatter() {
    let mut axis = Axis::quiet(0.5);
    axis.slope_um_per_m = 400.0;
    axis.gap_um = 12.0;
    let analysis = axis.analysed(1, false);
    let after = analysis.residual.after.fit;
    assert!(analysis.residual.before.fit > 100.0 && (after - 0.5).abs() < 0.1, "{after}");
    assert!((analysis.residual.left_out.unwrap() - 0.5).abs() < 0.1);
}
