//! The second simulator compared with closed forms, the reproducibility of a case, and two cases traced.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::case::Case;
use super::kind::Kind;
use super::machine::Axis;
use super::motion::{Pace, Segment, sampled};
use super::plant::{Mechanics, STEP_S, State};
use super::servo::Settings;
use super::simulation;
use super::summary::Summary;
use super::*;
use files::log::{Channel, Log};

pub(super) fn mechanics() -> Mechanics {
    Mechanics {
        motor_kg: 100.0,
        table_kg: 150.0,
        stiffness_n_per_m: 200e6,
        damping_n_s_per_m: 12e3,
        coulomb_n: 150.0,
        viscous_n_s_per_m: 900.0,
        motor_coulomb_n: 40.0,
        presliding_n_per_m: 40e6,
        presliding_n_s_per_m: 2e3,
        ..Mechanics::default()
    }
}

pub(super) fn axis(hpc: bool) -> Axis {
    let servo = Settings {
        hpc,
        position_gain_per_s: 50.0,
        feedforward: 0.6,
        velocity_gain_n_s_per_m: 60e3,
        integral_s: 0.02,
        limit_n: 20e3,
        ..Settings::default()
    };
    Axis { servo, mechanics: mechanics(), ..Axis::default() }
}

pub(super) const SPEED_MM_PER_S: f64 = 40.0;

/// Log of a line of 80 mm along x, forwards and back, and the samples of 0.4 s of constant speed in each direction.
pub(super) fn line(x: &Axis) -> (Log, [std::ops::Range<usize>; 2]) {
    let pace = Pace { speed: SPEED_MM_PER_S, acceleration: 2000.0, ..Pace::default() };
    let positions = sampled([-40.0, 0.0], &[Segment::Line([40.0, 0.0]), Segment::Line([-40.0, 0.0])], pace);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let log = simulation::run(&[x.clone(), axis(false)], &positions, 0.0, &mut random);
    // One direction takes 2.02 s; the slowest response of the loop, that of the integral, has a time constant near 20 ms.
    (log, [1500..1900, 3520..3920])
}

/// Mean of the difference of two channels of x, mm.
fn difference(log: &Log, of: [Channel; 2], at: &std::ops::Range<usize>) -> f64 {
    let [a, b] = of.map(|channel| log.axes[0].channel(channel).unwrap()[at.clone()].to_vec());
    numerics::mean(a) - numerics::mean(b)
}

#[test]
fn at_constant_speed_the_motor_follows_at_v_over_kp_less_the_feed_forward() {
    // With the integral, v = Kp·e in steady state; e = command + Kf/Kp·v − motor; HPC has the gain 1 for a constant.
    let expected_mm = SPEED_MM_PER_S / 50.0 * (1.0 - 0.6);
    for hpc in [false, true] {
        let (log, [forth, back]) = line(&axis(hpc));
        let following = |at| difference(&log, [Channel::Command, Channel::Motor], at);
        // The mean of 400 samples of 10 nm noise lies within 2 nm; the remaining response of the integral is of that
        // size.
        assert!((following(&forth) - expected_mm).abs() < 5e-6, "{}", following(&forth));
        assert!((following(&back) + expected_mm).abs() < 5e-6, "{}", following(&back));
    }
}

#[test]
fn reversal_shows_the_gap_and_twice_the_stretch_under_friction() {
    let gap_mm = 12e-3;
    let mut with_gap = axis(false);
    with_gap.mechanics.backlash_m = 1e-3 * gap_mm;
    // (C + b·v)/K in each direction.
    let stretch_mm = 1e3 * (150.0 + 900.0 * 1e-3 * SPEED_MM_PER_S) / 200e6;
    for (axis, gap_mm) in [(axis(false), 0.0), (with_gap, gap_mm)] {
        let (log, [forth, back]) = line(&axis);
        let lost = |at| difference(&log, [Channel::Motor, Channel::Table], at);
        let expected_mm = gap_mm + 2.0 * stretch_mm;
        // Means of 400 samples with noise of 22 nm: the tolerance is three standard deviations of the difference.
        let found_mm = lost(&forth) - lost(&back);
        assert!((found_mm - expected_mm).abs() < 5e-6, "{found_mm} {expected_mm}");
    }
}

#[test]
fn under_a_constant_force_it_ends_at_the_speed_at_which_all_friction_is_that_force() {
    let (force_n, load_n) = (400.0, 100.0);
    let plant = Mechanics { load_n, asymmetry_n_s_per_m: 200.0, ..mechanics() };
    let mut state = State::resting(0.0);
    // m/b is 0.23 s: after 5 s, a fraction of e^−21 of the difference in speed is left.
    for _ in 0..100_000 {
        plant.step(&mut state, force_n);
    }
    // Sliding LuGre friction is at its Coulomb level: F = motor + C + load + (b + h)·v.
    let speed = (force_n - 40.0 - 150.0 - load_n) / (900.0 + 200.0);
    assert!((state.table_m_per_s - speed).abs() < 1e-6 * speed, "{} {speed}", state.table_m_per_s);
    // The spring carries all forces on the table; the deflection of the bristles is C/σ0.
    let stretch_m = (150.0 + load_n + 1100.0 * speed) / 200e6;
    assert!((state.motor_m - state.table_m - stretch_m).abs() < 1e-10);
    assert!((state.bristle_m - 150.0 / 40e6).abs() < 1e-10, "{}", state.bristle_m);
}

#[test]
fn a_bristle_that_does_not_slide_is_a_spring() {
    let plant = mechanics();
    let mut state = State::resting(0.0);
    let force_n = 20.0;
    for _ in 0..200_000 {
        plant.step(&mut state, force_n);
    }
    // Far below the Coulomb level, and without motor friction at rest, z ≈ F/σ0. The model also creeps a little at 20 of
    // 150 N, which only shortens the bristle.
    let longest_m = force_n / 40e6;
    assert!(state.bristle_m > 0.9 * longest_m && state.bristle_m < 1.001 * longest_m, "{}", state.bristle_m);
}

#[test]
fn the_tool_lags_by_its_mode() {
    // At constant speed the mode ω²/(s² + 2ζωs + ω²) lags by 2ζ/ω.
    let mut flexible = axis(false);
    let (omega, zeta) = (std::f64::consts::TAU * 30.0, 0.1);
    flexible.resonance = Some([omega, zeta]);
    let (log, [forth, _]) = line(&flexible);
    let lag_mm = difference(&log, [Channel::Table, Channel::Tool], &forth);
    let expected_mm = SPEED_MM_PER_S * 2.0 * zeta / omega;
    // The tolerance is a twentieth of a step of the plant, the step of the mode, and thrice the mean of the noise, 5 nm. A tool
    // that is half a step late or early exceeds it nine times.
    assert!((lag_mm - expected_mm).abs() < 0.05 * STEP_S * SPEED_MM_PER_S + 1.5e-5, "{lag_mm} {expected_mm}");
}

#[test]
fn a_delayed_channel_lags_by_delay_times_speed() {
    let mut delayed = axis(false);
    delayed.table_delay_s = 0.77e-3;
    let (log, [forth, back]) = line(&delayed);
    let (undelayed, _) = line(&axis(false));
    let lag = |log: &Log, at| difference(log, [Channel::Motor, Channel::Table], at);
    for (at, sign) in [(&forth, 1.0), (&back, -1.0)] {
        let lag_mm = lag(&log, at) - lag(&undelayed, at);
        assert!((lag_mm - sign * 0.77e-3 * SPEED_MM_PER_S).abs() < 5e-6, "{lag_mm}");
    }
}

#[test]
fn a_case_is_a_function_of_seed_and_number() {
    let threads = |count| rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
    let draw = |seed, number| Case::draw(seed, number).unwrap();
    let [one, three] = [1, 3].map(|count| threads(count).install(|| draw(7, 4)));
    assert_eq!(one.machine_text, three.machine_text);
    assert_eq!(one.truths, three.truths);
    assert!(one.fit == three.fit && one.validate == three.validate);
    for other in [draw(8, 4), draw(7, 5)] {
        assert_ne!(one.machine.axis, other.machine.axis);
    }
}

#[test]
fn a_kept_case_is_the_traced_one() {
    let folder = tempfile::tempdir().unwrap();
    let case = Case::draw(7, 4).unwrap();
    let kept = case.keep(folder.path()).unwrap();
    assert_eq!(trace::Machine::read(&kept.join("machine.toml")).unwrap(), case.machine);
    for log in case.fit.iter().chain(&case.validate) {
        let read = Log::read(&kept.join(format!("{}.csv.gz", log.source))).unwrap();
        assert!(read.axes == log.axes, "{}", log.source);
        // To a nanosecond.
        assert!((read.start_s - log.start_s).abs() < 1e-9 && (read.sample_time_s - 1e-3).abs() < 1e-12);
    }
    let truth: Value =
        serde_json::from_str(&std::fs::read_to_string(kept.join("truth.json")).unwrap()).unwrap();
    assert_eq!(truth["effects"].as_array().unwrap().len(), case.truths.len());
}

/// A machine without effects: to find nothing on it would be exact.
#[test]
fn a_refused_case_is_not_exact() {
    let case = Case::draw(1, 15).unwrap();
    assert!(case.truths.is_empty());
    let outcome = Outcome::refused(&case, &InputError::expected("fit", "a force", "none"));
    assert!(!outcome.is_exact());
    let outcomes = [outcome];
    let tables = text_summary::tables(&outcomes, &[], &Summary::new(&outcomes));
    assert!(tables.contains("case 15: refused: fit: expected a force, found none"), "{tables}");
}

/// The whole chain on two machines, one with an effect and one without.
#[test]
fn two_machines_come_out_as_they_were_drawn() {
    let outcomes = [2, 15].map(|number| trace_and_score(&Case::draw(1, number).unwrap(), &|_| {}).unwrap());
    let summary = Summary::new(&outcomes);
    assert_eq!((summary.exact.hits, summary.clean.trials), (2, 1));
    assert_eq!(summary.confusion.of("squareness", "squareness"), 1);
    // 50 µm/m over 60 mm are 3 µm, with 80 nm of noise in each of 40 000 samples: the error due to noise is far below 1
    // %.
    assert!(summary.error.percentile95 < 0.01, "{}", summary.error.percentile95);
    // Only noise remains in the tool's residual: both axes, both machines.
    let (channel, spread) = &summary.ratios[3];
    assert!(
        *channel == "tool" && spread.count == 4 && (0.9..1.1).contains(&spread.percentile95),
        "{spread:?}"
    );
    // At the other stages, which depend on friction, reversals leave less than the noise.
    for (channel, spread) in &summary.ratios[..3] {
        assert!(
            spread.count == 4 && spread.percentile95 < 2f64.sqrt() && spread.median > 0.9,
            "{channel} {spread:?}"
        );
    }
    let json = json(1, 2, &outcomes, &summary);
    assert_eq!(json["cases"][0]["exact"], serde_json::json!(true));
    assert_eq!(json["summary"]["exact"]["of"], serde_json::json!(2));
}

#[test]
fn a_kept_case_of_another_kind_has_its_extras_and_the_logs_that_are_traced() {
    let folder = tempfile::tempdir().unwrap();
    for kind in [Kind::Shape, Kind::Coarse, Kind::Slip] {
        let case = Case::draw_kind(kind, 7, 2).unwrap();
        let kept = case.keep(folder.path()).unwrap();
        assert_eq!(kept.file_name().unwrap().to_str(), Some(format!("{kind}-2").as_str()));
        for log in &case.fit {
            assert!(Log::read(&kept.join(format!("{}.csv.gz", log.source))).unwrap().axes == log.axes);
        }
        let text = std::fs::read_to_string(kept.join("truth.json")).unwrap();
        let truth: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(truth["effects"].as_array().unwrap().len(), case.truths.len());
        let extras: Vec<(String, String)> = serde_json::from_value(truth["extra"].clone()).unwrap();
        let expected: Vec<_> = case.extras.iter().map(|e| (e.name.to_owned(), e.axis.to_owned())).collect();
        assert_eq!(extras, expected);
        assert!(!extras.is_empty());
    }
}
