//! The position loop: error in, velocity command out.
//!
//! # Example
//!
//! An error of 1 mm, Kp = 33 /s: 33 mm/s.
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

/// P, or P behind the filter of [`Hpc`].
#[derive(Clone, Copy, Debug)]
pub struct PositionControl<S: Scalar> {
    /// Kp, in velocity units per error unit.
    pub gain: S::Gain,
    /// The filter of high-order position control.
    pub hpc: Option<Hpc<S>>,
}

/// What the position loop remembers.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<S: Scalar> {
    hpc: hpc::State<S>,
    /// What was multiplied by Kp last.
    filtered: S,
}

impl<S: Scalar> State<S> {
    /// No error so far.
    pub const AT_REST: Self = Self { hpc: hpc::State::AT_REST, filtered: S::ZERO };

    /// Lets a filter that was not used so far start from where the loop is.
    pub fn settle(&mut self) {
        self.hpc = hpc::State::settled(self.filtered);
    }
}

impl<S: Scalar> PositionControl<S> {
    /// Velocity command for an error.
    pub fn velocity(&self, state: &mut State<S>, error: S) -> S {
        state.filtered = match &self.hpc {
            Some(hpc) => hpc.filter(&mut state.hpc, error),
            None => error,
        };
        S::round(state.filtered * self.gain)
    }
}
