//! A motor that follows its command whatever acts on it.
//!
//! A stepper motor has no loop that could be simulated, and neither has an axis of which nothing is known. Any loop in its place would be
//! late, and run its circles too large or too small and beyond its stops. Its mass is infinite: no force of the table changes its
//! motion. The force of its controller is the change of velocity that the controller wants, times the gain of the velocity loop, and the
//! velocity changes by it at once. With the position gain 1/T of a loop of the period T the motor is then, one period later, exactly
//! where its command is.

use super::axis_motion::AxisMotion;
use model::machine::Axis;

/// Mass that takes the place of an infinite one in a step, kg: a table of 1 kg that oscillates with 100 m/s² moves it by less than
/// 1e-4 m/s², 0.1 nm over a millisecond.
pub const HEAVIEST_KG: f64 = 1e6;

/// The motor of an axis of infinite mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    velocity_gain_n_s_per_m: f64,
}

impl Following {
    /// The motor of an axis; `None`: it has a mass, or no loop.
    #[must_use]
    pub fn of(axis: &Axis) -> Option<Self> {
        let is_infinite = axis.settings.mechanics.motor_mass_kg.is_some_and(f64::is_infinite);
        let velocity_gain_n_s_per_m = axis.settings.controller.velocity_gain_n_s_per_m?;
        is_infinite.then_some(Self { velocity_gain_n_s_per_m })
    }

    /// Changes the velocity by what a force (N) stands for.
    pub fn drive(self, motion: &mut AxisMotion, force_n: f64) {
        motion.motor_m_per_s += force_n / self.velocity_gain_n_s_per_m;
    }
}
