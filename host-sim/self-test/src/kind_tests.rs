//! What the kinds of cases contain.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::case::Case;
use super::draw;
use super::effect_draw::draw_beside;
use super::fault;
use super::kind::Kind;
use super::truth::{CONTROLLER, NAMES, Truth};
use files::log::{AxisLog, Log, Unit};

/// Effects of the catalogue of 200 machines of a kind without extras.
fn effects(kind: Kind) -> Vec<Vec<Truth>> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut one =
        |_| draw_beside(&[], kind, &mut draw::machine(&draw::WITHIN_TOLERANCE, &mut random), &mut random);
    (0..200).map(&mut one).collect()
}

/// The values are those that the program gave before it had kinds.
#[test]
fn textbook_cases_are_what_they_have_always_been() {
    let case = Case::draw(7, 4).unwrap();
    assert!(case.machine_text.contains("position_gain_per_s = 59.5392\n"), "{}", case.machine_text);
    assert_eq!(
        case.truths.iter().map(|truth| truth.name).collect::<Vec<_>>(),
        ["friction_asymmetry", "local_defect"]
    );
    let half = case.truths[0].parameter("half_difference_n_s_per_m").unwrap();
    assert_eq!(half.to_bits(), (-228.134_888_148_803_04_f64).to_bits());
    let steps = case.fit.iter().find(|log| log.source == "fit_steps").unwrap();
    let x = &steps.axes[0];
    let row =
        [&x.command, &x.motor, &x.table, &x.tool, &x.force].map(|channel| channel.as_ref().unwrap()[2999]);
    let expected = [0.0, -0.00802, -0.00882, -0.00893, 252.4_f64];
    assert_eq!(row.map(f64::to_bits), expected.map(f64::to_bits), "{row:?}");
}

#[test]
fn many_are_four_or_five_and_small_ones_are_log_uniform_down_to_a_thirtieth() {
    let counts: std::collections::BTreeSet<usize> = effects(Kind::Many).iter().map(Vec::len).collect();
    assert_eq!(counts, [4, 5].into());
    let widths: Vec<f64> = effects(Kind::Small)
        .iter()
        .flatten()
        .filter(|truth| truth.name == "pitch_progressive")
        .map(|truth| truth.parameters[0].1.abs())
        .collect();
    // Textbook slopes are 20 to 100 µm/m.
    assert!(widths.iter().all(|slope| (20.0 / 30.0..100.0).contains(slope)), "{widths:?}");
    // Slope and strength are independent: ln(slope) has the mean (100·ln 100 − 20·ln 20)/80 − 1 − ln(30)/2 = 2.31 and
    // the standard deviation √(0.44² + (ln(30)²/12)) = 1.08; the tolerance is four standard deviations of the mean.
    let mean = numerics::mean(widths.iter().map(|width| width.ln()));
    assert!((mean - 2.31).abs() < 4.0 * 1.08 / (widths.len() as f64).sqrt(), "{mean} of {}", widths.len());
}

#[test]
fn small_wind_up_stays_beyond_the_tolerance_and_declared_values_beyond_it_are_no_wind_up() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    let mut seen = 0;
    for _ in 0..300 {
        let mut machine = draw::machine(&draw::WITHIN_TOLERANCE, &mut random);
        let declared = machine.declared.clone();
        for truth in draw_beside(&[], Kind::Small, &mut machine, &mut random) {
            if truth.name == "windup" {
                let index = usize::from(truth.axis == "y");
                seen += 1;
                // The tolerance of the file is 10 %, textbook wind-up is at least 0.45 of the declared stiffness.
                let ratio = truth.parameters[0].1 / declared[index].stiffness_n_per_um;
                assert!((0.45..=0.75 + 1e-12).contains(&ratio), "{ratio}");
                let true_stiffness = machine.axes[index].mechanics.stiffness_n_per_m;
                assert!((1e-6 * true_stiffness / truth.parameters[0].1 - 1.0).abs() < 1e-12);
            }
        }
    }
    assert!(seen > 10, "{seen}");
    assert!(effects(Kind::Offspec).iter().flatten().all(|truth| truth.name != "windup"));
}

#[test]
fn declared_values_scatter_as_the_kind_says() {
    let ratios = |deviations: &draw::Deviations| -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut one = |_| {
            let machine = draw::machine(deviations, &mut random);
            1e-6 * machine.axes[0].mechanics.stiffness_n_per_m / machine.declared[0].stiffness_n_per_um
        };
        (0..200).map(&mut one).collect()
    };
    let beyond = |ratios: &[f64]| ratios.iter().filter(|ratio| (*ratio - 1.0).abs() > 0.1).count();
    let within = ratios(&draw::WITHIN_TOLERANCE);
    assert!(beyond(&within) == 0 && within.iter().any(|ratio| (ratio - 1.0).abs() > 0.05));
    // Uniform in ±25 %: 60 % lie beyond 10 %; four standard deviations of 200 draws are 14 %.
    let outside = ratios(&draw::BEYOND_TOLERANCE);
    assert!((92..=148).contains(&beyond(&outside)), "{}", beyond(&outside));
    assert!(outside.iter().all(|ratio| (1.0 / 1.25..1.0 / 0.75).contains(ratio)));
}

#[test]
fn a_controller_case_has_an_effect_of_the_controller_and_no_extra() {
    let mut names = std::collections::BTreeSet::new();
    for number in 1..=12 {
        let case = Case::draw_kind(Kind::Controller, 4, number).unwrap();
        assert!(case.extras.is_empty());
        names.insert(case.truths[0].name);
        assert!(CONTROLLER.contains(&case.truths[0].name));
        assert!(case.truths[1..].iter().all(|truth| NAMES.contains(&truth.name)));
    }
    assert!(names.len() > 2, "{names:?}");
}

/// A log of 4 s in which the scale of x moves at 50 mm/s and the probe reads the same.
fn ramp() -> Log {
    let positions: Vec<f64> = (0..4000).map(|i| 0.05 * f64::from(i)).collect();
    let axis = |name: &str| AxisLog {
        table: Some(positions.clone()),
        tool: Some(positions.clone()),
        ..AxisLog::new(name, Unit::Millimetre)
    };
    Log::new("fit_steps", 40.0, 1e-3, [axis("x"), axis("y")])
}

#[test]
fn faults_are_in_the_log_where_and_as_large_as_the_truth_says() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..60 {
        let mut logs = [ramp()];
        let truth = fault::draw(&mut logs, &mut random).unwrap();
        seen.insert(truth.name);
        let [log] = logs;
        let [faulty, clean] = [&log, &ramp()].map(|log| log.axis(truth.axis).unwrap().clone());
        let [table, was] = [faulty.table.unwrap(), clean.table.unwrap()];
        if truth.name == "probe_sign" {
            assert!(faulty.tool.unwrap().iter().zip(&was).all(|(now, was)| (now + was).abs() < 1e-12));
            assert_eq!(table, was);
            continue;
        }
        assert_eq!(truth.reference, Some(("log", "fit_steps")));
        let at_s = truth.parameter("at_s").unwrap();
        let changed: Vec<usize> = (0..table.len()).filter(|&i| (table[i] - was[i]).abs() > 1e-9).collect();
        let first_s = 40.0 + 1e-3 * changed[0] as f64;
        if truth.name == "scale_slip" {
            assert!((first_s - at_s).abs() < 1e-9, "{truth:?}");
            assert_eq!(changed.len(), table.len() - changed[0]);
            let size_um = truth.parameter("size_um").unwrap();
            assert!((4.99..1000.01).contains(&size_um.abs()), "{size_um}");
            assert!(changed.iter().all(|&i| (1e3 * (table[i] - was[i]) - size_um).abs() < 1e-6));
        } else {
            // The first sample that is held has its own value.
            let duration_s = truth.parameter("duration_s").unwrap();
            assert!((first_s - at_s - 1e-3).abs() < 1e-9, "{truth:?}");
            assert!((1e-3 * (changed.len() + 1) as f64 - duration_s).abs() < 1e-9, "{truth:?}");
            assert!((0.05..=1.0).contains(&duration_s));
            assert!(changed.iter().all(|&i| table[i].to_bits() == table[changed[0]].to_bits()));
        }
    }
    assert_eq!(seen, fault::NAMES.into());
}
