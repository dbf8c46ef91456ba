//! Laws that are drawn at random, computed from the motion and not by the code under test.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::input::signals::Signals;
use crate::options::TraceOptions;
use files::log::{AxisLog, Log, Unit};
use model::residual_law::{Term, WavePosition};
use model::residual_table::TableVariable as V;
use numerics::noise::box_muller;
use shared::config::Rates;

const SAMPLE_S: f64 = 1e-3;
const NOISE_UM: f64 = 0.02;

/// Motion of an axis: a sum of two sines, whose derivatives are known.
#[derive(Clone, Copy)]
struct Motion {
    amplitude_mm: [f64; 2],
    rad_per_s: [f64; 2],
    phase: f64,
}

/// Position (mm), velocity (m/s) and acceleration (m/s²).
#[derive(Clone, Copy)]
struct Moved {
    mm: f64,
    m_per_s: f64,
    m_per_s2: f64,
}

impl Motion {
    fn at(&self, time_s: f64) -> Moved {
        let mut moved = Moved { mm: 0.0, m_per_s: 0.0, m_per_s2: 0.0 };
        for (amplitude, w) in self.amplitude_mm.into_iter().zip(self.rad_per_s) {
            let (sine, cosine) = (w * time_s + self.phase).sin_cos();
            moved.mm += amplitude * sine;
            moved.m_per_s += 1e-3 * amplitude * w * cosine;
            moved.m_per_s2 -= 1e-3 * amplitude * w * w * sine;
        }
        moved
    }
}

/// One log: the motion of two axes over 12 s.
fn motions(random: &mut ChaCha8Rng) -> [Motion; 2] {
    std::array::from_fn(|_| Motion {
        amplitude_mm: [random.random_range(30.0..70.0), random.random_range(1.0..6.0)],
        rad_per_s: [random.random_range(0.8..2.5), random.random_range(4.0..9.0)],
        phase: random.random_range(0.0..TAU),
    })
}

/// A true term: its form, and its value along a log by formulas of its own.
#[derive(Clone, Debug)]
struct Truth {
    term: Term,
    size_um: f64,
}

fn drawn(random: &mut ChaCha8Rng) -> Term {
    let product = |of: &[V]| Term::Product { of: of.to_vec(), coefficient: 1.0 };
    let over = [WavePosition::PositionMm, WavePosition::OtherPositionMm][random.random_range(0..2)];
    match random.random_range(0..12) {
        0 => product(&[V::PositionMm, V::OtherPositionMm]),
        1 => product(&[V::SpeedMPerS]),
        2 => product(&[V::PositionMm, V::Direction]),
        3 => product(&[V::PositionMm, V::PositionMm]),
        4 => product(&[V::OtherPositionMm, V::OtherPositionMm, V::OtherPositionMm]),
        5 => product(&[V::VelocityMPerS, V::OtherPositionMm]),
        6 => product(&[V::AccelerationMPerS2, V::OtherPositionMm]),
        7 => product(&[V::OtherDirection]),
        8 => product(&[V::OtherVelocityMPerS]),
        9 => product(&[V::Direction, V::OtherPositionMm]),
        10 => Term::Hysteresis { distance_mm: random.random_range(2.0..20.0), coefficient: 1.0 },
        _ => {
            let (cosine, sine) = random.random_range(0.0..TAU).sin_cos();
            Term::Wave { over, period_mm: random.random_range(8.0..50.0), cosine, sine }
        }
    }
}

/// The values of a term along a log; a direction turns over within a speed, or at once.
fn values(term: &Term, motion: &[Motion; 2], turning_m_per_s: f64) -> Vec<f64> {
    let direction = |m_per_s: f64| m_per_s / (m_per_s.abs() + turning_m_per_s);
    let mut memory = 0.0;
    let mut before_mm = None;
    let at = (0..SAMPLES).map(|i| {
        let [own, other] = [0, 1].map(|axis| motion[axis].at(i as f64 * SAMPLE_S));
        let moved_mm = own.mm - before_mm.unwrap_or(own.mm);
        before_mm = Some(own.mm);
        if let Term::Hysteresis { distance_mm, .. } = term {
            memory += (moved_mm - memory * moved_mm.abs()) / distance_mm;
        }
        let factor = |variable: &V| match variable {
            V::PositionMm => own.mm,
            V::VelocityMPerS => own.m_per_s,
            V::SpeedMPerS => own.m_per_s.abs(),
            V::AccelerationMPerS2 => own.m_per_s2,
            V::Direction => direction(own.m_per_s),
            V::OtherPositionMm => other.mm,
            V::OtherVelocityMPerS => other.m_per_s,
            V::OtherAccelerationMPerS2 => other.m_per_s2,
            V::OtherDirection => direction(other.m_per_s),
            V::ForceN | V::TimeS => f64::NAN,
        };
        match term {
            Term::Product { of, .. } => of.iter().map(factor).product(),
            Term::Wave { over, period_mm, cosine, sine } => {
                let mm = if *over == WavePosition::PositionMm { own.mm } else { other.mm };
                cosine * (TAU * mm / period_mm).cos() + sine * (TAU * mm / period_mm).sin()
            }
            Term::Hysteresis { .. } => memory,
        }
    });
    at.collect()
}

/// The law found of a residual with these true terms, with what it is judged by.
struct Case {
    truths: Vec<Truth>,
    found: Option<FoundLaw>,
}

fn signals(motion: &[Motion; 2], name: &str, start_s: f64) -> Signals {
    let axes = ["x", "y"].into_iter().zip(motion).map(|(axis, motion)| {
        let mut log = AxisLog::new(axis, Unit::Millimetre);
        log.table = Some((0..SAMPLES).map(|i| motion.at(i as f64 * SAMPLE_S).mm).collect());
        log.tool = log.table.clone();
        log
    });
    let log = Log::new(name, start_s, SAMPLE_S, axes);
    Signals::new(&log, &["x".to_owned(), "y".to_owned()], &TraceOptions::default().samples)
}

const SAMPLES: usize = 12_000;

fn case(seed: u64, terms: usize) -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut truths: Vec<Truth> = Vec::new();
    while truths.len() < terms {
        let term = drawn(&mut random);
        let size_um = NOISE_UM * 3.0 * (100.0f64 / 3.0).powf(random.random());
        if truths.iter().all(|known| {
            std::mem::discriminant(&known.term) != std::mem::discriminant(&term)
                || matches!(term, Term::Product { .. }) && known.term != term
        }) {
            truths.push(Truth { term, size_um });
        }
    }
    of_truths(truths, 0.0, random)
}

/// What is found of these true terms, whose directions turn over within a speed.
fn of_truths(truths: Vec<Truth>, turning_m_per_s: f64, mut random: ChaCha8Rng) -> Case {
    let logs: Vec<[Motion; 2]> = (0..5).map(|_| motions(&mut random)).collect();
    let of_terms: Vec<Vec<Vec<f64>>> = truths
        .iter()
        .map(|truth| logs.iter().map(|log| values(&truth.term, log, turning_m_per_s)).collect())
        .collect();
    let residual = |log: usize, random: &mut ChaCha8Rng| {
        let mut sum: Vec<f64> = (0..SAMPLES).map(|_| NOISE_UM * box_muller(random)).collect();
        for (truth, values) in truths.iter().zip(&of_terms) {
            let rms = numerics::rms(values.iter().flatten().copied());
            sum.iter_mut().zip(&values[log]).for_each(|(sum, value)| *sum += truth.size_um / rms * value);
        }
        sum
    };
    let of_logs: Vec<Signals> =
        logs.iter().zip(0..).map(|(log, i)| signals(log, &format!("{i}"), 20.0 * f64::from(i))).collect();
    let residuals: Vec<Vec<f64>> = (0..5).map(|log| residual(log, &mut random)).collect();
    let names = ["x".to_owned(), "y".to_owned()];
    let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
    let options = TraceOptions::default();
    let (fit, validate) = of_logs.split_at(3);
    let [fit, validate] = [fit, validate].map(|logs| FitData::new(logs, &names, 0, rates, &options));
    let series = |logs: &[Vec<f64>]| -> Vec<ResidualSeries> {
        let of = |(log, values): (usize, &Vec<f64>)| ResidualSeries {
            stage: Stage::Tool,
            log,
            values: values.clone(),
        };
        logs.iter().enumerate().map(of).collect()
    };
    let (of_fit, of_validation) = residuals.split_at(3);
    let (of_fit, of_validation) = (series(of_fit), series(of_validation));
    let left = |data, residuals| Left { data, residuals, free: &[] };
    Case { truths, found: law(&left(&fit, &of_fit), &left(&validate, &of_validation), Stage::Tool, NOISE_UM) }
}

/// Of residuals whose columns are exact, nearly every law is found: 59 of 60 with other seeds. The limit allows for one that is not in twelve.
#[test]
fn drawn_laws_are_found_and_no_other_terms() {
    let alike = |a: &Term, b: &Term| library::is_same_form(a, b, |_| 140.0);
    let mut right = 0;
    for seed in 100..112u32 {
        let Case { truths, found } = case(u64::from(seed), 1 + (seed % 3) as usize);
        let found = found.unwrap_or_else(|| panic!("{seed}: no law for {truths:?}"));
        let is_true = |term: &Term| truths.iter().any(|truth| alike(term, &truth.term));
        let is_found = |truth: &Truth| found.terms.iter().any(|found| alike(&found.term, &truth.term));
        let is_right = truths.iter().all(is_found) && found.terms.len() == truths.len();
        right += usize::from(is_right);
        for term in &found.terms {
            assert!(is_true(&term.term) || !found.is_certain(term), "{seed}: {term:?} of {truths:?}");
        }
        // The rms of 24,000 samples scatters by 0.5 %; the fit of some columns lowers it by less.
        let ratio = found.after.fit / NOISE_UM;
        assert!(!is_right || (0.97..1.3).contains(&ratio), "{seed}: {ratio} {truths:?}");
    }
    assert!(right >= 11, "{right} of 12");
}

/// The period of a wave of 28 times the noise. Of white noise σ at N places with the variance V, 2π/period has the error σ·√(2/(N·V)) over the amplitude
/// (the bound of Cramér and Rao, which least squares reach). The interval is estimated from some dozen blocks, to about 15 %, and V from the places
/// with those near reversals: a factor of 1.6 either way is four such errors. Fewer than 7 of 10 intervals contain the truth with a probability of 0.1 %.
#[test]
fn the_interval_of_a_period_is_that_of_its_error() {
    let mut right = 0;
    for seed in 0..10 {
        let (over, period_mm) = (WavePosition::PositionMm, 23.0);
        let wave = Term::Wave { over, period_mm, cosine: 0.6, sine: 0.8 };
        let truth = Truth { term: wave, size_um: 20.0 * NOISE_UM };
        let random = ChaCha8Rng::seed_from_u64(seed);
        let places: Vec<f64> = {
            let mut random = random.clone();
            let logs: Vec<[Motion; 2]> = (0..3).map(|_| motions(&mut random)).collect();
            let of_log = |log: [Motion; 2]| (0..SAMPLES).map(move |i| log[0].at(i as f64 * SAMPLE_S).mm);
            logs.into_iter().flat_map(of_log).collect()
        };
        let mean = numerics::mean(places.iter().copied());
        let variance = numerics::mean(places.iter().map(|mm| (mm - mean).powi(2)));
        let found = of_truths(vec![truth], 0.0, random).found.unwrap();
        let term = found.terms.iter().find(|term| term.term.length_mm().is_some()).unwrap();
        let half_mm = term.length_half_width.unwrap();
        // Of 36,000 samples every second one is taken; an amplitude is √2 times the rms.
        let error = (2.0 / (18_000.0 * variance)).sqrt() / (20.0 * 2f64.sqrt());
        let ratio = half_mm / (1.96 * error * period_mm * period_mm / TAU);
        assert!((1.0 / 1.6..1.6).contains(&ratio), "{seed}: {ratio}");
        right += usize::from((term.term.length_mm().unwrap() - period_mm).abs() <= half_mm);
    }
    assert!(right >= 7, "{right} of 10");
}

/// A direction that turns over within 0.1 mm/s differs from −1 and 1 by 0.2 % at 50 mm/s and by 2 % at 5 mm/s, near a reversal. Of a term of 90 times the noise,
/// this is about the noise, which other terms of the motion of the axis describe better than nothing: none of them is certain.
#[test]
fn what_the_form_of_a_large_term_lacks_is_no_certain_term() {
    let truth = Term::Product { of: vec![V::PositionMm, V::Direction], coefficient: 1.0 };
    let mut in_shadow = 0;
    for seed in 0..4 {
        let of = Truth { term: truth.clone(), size_um: 90.0 * NOISE_UM };
        let Case { found, .. } = of_truths(vec![of], 1e-4, ChaCha8Rng::seed_from_u64(seed));
        let found = found.unwrap_or_else(|| panic!("{seed}: no law"));
        for term in &found.terms {
            let is_true = library::is_same_form(&term.term, &truth, |_| 140.0);
            assert_eq!(found.is_certain(term), is_true, "{seed}: {term:?}");
            let is_shadowed_alone =
                term.shadowed_by.is_some() && term.rivals.is_empty() && term.is_in_all_folds;
            in_shadow += usize::from(is_shadowed_alone && found.is_complete);
        }
    }
    // Terms that nothing but their size speaks against.
    assert!(in_shadow >= 1, "{in_shadow}");
}

/// Noise alone follows no law.
#[test]
fn noise_has_no_law() {
    for seed in 0..6 {
        assert_eq!(case(seed, 0).found, None, "{seed}");
    }
}
