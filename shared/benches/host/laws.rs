//! Steps of single control laws, compared with the biquad of `idsp` in the same number format.
//!
//! The PI law is compared with a biquad of `idsp` configured as PI: a gain, an integral part and a limit with anti-windup.
//! The law of `shared` also computes the velocity from two positions.

use std::hint::black_box;

use dsp_fixedpoint::Q32;
use dsp_process::SplitProcess;
use idsp::iir::coefficients::Filter;
use idsp::iir::{Biquad, BiquadClamp, DirectForm1};
use shared::axis::Reading;
use shared::config::{AxisConfig, AxisSettings, Law, Rates, ScaleLimits, Sensors};
use shared::control::{feedforward, filter, position, velocity};
use shared::feedback::dual;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

use crate::compared::Compared;

/// Steps per call: enough that the time of a clock reading is negligible, few enough that the data fit the L1 cache.
const STEPS: u32 = 1024;

const RATE_HZ: f64 = 20_000.0;

/// A slow sine of 20 µm plus a fast one of 2 µm, so that the processor cannot learn the sequence of branches.
fn signal(k: u32) -> f64 {
    let t = f64::from(k) / f64::from(STEPS) * core::f64::consts::TAU;
    20.0 * (3.0 * t).sin() + 2.0 * (101.0 * t).sin()
}

fn inputs<T>(of: impl Fn(f64) -> T) -> Vec<T> {
    (0..STEPS).map(|k| of(signal(k))).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "22 µm")]
fn position_um(um: f64) -> Position {
    Position((um * 1e3 * PER_NM as f64) as i64)
}

fn config<S: Scalar>(law: Law) -> AxisConfig<S> {
    let settings = AxisSettings {
        law,
        feedforward_percent: 80.0,
        velocity_lag_s: 0.5 / RATE_HZ,
        sensors: Sensors::Dual { time_constant_s: 0.05, limits: ScaleLimits::DEFAULT },
        ..AxisSettings::default()
    };
    AxisConfig::new(&settings, Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 }).unwrap()
}

/// One step per input, with the state behind a pointer as in a tick; `name` and `peer` as in [`Compared::row`].
fn steps<T: Copy, S, R>(
    compared: &mut Compared,
    (name, peer): (&str, &str),
    inputs: &[T],
    mut state: S,
    step: impl Fn(&mut S, T) -> R,
) {
    compared.row(name, peer, STEPS, || {
        for &input in inputs {
            black_box(step(black_box(&mut state), input));
        }
    });
}

/// The laws in the format `S`, each with its peer of `idsp` in the same format.
fn ours<S: Scalar>(compared: &mut Compared) {
    let errors = inputs(S::signal);
    let positions = inputs(position_um);
    let readings = inputs(|um| Reading { motor: position_um(um), table: Some(position_um(um * 1.01)) });
    let (p, hpc) = black_box((config::<S>(Law::P), config::<S>(Law::Hpc)));
    let name = |law: &str| format!("{law}, {}", S::NAME);
    let (biquad, pi) = (name("idsp biquad"), name("idsp biquad as PI"));
    steps(compared, (&name("P"), &biquad), &errors, position::State::default(), |state, error| {
        p.position.velocity(state, error)
    });
    steps(compared, (&name("HPC"), &biquad), &errors, position::State::default(), |state, error| {
        hpc.position.velocity(state, error)
    });
    let low_pass = filter::Filter::<S>::low_pass(0.14, 1.4);
    steps(compared, (&name("low-pass"), &biquad), &errors, filter::State::default(), |state, error| {
        low_pass.step(state, error)
    });
    steps(compared, (&name("PI"), &pi), &positions, velocity::State::at(Position(0)), |state, motor| {
        p.velocity.force(state, S::default(), motor)
    });
    steps(
        compared,
        (&name("feed-forward"), &biquad),
        &positions,
        feedforward::State::at(Position(0)),
        |state, to| p.feedforward.lead(state, to),
    );
    steps(
        compared,
        (&name("dual feedback"), &biquad),
        &readings,
        dual::State::default(),
        |state, reading| p.feedback.position(state, reading.motor, reading.table),
    );
}

/// The biquad of `idsp` with coefficients `C` on signals `T`: a notch at 400 Hz, and PI.
fn peers<C, T>(compared: &mut Compared, format: &str, inputs: &[T], limit: T)
where
    T: Copy + Default + core::ops::Neg<Output = T>,
    C: Clone,
    [f64; 5]: Into<Biquad<C>>,
    BiquadClamp<C, T>: Default,
    DirectForm1<T>: Default,
    Biquad<C>: SplitProcess<T, T, DirectForm1<T>>,
    BiquadClamp<C, T>: SplitProcess<T, T, DirectForm1<T>>,
{
    let notch: Biquad<C> = Filter::<f64>::default().critical_frequency(400.0 / RATE_HZ).q(2.0).notch().into();
    let notch = black_box(notch);
    steps(compared, (&format!("idsp biquad, {format}"), ""), inputs, DirectForm1::default(), |state, x| {
        notch.process(state, x)
    });
    // y0 = y1 + b0·x0 + b1·x1
    let pi = BiquadClamp::<C, T>::from([[1.003, -1.0, 0.0], [1.0, -1.0, 0.0]]);
    let pi = black_box(BiquadClamp { min: -limit, max: limit, ..pi });
    steps(
        compared,
        (&format!("idsp biquad as PI, {format}"), ""),
        inputs,
        DirectForm1::default(),
        |state, x| pi.process(state, x),
    );
}

pub fn measure(compared: &mut Compared) {
    let fixed: Vec<i32> = inputs(|x| Fixed::signal(x).to_bits());
    peers::<Q32<29>, i32>(compared, Fixed::NAME, &fixed, 1 << 26);
    ours::<Fixed>(compared);
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32")]
    peers::<f32, f32>(compared, f32::NAME, &inputs(|x| x as f32), 4096.0);
    ours::<f32>(compared);
    peers::<f64, f64>(compared, f64::NAME, &inputs(|x| x), 4096.0);
    ours::<f64>(compared);
}
