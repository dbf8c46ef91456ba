//! The position loop: velocity command = Kp·(following error + lead), or behind the filter of [`super::hpc`].
//!
//! # Example
//!
//! An error of 1 mm with Kp = 33 /s commands 33 mm/s.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates};
//! use shared::control::position::State;
//! use shared::scalar::Scalar;
//! use shared::units::{Position, VELOCITY_M_PER_S};
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let settings = AxisSettings { position_gain_per_s: 33.0, ..AxisSettings::default() };
//! let axis = AxisConfig::<f64>::new(&settings, rates).unwrap();
//! let error = f64::from_distance(Position::from_m(1e-3).unwrap().0);
//! let velocity = axis.position.velocity(&mut State::default(), error);
//! assert!((velocity * VELOCITY_M_PER_S - 33e-3).abs() < 1e-12);
//! ```

use super::hpc::{self, Hpc};
use crate::scalar::Scalar;

/// Constants of the position loop.
#[derive(Clone, Copy, Debug)]
pub struct PositionControl<S: Scalar> {
    /// Kp, velocity units per error unit.
    pub gain: S::Gain,
    /// Filter of high-order position control; `None`: P control.
    pub hpc: Option<Hpc<S>>,
}

/// State of the position loop.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    hpc: hpc::State<S>,
    /// The last input of the gain Kp.
    filtered: S,
}

impl<S: Scalar> State<S> {
    /// At an error of zero.
    pub const AT_REST: Self = Self { hpc: hpc::State::AT_REST, filtered: S::ZERO };

    /// Settles the HPC filter at the last error of a loop that did not use it.
    pub fn settle_filter(&mut self) {
        self.hpc = hpc::State::settled(self.filtered);
    }
}

impl<S: Scalar> PositionControl<S> {
    /// The velocity command for an error, once per position tick.
    pub fn velocity(&self, state: &mut State<S>, error: S) -> S {
        state.filtered = match &self.hpc {
            Some(hpc) => hpc.filter(&mut state.hpc, error),
            None => error,
        };
        S::round(state.filtered * self.gain)
    }
}
