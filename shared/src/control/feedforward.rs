//! Velocity feed-forward: the position loop follows command + (Kf/Kp)·d(command)/dt.
//!
//! At constant speed v the following error is (1 − Kf)·v/Kp: zero with Kf = 100 %. The derivative is the backward
//! difference of the command, exact in position units. It is one tick late, and drive and velocity reading delay it further:
//! with a time T ahead, d(command)/dt + T·d²(command)/dt² takes its place.
//!
//! # Example
//!
//! At 100 mm/s, Kf = 50 % and Kp = 33 /s the lead is 0.5·(100 mm/s)/(33 /s) = 1.515 mm.
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, Rates};
//! use shared::control::feedforward::State;
//! use shared::units::{LENGTH_M, Position};
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 1 };
//! let settings =
//!     AxisSettings { position_gain_per_s: 33.0, feedforward_percent: 50.0, ..AxisSettings::default() };
//! let axis = AxisConfig::<f64>::new(&settings, rates).unwrap();
//! let mut state = State::at(Position(0));
//! let next = Position::from_m(0.1 / 20_000.0).unwrap();
//! let lead_m = axis.feedforward.lead(&mut state, next) * LENGTH_M;
//! assert!((lead_m - 0.5 * 0.1 / 33.0).abs() < 1e-12);
//! ```

use crate::scalar::Scalar;
use crate::units::Position;

/// Constants of the feed-forward.
#[derive(Clone, Copy, Debug)]
pub struct Feedforward<S: Scalar> {
    /// Factor of the present increment, (Kf/Kp)/tick·(1 + T/tick), error units per increment unit.
    pub present: S::Gain,
    /// Factor of the previous increment, which is subtracted, (Kf/Kp)/tick·T/tick; `None`: T is 0.
    pub previous: Option<S::Gain>,
}

/// The previous command, and its increment in increment units.
#[derive(Clone, Copy, Debug)]
pub struct State<S> {
    last: Position,
    last_increment: S,
}

impl<S: Scalar> State<S> {
    /// At rest at a command.
    #[must_use]
    pub const fn at(command: Position) -> Self {
        Self { last: command, last_increment: S::ZERO }
    }

    /// The feed-forward where a correction (position units) is already added to the command.
    #[must_use]
    pub const fn corrected(self, correction: i64) -> Self {
        Self { last: Position(self.last.0.wrapping_add(correction)), ..self }
    }

    /// The last command.
    #[must_use]
    pub const fn command(&self) -> Position {
        self.last
    }

    /// The last change of the command, increment units.
    #[must_use]
    pub const fn increment(&self) -> S {
        self.last_increment
    }
}

impl<S: Scalar> Feedforward<S> {
    /// The lead (Kf/Kp)·d(command)/dt to add to the following error, error units.
    pub fn lead(&self, state: &mut State<S>, command: Position) -> S {
        let increment = S::from_increment(command - state.last);
        let mut lead = increment * self.present;
        if let Some(previous) = self.previous {
            lead = lead - state.last_increment * previous;
        }
        (state.last, state.last_increment) = (command, increment);
        S::round(lead)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{AxisConfig, AxisSettings, Rates};
    use crate::scalar::Fixed;
    use crate::units::LENGTH_M;

    /// Largest error of the lead, m, at 1 kHz, 2 m/s², Kp = 50 /s, Kf = 100 % and 1.25 ms ahead: (v(t − T/2) + 1.25 ms·a)/Kp.
    fn worst_m<S: Scalar>() -> f64 {
        let rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: 4 };
        let settings = AxisSettings {
            position_gain_per_s: 50.0,
            feedforward_percent: 100.0,
            feedforward_ahead_s: 1.25e-3,
            ..AxisSettings::default()
        };
        let axis = AxisConfig::<S>::new(&settings, rates).unwrap();
        let at_m = |k: i32| (1e-3 * f64::from(k)).powi(2);
        let mut state = State::at(Position(0));
        let leads = (1..200).map(|k| {
            let lead = axis.feedforward.lead(&mut state, Position::from_m(at_m(k)).unwrap());
            let velocity = (at_m(k) - at_m(k - 1)) / 1e-3;
            // In the first tick the acceleration has only begun.
            let acceleration = if k == 1 { 1.0 } else { 2.0 };
            (lead.value() * LENGTH_M - (velocity + 1.25e-3 * acceleration) / 50.0).abs()
        });
        leads.fold(0.0, f64::max)
    }

    #[test]
    fn the_feedforward_is_ahead_by_its_time() {
        // The lead reaches 8 mm. Rounding: 0.2 nm per increment unit times 1.25, and an error unit in f32.
        assert!(worst_m::<f64>() < 1e-12, "{}", worst_m::<f64>());
        assert!(worst_m::<Fixed>() < 2e-7, "{}", worst_m::<Fixed>());
        assert!(worst_m::<f32>() < 2e-7, "{}", worst_m::<f32>());
    }
}
