//! The dual feedback system of the appendix: [`shared::feedback::dual`] with an ideal motor.
//!
//! The motor's velocity is K = 1/T times the output of phase detector 1. Held over a tick h this is
//! motor += (1 − e^(−h/T))·(command − feedback). The table lags the motor by the lost motion ΔQ. The feedback is the
//! controller's own, in the number format of the chip.

use shared::feedback::dual::{Feedback, State};
use shared::feedback::exponential_decay::ExponentialDecay;
use shared::scalar::{Fixed, Scalar};
use shared::units::{PER_NM, Position};

/// Sampling time h of the loop, s.
pub const TICK_S: f64 = 1.0 / 20_000.0;

/// Ratios α = T'/T that are run.
pub const ALPHAS: [f64; 3] = [1.0 / 3.0, 1.0, 8.0 / 3.0];

/// T of all runs, s: Kp = 33 1/s.
const POSITION_S: f64 = 0.03;

/// Ticks over which a lost scale signal is faded in again; none is lost here.
const FADE_TICKS: f64 = 2000.0;

/// Time constants of the loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeConstants {
    /// T = 1/K of the position loop, s.
    pub position_s: f64,
    /// T' = 1/K' of dual feedback (phase detector 2), s.
    pub dual_s: f64,
}

impl TimeConstants {
    /// T = 0.03 s and T' = α·T.
    pub fn with_alpha(alpha: f64) -> Self {
        Self { position_s: POSITION_S, dual_s: alpha * POSITION_S }
    }
}

/// Outputs of the system at one tick, without a command.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Output {
    /// Table position Qo, nm.
    pub table_nm: f64,
    /// Output of phase detector 2, Qc = Qo − Qf, nm.
    pub detector2_nm: f64,
}

/// Gain per tick of an integrator with a time constant: 1 − e^(−h/T).
fn gain_per_tick(time_constant_s: f64) -> f64 {
    -libm::expm1(-TICK_S / time_constant_s)
}

/// In units of the controller; 0 if out of range.
fn units(nm: f64) -> i64 {
    Position::from_m(1e-9 * nm).unwrap_or_default().0
}

/// One output per tick from t = 0 on, with the lost motion (nm) as a function of time (s).
pub fn run(times: TimeConstants, ticks: u32, lost_motion_nm: impl Fn(f64) -> f64) -> Vec<Output> {
    let gain = Fixed::gain(gain_per_tick(times.position_s));
    let feedback = Feedback::<Fixed>::Dual {
        fraction: Fixed::gain(gain_per_tick(times.dual_s)),
        fade: ExponentialDecay::new(FADE_TICKS),
    };
    let (mut state, mut motor, mut shift) = (State::default(), Position(0), 0);
    let nm = |distance: i64| distance as f64 / PER_NM as f64;
    (0..ticks)
        .map(|tick| {
            let table = motor - units(lost_motion_nm(f64::from(tick) * TICK_S));
            // Before this tick's update of the shift, so that both detectors are sampled at the same time.
            let detector2_nm = nm(table - (motor + shift));
            let seen = feedback.position(&mut state, motor, Some(table));
            shift = seen - motor;
            motor += Fixed::to_distance(Fixed::from_distance(-seen.0) * gain);
            Output { table_nm: nm(table.0), detector2_nm }
        })
        .collect()
}
