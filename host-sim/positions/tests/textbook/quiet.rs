//! Nothing is found where nothing is.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use positions::columns::Request;
use positions::iso::{figures, positions};
use positions::measured::Test;
use positions::readings;

use super::generator::{Axis, normal};

/// Of 200 axes with noise alone, the effects found: five of a hundred are allowed for the offset, whose interval of 95 % may miss zero.
#[test]
fn noise_alone_has_no_effects() {
    let mut names: Vec<&str> = Vec::new();
    for seed in 0..200 {
        let runs = if seed % 4 < 2 { 3 } else { 5 };
        let analysis = Axis { runs, ..Axis::quiet(1.0) }.analysed(seed, seed % 2 == 0);
        names.extend(analysis.effects.iter().map(|effect| effect.name));
        assert!((analysis.scatter_um.unwrap() - 1.0).abs() < 0.3, "{seed}");
    }
    let offsets = names.iter().filter(|name| **name == "offset").count();
    assert!(offsets <= 20, "{offsets}");
    assert!(names.len() - offsets <= 2, "{names:?}");
}

/// Runs that differ by a random offset each, twice the noise, do not drift.
#[test]
fn runs_that_differ_by_chance_do_not_drift() {
    let mut drifts = 0;
    for seed in 0..100 {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let axis = Axis::quiet(1.0);
        let mut lines: Vec<String> = axis.table(seed, false).lines().map(str::to_owned).collect();
        let offsets: Vec<f64> = (0..axis.runs).map(|_| 2e-3 * normal(&mut random)).collect();
        for line in lines.iter_mut().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let offset = offsets[cells[0].parse::<usize>().unwrap() - 1];
            let measured: f64 = cells[3].parse().unwrap();
            *line = format!("{},{},{},{}", cells[0], cells[1], cells[2], measured + offset);
        }
        let request = Request::default();
        let test = readings::of_text(&lines.join("\n"), "x.csv", &request, Vec::new()).unwrap();
        let analysis = positions::analyse(test, Vec::new(), &super::generator::options()).unwrap();
        let has_drift = analysis
            .effects
            .iter()
            .any(|effect| effect.name.contains("drift") || effect.name.contains("growth"));
        if has_drift {
            drifts += 1;
            continue;
        }
        let offset = super::generator::effect(&analysis, "offset");
        // The interval of the offset is that of five runs, not of 110 readings: mostly ± 2.5 µm.
        let [low, high] = offset.map_or([-2.0, 2.0], |offset| match &offset.parameters["um"] {
            positions::effect::Parameter::Number { ci95, .. } => ci95.unwrap(),
            _ => panic!(),
        });
        assert!(high - low > 0.4, "{seed}: {low} {high}");
    }
    // A trend by chance in one of twenty.
    assert!(drifts <= 10, "{drifts}");
}

/// A deviation of a metre is no deviation: it is left out and told, and the figures are those without it.
#[test]
fn a_deviation_beyond_the_targets_is_left_out() {
    let mut lines = vec!["run,approach,target_mm,deviation_um".to_owned()];
    for run in 1..=3 {
        for (sign, mark) in [(1.0, '+'), (-1.0, '-')] {
            lines.extend((0..11).map(|target| format!("{run},{mark},{},{}", 10 * target, 3.0 * sign)));
        }
    }
    let sound = lines.join("\n");
    lines[5] = "1,+,40,1000000".to_owned();
    let of = |text: &str| readings::of_text(text, "x.csv", &Request::default(), Vec::new()).unwrap();
    let (sound, broken) = (of(&sound), of(&lines.join("\n")));
    assert_eq!(broken.readings.len(), sound.readings.len() - 1);
    let note = "x.csv: line 6: deviation_um: 1000.0000 mm from its target, left out.";
    assert!(broken.notes.iter().any(|other| other == note), "{:?}", broken.notes);
    let figures = |test: &Test| figures(&positions(test)).0;
    assert_eq!(figures(&broken), figures(&sound));
}
