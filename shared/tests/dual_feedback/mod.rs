//! The dual feedback system in the time domain, against the closed forms of [`shared::feedback::dual`].
//!
//! The motor is ideal: motor += (1 − e^(−h/T))·(command − resolver) per tick h, K = 1/T. The table lags it by ΔQ.
//!
//! Signals that are held over a tick cause an error of the first order in h. Each bound is derived from it;
//! `extrapolation_to_a_tick_of_zero_gives_the_closed_forms` removes it by extrapolation from h and h/2.

#![allow(clippy::float_cmp, reason = "T = T' has closed forms of its own; equal constants are passed")]

use std::f64::consts::{SQRT_2, TAU};

use shared::feedback::dual::{Feedback, State};
use shared::feedback::exponential_decay::ExponentialDecay;
use shared::feedback::phase::Phase;
use shared::feedback::transducer::Transducer;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const TICK_S: f64 = 1.0 / 20_000.0;

/// T and T', s: T' equal to T, longer and shorter.
const TIMES: [(f64, f64); 3] = [(0.03, 0.03), (0.03, 0.08), (0.03, 0.01)];

/// Position units in a nanometre.
const NM: f64 = 1_048_576.0;

/// Fraction that is corrected per tick: 1 − e^(−h/T).
fn fraction(tick_s: f64, time_s: f64) -> f64 {
    -f64::exp_m1(-tick_s / time_s)
}

#[expect(clippy::cast_possible_truncation, reason = "some 100 µm")]
fn units(nm: f64) -> i64 {
    (nm * NM).round() as i64
}

/// Signal × gain, as a distance.
fn scaled<S: Scalar>(distance: i64, gain: S::Gain) -> i64 {
    S::to_distance(S::from_distance(distance) * gain)
}

/// The resolver with shifted excitation, and phase detector 1.
trait Resolver {
    fn new(tick_s: f64, shift_time_s: f64) -> Self;
    /// Command − resolver, after the shift of this tick.
    fn detect(&mut self, command: Position, motor: Position, table: Position) -> i64;
}

/// With positions, as in the controller.
struct Positions<S: Scalar> {
    feedback: Feedback<S>,
    state: State,
}

impl<S: Scalar> Resolver for Positions<S> {
    fn new(tick_s: f64, shift_time_s: f64) -> Self {
        let feedback = Feedback::Dual {
            fraction: S::gain(fraction(tick_s, shift_time_s)),
            fade: ExponentialDecay::new(2000.0),
        };
        Self { feedback, state: State::default() }
    }

    fn detect(&mut self, command: Position, motor: Position, table: Position) -> i64 {
        command - self.feedback.position(&mut self.state, motor, Some(table))
    }
}

/// With phases alone, as in the paper; a cycle is 2⁴² position units (4.19 mm).
struct Phases<S: Scalar> {
    fraction: S::Gain,
    /// Shift of the resolver excitation, position units: 2⁻¹⁰ steps of a phase.
    excitation: i64,
}

/// log₂ of the position units in a step of the phase.
const STEP: u32 = 10;

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a phase wraps")]
fn phase(distance: i64) -> Phase {
    Phase((distance >> STEP) as u32)
}

impl<S: Scalar> Phases<S> {
    fn resolver(&self, motor: Position) -> Phase {
        Phase(phase(motor.0).0.wrapping_add(phase(self.excitation).0))
    }
}

impl<S: Scalar> Resolver for Phases<S> {
    fn new(tick_s: f64, shift_time_s: f64) -> Self {
        Self { fraction: S::gain(fraction(tick_s, shift_time_s)), excitation: 0 }
    }

    fn detect(&mut self, command: Position, motor: Position, table: Position) -> i64 {
        let second = phase(table.0).difference(self.resolver(motor));
        self.excitation += scaled::<S>(i64::from(second) << STEP, self.fraction);
        let first = phase(command.0).difference(self.resolver(motor));
        i64::from(first) << STEP
    }
}

/// One tick of a run, nm.
#[derive(Clone, Copy, Default)]
struct Sample {
    /// Qo, the table.
    table: f64,
    /// Qc, output of phase detector 2: table − resolver.
    second: f64,
}

/// Runs the system. Returns one sample per tick, the first at t = 0.
fn run<S: Scalar, R: Resolver>(
    (t, shift_t): (f64, f64),
    tick_s: f64,
    ticks: u32,
    command: impl Fn(f64) -> f64,
    lost_motion: impl Fn(f64) -> f64,
) -> Vec<Sample> {
    let gain = S::gain(fraction(tick_s, t));
    let mut resolver = R::new(tick_s, shift_t);
    let (mut motor, mut shift) = (Position(0), 0);
    (0..ticks)
        .map(|k| {
            let time = f64::from(k) * tick_s;
            let table = motor - units(lost_motion(time));
            let command = Position(units(command(time)));
            let sample = Sample { table: table.0 as f64 / NM, second: (table - (motor + shift)) as f64 / NM };
            let first = resolver.detect(command, motor, table);
            shift = command - motor - first;
            motor += scaled::<S>(first, gain);
            sample
        })
        .collect()
}

const fn zero(_: f64) -> f64 {
    0.0
}

/// Qo after a step ΔQ of 1.
fn after_step((t, shift_t): (f64, f64), time: f64) -> f64 {
    if t == shift_t {
        -(1.0 + time / t) * (-time / t).exp()
    } else {
        -(t * (-time / t).exp() - shift_t * (-time / shift_t).exp()) / (t - shift_t)
    }
}

/// Qo during a ramp ΔQ of 1 per second.
fn after_ramp((t, shift_t): (f64, f64), time: f64) -> f64 {
    if t == shift_t {
        -(2.0 * t - (2.0 * t + time) * (-time / t).exp())
    } else {
        let part = |t: f64| t * t * -f64::exp_m1(-time / t);
        -(part(t) - part(shift_t)) / (t - shift_t)
    }
}

/// Calls a check for every number format and both forms of the system.
macro_rules! for_all {
    ($check:ident($($argument:expr),*)) => {
        $check::<Fixed, Positions<Fixed>>($($argument),*);
        $check::<f32, Positions<f32>>($($argument),*);
        $check::<f64, Positions<f64>>($($argument),*);
        $check::<Fixed, Phases<Fixed>>($($argument),*);
        $check::<f32, Phases<f32>>($($argument),*);
        $check::<f64, Phases<f64>>($($argument),*);
    };
}

// Below the macro that it uses.
mod frequency;

/// Error of the number format for a motion of 10 µm, nm. Fixed point: a gain h/T ≥ 6e-4 is rounded by 2⁻²⁵, which is
/// 5e-5 of T, and T·dQo/dT ≤ 1/e of the step; in addition, each of the two integrators stops within half the resolution
/// of an error, 1/32 nm. f32 rounds a difference by 2⁻²⁵.
fn format_nm<S: Scalar>() -> f64 {
    match S::NAME {
        "fixed" => 0.3,
        "f32" => 0.01,
        _ => 0.005,
    }
}

const STEP_NM: f64 = 10_000.0;

/// Greatest difference between an output of a run and its closed form.
fn worst(rows: &[Sample], tick_s: f64, exact: impl Fn(f64) -> f64, output: impl Fn(&Sample) -> f64) -> f64 {
    (0u32..).zip(rows).map(|(k, row)| (output(row) - exact(f64::from(k) * tick_s)).abs()).fold(0.0, f64::max)
}

fn steps<S: Scalar, R: Resolver>(times: (f64, f64)) {
    let rows = run::<S, R>(times, TICK_S, 20_000, zero, |_| STEP_NM);
    let error = worst(&rows, TICK_S, |t| STEP_NM * after_step(times, t), |row| row.table);
    // The shift is exact at the ticks. Held over a tick it has an error of up to h·d(shift)/dt ≤ h·ΔQ/T'. The position loop,
    // a low-pass with a gain of 1, does not amplify this error; the lower bound shows that it is present.
    let bound = STEP_NM * TICK_S / times.1;
    println!("{} {times:?}: step within {error:.3} nm of its closed form, hold error {bound:.3} nm", S::NAME);
    assert!(error < bound + format_nm::<S>(), "{} {times:?}: {error} nm, bound {bound}", S::NAME);
    assert!(error > 0.05 * bound, "{} {times:?}: {error} nm, bound {bound}", S::NAME);
    // Qc is exact at the ticks.
    let error = worst(&rows, TICK_S, |t| -STEP_NM * (-t / times.1).exp(), |row| row.second);
    assert!(error < format_nm::<S>() + 0.002, "{} {times:?}: {error}", S::NAME);
}

#[test]
fn a_step_of_lost_motion() {
    for times in TIMES {
        for_all!(steps(times));
    }
}

/// 1 mm/s of lost motion.
const RAMP_NM_PER_S: f64 = 1e6;

fn ramps<S: Scalar, R: Resolver>(times: (f64, f64)) {
    let rows = run::<S, R>(times, TICK_S, 10_000, zero, |t| RAMP_NM_PER_S * t);
    // The lost motion is held over a tick, on average half a tick late. The shift is held at its value at the end of the
    // tick, half a tick early. Both errors cancel up to the second order, r·h²/T with the shorter time. The error of the
    // format is proportional to the final value r·(T + T').
    let (reach, shorter) = (RAMP_NM_PER_S * (times.0 + times.1), times.0.min(times.1));
    let format = format_nm::<S>() * reach / STEP_NM;
    let second_order = RAMP_NM_PER_S * TICK_S * TICK_S / shorter;
    let error = worst(&rows, TICK_S, |t| RAMP_NM_PER_S * after_ramp(times, t), |row| row.table);
    println!("{} {times:?}: ramp to {reach} nm within {error:.3} nm of its closed form", S::NAME);
    assert!(error < second_order + format, "{} {times:?}: {error} nm, bound {second_order}", S::NAME);
    // The lost motion that is half a tick late appears in Qc: r·h/2.
    let late = RAMP_NM_PER_S * TICK_S / 2.0;
    let exact = |t: f64| RAMP_NM_PER_S * times.1 * f64::exp_m1(-t / times.1);
    let error = worst(&rows, TICK_S, exact, |row| row.second);
    assert!(error < 1.1 * late + format && error > 0.9 * late - format, "{} {times:?}: {error}", S::NAME);
    // The final value is −r·(T + T'); 0.5 s are at least 6 of the longer time constant, e⁻⁶ = 0.0025.
    let end = rows.last().unwrap().table / (-RAMP_NM_PER_S * (times.0 + times.1));
    assert!((0.994..1.001).contains(&end), "{end}");
}

#[test]
fn a_ramp_of_lost_motion() {
    for times in TIMES {
        for_all!(ramps(times));
    }
}

#[test]
fn extrapolation_to_a_tick_of_zero_gives_the_closed_forms() {
    for times in TIMES {
        let run_with = |ticks_per: u32, lost_motion: fn(f64) -> f64| {
            let tick_s = TICK_S / f64::from(ticks_per);
            run::<f64, Positions<f64>>(times, tick_s, 8000 * ticks_per, zero, lost_motion)
        };
        let check = |lost_motion: fn(f64) -> f64, exact: &dyn Fn(f64) -> f64, bound: f64| {
            let (coarse, fine) = (run_with(1, lost_motion), run_with(2, lost_motion));
            let extrapolated: Vec<Sample> = coarse
                .iter()
                .zip(fine.iter().step_by(2))
                .map(|(coarse, fine)| Sample { table: 2.0 * fine.table - coarse.table, second: 0.0 })
                .collect();
            let error = worst(&extrapolated, TICK_S, exact, |row| row.table);
            println!("{times:?}: extrapolated, within {error:.5} nm");
            assert!(error < bound, "{times:?}: {error} nm, bound {bound}");
        };
        // The remaining error is of the second order, (h/T)² with the shorter time, and 0.01 nm of rounding.
        let second_order = (TICK_S / times.0.min(times.1)).powi(2);
        check(|_| STEP_NM, &|t| STEP_NM * after_step(times, t), STEP_NM * second_order + 0.01);
        let reach = RAMP_NM_PER_S * (times.0 + times.1);
        check(|t| RAMP_NM_PER_S * t, &|t| RAMP_NM_PER_S * after_ramp(times, t), reach * second_order + 0.01);
    }
}

/// A step `ΔQb` and a ramp `ΔQp` together: Qo is the sum of both responses, −Qc lies between `ΔQb` and `ΔQp`/K'.
fn step_and_ramp<S: Scalar, R: Resolver>(times: (f64, f64), backlash_nm: f64, pitch_nm_per_s: f64) {
    let lost = |t: f64| backlash_nm + pitch_nm_per_s * t;
    let rows = run::<S, R>(times, TICK_S, 10_000, zero, lost);
    let exact = |t: f64| backlash_nm * after_step(times, t) + pitch_nm_per_s * after_ramp(times, t);
    let held = TICK_S * (backlash_nm / times.1 + pitch_nm_per_s);
    let error = worst(&rows, TICK_S, exact, |row| row.table);
    assert!(error < held + 10.0 * format_nm::<S>(), "{} {times:?}: {error} nm, bound {held}", S::NAME);

    let ramp = pitch_nm_per_s * times.1;
    // The ramp is held over a tick, as above.
    let slack = TICK_S * pitch_nm_per_s + 10.0 * format_nm::<S>();
    let (least, most) = (ramp.min(backlash_nm) - slack, ramp.max(backlash_nm) + slack);
    for (k, row) in (0u32..).zip(&rows) {
        let minus_qc = -row.second;
        assert!((least..=most).contains(&minus_qc), "{} {k}: {minus_qc}, not {least} to {most}", S::NAME);
        // Less than the present lost motion, which is the error of a semi-closed loop.
        assert!(k == 0 || minus_qc < lost(f64::from(k) * TICK_S), "{} {k}: {minus_qc}", S::NAME);
    }
    // −Qc starts at ΔQb and ends at ΔQp/K'.
    assert!((-rows[0].second - backlash_nm).abs() < slack);
    assert!((-rows.last().unwrap().second - ramp).abs() < slack + 0.003 * (ramp - backlash_nm).abs());
}

#[test]
fn a_step_and_a_ramp_at_once() {
    for times in TIMES {
        // ΔQp/K' is twice and half of ΔQb.
        for_all!(step_and_ramp(times, 10_000.0, 20_000.0 / times.1));
        for_all!(step_and_ramp(times, 10_000.0, 5_000.0 / times.1));
    }
}

/// Greatest difference between the two forms at up to 50 mm/s over 19 cycles of the phases with varying lost motion, nm.
fn forms<S: Scalar>() -> f64 {
    let command = |t: f64| 50e6 * (t - 0.25 * (1.0 - (-t / 0.25).exp()));
    let lost = |t: f64| 10_000.0 + 5_000.0 * (40.0 * t).sin();
    let times = (0.03, 0.08);
    let positions = run::<S, Positions<S>>(times, TICK_S, 40_000, command, lost);
    let phases = run::<S, Phases<S>>(times, TICK_S, 40_000, command, lost);
    assert!(positions.last().unwrap().table > 80e6);
    positions.iter().zip(&phases).map(|(a, b)| (a.table - b.table).abs()).fold(0.0, f64::max)
}

#[test]
fn phases_and_positions_are_the_same_system() {
    // The phases of motor, table and excitation are each truncated to steps of 1 pm.
    let worst = forms::<f64>();
    println!(
        "difference of phases and positions: f64 {worst:.5}, f32 {:.4}, fixed {:.4} nm",
        forms::<f32>(),
        forms::<Fixed>()
    );
    assert!(worst < 0.004 && worst > 0.0001, "{worst}");
    // A following error of 50 mm/s·T = 1.5 mm is rounded by 2⁻²⁵ of its value: 0.05 nm.
    assert!(forms::<f32>() < 0.06, "{}", forms::<f32>());
    // A step of the phase can change the rounding of an error, 1/16 nm.
    assert!(forms::<Fixed>() < 0.07, "{}", forms::<Fixed>());
}

/// Amplitude of the feedback at ω = K' for sines on the motor and on the table.
fn feedback_amplitude<S: Scalar>(motor_nm: f64, table_nm: f64) -> f64 {
    let n = 2000;
    let omega = TAU / (f64::from(n) * TICK_S);
    let mut resolver = Positions::<S>::new(TICK_S, 1.0 / omega);
    let (mut re, mut im) = (0.0, 0.0);
    for k in 0..12 * n {
        let (sin, cos) = (omega * f64::from(k) * TICK_S).sin_cos();
        let [motor, table] = [motor_nm, table_nm].map(|nm| Position(units(nm * sin)));
        let feedback = -resolver.detect(Position(0), motor, table) as f64 / NM;
        // After six periods the transient has decayed to e^(−37).
        if k >= 6 * n {
            re += feedback * sin / f64::from(3 * n);
            im += feedback * cos / f64::from(3 * n);
        }
    }
    re.hypot(im)
}

fn crosses_over<S: Scalar>() {
    let (motor, table) = (feedback_amplitude::<S>(100_000.0, 0.0), feedback_amplitude::<S>(0.0, 100_000.0));
    println!("{}: at ω = K' motor {motor:.1}, table {table:.1} of 100000", S::NAME);
    // Both gains are 1/√2; the hold over a tick changes them by at most ωh = 2π/2000.
    for amplitude in [motor, table] {
        assert!((amplitude / 100_000.0 * SQRT_2 - 1.0).abs() < TAU / 2000.0, "{} {motor} {table}", S::NAME);
    }
    // With equal motions of motor and table the gain is 1.
    let sum = feedback_amplitude::<S>(100_000.0, 100_000.0);
    assert!((sum - 100_000.0).abs() < 0.1, "{sum}");
}

#[test]
fn the_crossover_of_motor_and_table_is_at_k_prime() {
    crosses_over::<Fixed>();
    crosses_over::<f32>();
    crosses_over::<f64>();
}

/// Phase from the samples of a transducer: 16-bit converters, an amplitude of 30,000 counts.
#[expect(clippy::cast_possible_truncation, reason = "at most 30,000")]
fn samples(position: Position, pitch_m: f64) -> Phase {
    let (sine, cosine) = (TAU * position.to_m() / pitch_m).sin_cos();
    let counts = |value: f64| (30_000.0 * value).round() as i32;
    Phase::from_samples(counts(sine), counts(cosine), 15_000).unwrap()
}

#[test]
fn a_step_with_sampled_resolver_and_scale_matches_its_closed_form() {
    // A resolver of three pole pairs on a lead of 10 mm, a scale with a period of 2 mm, and a step of 10 µm.
    let (lead, pitch, times) = (0.01, 0.002, (0.03, 0.08));
    let mut resolver = Transducer::new(lead, 3, samples(Position(0), lead / 3.0)).unwrap();
    let mut scale = Transducer::new(pitch, 1, samples(Position(0), pitch)).unwrap();
    let mut loops = Positions::<Fixed>::new(TICK_S, times.1);
    let gain = <Fixed as Scalar>::gain(fraction(TICK_S, times.0));
    let mut motor = Position(0);
    let mut error = 0.0f64;
    for k in 0..20_000 {
        let table = motor - units(STEP_NM);
        let exact = STEP_NM * after_step(times, f64::from(k) * TICK_S);
        error = error.max((table.0 as f64 / NM - exact).abs());
        let read = [resolver.read(samples(motor, lead / 3.0)), scale.read(samples(table, pitch))];
        let first = loops.detect(Position(0), read[0], read[1]);
        motor += scaled::<Fixed>(first, gain);
    }
    // Half a count of rounding in sine and cosine, √½ of 30,000, is 3.75e-6 of a cycle: 12.5 nm for the resolver, which
    // enters at most twice (directly and in the difference), and 7.5 nm for the scale.
    let converters = 2.0 * 12.5 + 7.5;
    println!("with 16-bit converters: within {error:.2} nm");
    let held = STEP_NM * TICK_S / times.1;
    assert!(error < converters + held + 0.3 && error > 0.1 * converters, "{error}");
}
