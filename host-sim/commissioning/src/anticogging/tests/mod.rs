//! What is learned from simulated passes, compared with the machine that was simulated.

mod recordings;
mod rig;

use nalgebra::Complex;

use super::learned::Learned;
use super::passes;
use super::plan::{Plan, PlanError, Wanted};
use super::table;
use super::text;
use super::{AnticoggingFile, Declared};
use crate::compensate::CompensationFile;
use model::machine::Machine;
use rig::{DECLARED, FORCE_STEP_N, Rig, SAMPLE_S, wanted};

/// 6 N with four periods per turn, 2 N with eight, 1 N with three.
const WAVES: [[f64; 3]; 3] = [[1.25, 6.0, 0.7], [0.625, 2.0, -1.9], [5.0 / 3.0, 1.0, 2.5]];

/// Every wave is found within four of its standard errors in both parts, a probability of 2·10⁻⁴ at most for each, and half a percent of the
/// friction and the viscous part that the estimator does not have. The error is small: a noise of σ = 0.5 N with the time constant τ = 20 ms
/// has the spectral density 2σ²τ, of which a wave takes 4σ²τ/T from the time T of 4 passes of 5 s: 0.03 N. Held out: the waves are
/// √(½(6² + 2² + 1²)) = 4.53 N rms, and what is left is the noise.
#[test]
fn the_waves_of_a_machine_with_friction_load_and_noise_are_found() {
    let (plan, learned) = Rig::with_waves(&WAVES, 7).learned();
    let found: Vec<_> = learned.found().collect();
    assert_eq!(found.iter().map(|wave| wave.candidate.order).collect::<Vec<_>>(), [3, 4, 8]);
    for [period_mm, amplitude_n, phase_rad] in WAVES {
        let wave = found.iter().find(|wave| (wave.candidate.period_mm - period_mm).abs() < 1e-9).unwrap();
        let off = wave.wave_n - Complex::from_polar(amplitude_n, phase_rad);
        let error_n = wave.standard_error_n;
        println!("{period_mm} mm: {:.4} N, off by {:.4} N, ± {error_n:.4} N", wave.wave_n.norm(), off.norm());
        assert!((0.004..0.12).contains(&error_n), "{period_mm} mm: {error_n} N");
        assert!(off.norm() < 4.0 * error_n + 0.005 * amplitude_n, "{period_mm} mm: {off} N");
    }
    assert!((learned.summary.before_n / 4.53 - 1.0).abs() < 0.05, "{}", learned.summary.before_n);
    assert!((0.02..0.5).contains(&learned.summary.after_n), "{}", learned.summary.after_n);
    // 12 N in the middle, at 0, and 60 N/m over 20 mm.
    assert!((learned.summary.load_n - 12.0).abs() < 0.15, "{}", learned.summary.load_n);
    assert!((learned.summary.load_change_n / (60.0 * 1e-3 * plan.grid.length_mm()) - 1.0).abs() < 0.25);
    // Coulomb friction, and the rise towards standstill at the speed.
    let friction_n = 20.0 + 6.0 * (-(plan.speed_mm_per_s / 3.0).powi(2)).exp();
    assert!(
        (learned.summary.friction_n - friction_n).abs() < 0.3,
        "{} {friction_n}",
        learned.summary.friction_n
    );
}

/// Of 20 machines without cogging, each with other noise, eight waves each, one alarm would have a probability of 20·1 % before the other
/// passes are asked, which confirm one in 20: 1 % for one at all. What they could have is told: more than the resolution, less than 1 N.
#[test]
fn machines_without_cogging_give_no_table() {
    for seed in 1..=20 {
        let (plan, learned) = Rig::quiet(seed).learned();
        let limit_n = learned.limit_n();
        assert_eq!(learned.found().count(), 0, "{seed}: {:?}", learned.waves);
        assert!((FORCE_STEP_N..1.0).contains(&limit_n), "{seed}: {limit_n}");
        assert!(table::tables(&learned, &plan.periods_mm).is_empty());
        let text = text::of(&AnticoggingFile::new("board", "x", &plan, &learned));
        assert!(text.starts_with("No cogging above ") && text.contains(" N was found."), "{text}");
    }
}

/// A load that wanders along the travel, the same in each pass, is no cogging: passes alone would confirm each other, the wave numbers beside
/// the waves do not.
#[test]
fn a_load_that_wanders_along_the_travel_is_not_taken_for_cogging() {
    let mut found = 0;
    for seed in 1..=8 {
        let (_, learned) = Rig { rough_n: 4.0, ..Rig::quiet(seed) }.learned();
        // Not a machine that would pass anyway.
        assert!(learned.summary.before_n > 1.0, "{}", learned.summary.before_n);
        found += learned.found().count();
    }
    assert!(found <= 1, "{found} of 64");
}

/// At the greatest speed the shortest wave has ω = 40 rad/s, 0.2 times the crossover. 8 N deflect the loop, of 2.3·10⁵ N/m there, by d = 35 µm:
/// the force for the acceleration, m·ω²·d, is 0.8 N or 10 %, by which the wave would be off with a mass that is declared as almost none. With
/// the mass, terms of the order (k·d)² of it remain, (0.35)² of 10 %.
#[test]
fn the_force_for_the_acceleration_is_no_cogging() {
    let rig = Rig { noise_n: 0.05, ..Rig::with_waves(&[[0.625, 8.0, 1.0]], 3) };
    let plan = Plan::new(&wanted(), &DECLARED).unwrap();
    let pairs = passes::pairs(&rig.run(&plan, 4), &plan, 4, (SAMPLE_S, None)).unwrap();
    let off = |mass_kg: f64| {
        let learned = Learned::of(&pairs, &plan, &Declared { mass_kg, ..DECLARED }, FORCE_STEP_N);
        (learned.waves[7].wave_n - Complex::from_polar(8.0, 1.0)).norm() / 8.0
    };
    let [with, without] = [off(15.0), off(1e-6)];
    println!("{with:.4} {without:.4}");
    assert!(with < 0.02 && (0.07..0.15).contains(&without), "{with} {without}");
}

/// A wave that only every second pair of passes has is not in the table, and the text says why.
#[test]
fn a_wave_that_the_other_passes_do_not_have_is_left_out() {
    let plan = Plan::new(&wanted(), &DECLARED).unwrap();
    let of = |rig: &Rig| passes::pairs(&rig.run(&plan, 4), &plan, 4, (SAMPLE_S, None)).unwrap();
    let [with, without] = [of(&Rig::with_waves(&WAVES, 4)), of(&Rig::quiet(5))];
    let pair =
        |number: usize| if number.is_multiple_of(2) { with[number].clone() } else { without[number].clone() };
    let learned = Learned::of(&(0..4).map(pair).collect::<Vec<_>>(), &plan, &DECLARED, FORCE_STEP_N);
    assert!(learned.waves.iter().any(super::learned::Measured::is_significant));
    assert_eq!(learned.found().count(), 0);
    let text = text::of(&AnticoggingFile::new("board", "x", &plan, &learned));
    assert!(text.contains("The wave of 1.2500 mm") && text.contains("do not confirm it"), "{text}");
}

/// The table of a period holds the sum of its waves, is read back as it was written, and leaves alone what the file had. Orders 4 and 8 are
/// a table of a quarter of the lead, order 3 besides needs one of the whole lead.
#[test]
fn the_table_is_the_sum_of_the_waves() {
    let machine = Machine::parse(include_str!("../../../../machines/bench.toml"), "bench.toml").unwrap();
    for (waves, period_m) in [(&WAVES[..2], 1.25e-3), (&WAVES[..], 5e-3)] {
        let (plan, learned) = Rig::with_waves(waves, 11).learned();
        let tables = table::tables(&learned, &plan.periods_mm);
        assert!(tables.len() == 1 && (tables[0].period_m / period_m - 1.0).abs() < 1e-12);
        for (point, value) in tables[0].values.iter().enumerate() {
            let at_mm = 1e3 * period_m * point as f64 / 64.0;
            let sum: f64 =
                waves.iter().map(|[mm, n, rad]| n * (std::f64::consts::TAU * at_mm / mm + rad).sin()).sum();
            assert!((value - sum).abs() < 0.3, "{point}: {value} {sum}");
        }
        let mut file = CompensationFile::none(&machine);
        table::set(&mut file, ("x", &machine.axis["x"].settings), tables.clone(), ("a board", "ripple"));
        assert!(file.refused(&machine).is_none());
        let text = file.to_toml().unwrap();
        let mut read = CompensationFile::parse(&text, "c.toml", &machine).unwrap();
        assert_eq!(read, file);
        let axis = read.axis.get_mut("x").unwrap();
        axis.compensation.backlash_width_m = Some(14e-6);
        axis.compensation.ripple.clear();
        table::set(&mut read, ("x", &machine.axis["x"].settings), tables, ("a board", "ripple"));
        assert_eq!(read.axis["x"].compensation.backlash_width_m, Some(14e-6));
        assert_eq!(read.axis["x"].compensation.ripple, file.axis["x"].compensation.ripple);
        assert_eq!(read.provenance.compensates, ["x: ripple"]);
    }
}

/// 0.2·3000/15 rad/s on a wave of 5/8 mm are 3.979 mm/s; two turns and 0.3 s and the acceleration at either end are 12.467 mm.
#[test]
fn what_cannot_be_learned_is_refused_by_name() {
    let refused = |change: fn(&mut Wanted)| {
        let mut wanted = wanted();
        change(&mut wanted);
        Plan::new(&wanted, &DECLARED).unwrap_err()
    };
    let PlanError::Speed { most_mm_per_min, .. } = refused(|wanted| wanted.speed_mm_per_s = Some(4.0)) else {
        panic!()
    };
    assert!((most_mm_per_min - 60.0 * 3.9789).abs() < 0.01, "{most_mm_per_min}");
    let fast = refused(|wanted| wanted.speed_mm_per_s = Some(4.0)).to_string();
    assert!(fast.contains("crossover of the velocity loop"), "{fast}");
    let rarely = refused(|wanted| (wanted.sample_s, wanted.speed_mm_per_s) = (0.01, Some(1.0))).to_string();
    assert!(rarely.contains("sample rate"), "{rarely}");
    for mm_per_s in [0.0, -1.0, f64::NAN] {
        let wanted = Wanted { speed_mm_per_s: Some(mm_per_s), ..wanted() };
        assert!(matches!(Plan::new(&wanted, &DECLARED), Err(PlanError::Speed { .. })));
    }
    let PlanError::Travel { least_mm, .. } = refused(|wanted| wanted.from_mm = Some(0.0)) else { panic!() };
    assert!((least_mm - 12.467).abs() < 0.001, "{least_mm}");
    assert!(matches!(refused(|wanted| wanted.to_mm = Some(f64::NAN)), PlanError::Travel { .. }));
    assert!(matches!(refused(|wanted| wanted.to_mm = Some(100.1)), PlanError::Beyond { .. }));
    assert!(matches!(refused(|wanted| wanted.harmonics = 13), PlanError::Harmonics));
    assert!(matches!(refused(|wanted| wanted.periods_mm = vec![5.0, -1.0]), PlanError::Period));
    assert!(matches!(refused(|wanted| wanted.periods_mm = vec![5.0, 4.9]), PlanError::Alike { .. }));
    // 20 mm have 24·20/0.001 positions of a wave of 1 µm.
    let fine = refused(|wanted| (wanted.periods_mm, wanted.harmonics) = (vec![0.001], 1));
    assert!(matches!(fine, PlanError::Points { points } if (480_000..600_000).contains(&points)), "{fine}");
    // A harmonic of both is one wave.
    let both = Wanted { periods_mm: vec![5.0, 1.25], harmonics: 4, ..wanted() };
    let plan = Plan::new(&both, &DECLARED).unwrap();
    assert_eq!(plan.candidates.len(), 7);
}

/// Without ends, four turns about the place of the axis, moved into the soft limits.
#[test]
fn a_travel_that_is_not_given_is_about_the_place_and_within_the_limits() {
    let travel_mm = |at_mm: f64| {
        let wanted = Wanted { from_mm: None, to_mm: None, at_mm, ..wanted() };
        let plan = Plan::new(&wanted, &DECLARED).unwrap();
        assert!((plan.grid.length_mm() - 20.0).abs() < 1e-9);
        plan.travel_mm
    };
    let [from_mm, to_mm] = travel_mm(30.0);
    assert!((from_mm + to_mm - 60.0).abs() < 1e-9 && (to_mm - from_mm - 22.467).abs() < 0.001);
    assert!((travel_mm(99.0)[1] - 100.0).abs() < 1e-9 && (travel_mm(-99.0)[0] + 100.0).abs() < 1e-9);
}
