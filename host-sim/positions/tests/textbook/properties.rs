//! Guarantees of the figures and of the reader, for any readings.

use proptest::prelude::*;

use positions::columns::Request;
use positions::iso::{Figures, figures, positions};
use positions::measured::{Reading, Test, Way};
use positions::readings;

/// A test with five approaches to each of three to eight targets in both directions.
fn any_test() -> impl Strategy<Value = Test> {
    (3_usize..9).prop_flat_map(|targets| {
        prop::collection::vec(-50.0..50.0_f64, targets * 10).prop_map(move |deviations| {
            let reading = |(index, deviation_um): (usize, f64)| Reading {
                run: index / (2 * targets),
                way: Way::BOTH[index / targets % 2],
                target_mm: 10.0 * (index % targets) as f64,
                deviation_um,
                time_s: None,
                line: index + 2,
            };
            let readings = deviations.into_iter().enumerate().map(reading).collect();
            Test {
                source: "x.csv".to_owned(),
                readings,
                run_numbers: vec![1.0, 2.0, 3.0, 4.0, 5.0],
                notes: Vec::new(),
            }
        })
    })
}

fn of(test: &Test) -> Figures {
    figures(&positions(test)).0
}

fn all(f: &Figures) -> Vec<f64> {
    let both = [f.accuracy, f.systematic, f.mean_range, f.repeatability, f.reversal];
    let ways = [f.accuracy_positive, f.accuracy_negative, f.systematic_positive, f.systematic_negative];
    let rest = [f.repeatability_positive, f.repeatability_negative];
    both.into_iter().chain(ways).chain(rest).map(Option::unwrap).collect()
}

fn mapped(test: &Test, map: impl Fn(f64) -> f64) -> Test {
    let readings =
        test.readings.iter().map(|at| Reading { deviation_um: map(at.deviation_um), ..*at }).collect();
    Test { readings, ..test.clone() }
}

fn near(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9 * (1.0 + b.abs()))
}

proptest! {
    /// The figures contain each other as the definitions say, whatever the zero of the laser is; they grow with the deviations.
    #[test]
    fn figures_contain_each_other(test in any_test(), zero in -100.0..100.0_f64) {
        let f = of(&test);
        let [a, e, m, r, b] = [f.accuracy, f.systematic, f.mean_range, f.repeatability, f.reversal].map(Option::unwrap);
        prop_assert!(a >= e && e >= m - 1e-9 && r >= b && f.mean_reversal.unwrap().abs() <= b + 1e-9);
        prop_assert!(a >= f.accuracy_positive.unwrap() && a >= f.accuracy_negative.unwrap());
        prop_assert!(r >= f.repeatability_positive.unwrap().max(f.repeatability_negative.unwrap()) - 1e-9);
        prop_assert!(near(&all(&of(&mapped(&test, |um| um + zero))), &all(&f)));
        let doubled: Vec<f64> = all(&f).iter().map(|um| 2.0 * um).collect();
        prop_assert!(near(&all(&of(&mapped(&test, |um| -2.0 * um))), &doubled));
    }

    /// The order of the lines does not matter for the figures.
    #[test]
    fn the_order_of_the_readings_does_not_matter(test in any_test(), seed in 1_usize..97) {
        let mut moved = test.clone();
        let count = moved.readings.len();
        moved.readings.rotate_left(seed % count);
        moved.readings.reverse();
        prop_assert!(near(&all(&of(&moved)), &all(&of(&test))));
    }

    /// Any text is a test or one line of an error.
    #[test]
    fn no_text_causes_a_panic(text in "(run[,;]approach[,;]target_mm[,;]measured_mm\n)?([-0-9.,;\t +\u{2212}]{0,20}\n){0,12}") {
        let outcome = readings::of_text(&text, "a.txt", &Request::default(), Vec::new());
        if let Err(error) = &outcome {
            prop_assert_eq!(error.to_string().lines().count(), 1);
        }
        if let Ok(test) = outcome {
            let _ = positions::analyse(test, Vec::new(), &super::generator::options());
        }
    }
}
