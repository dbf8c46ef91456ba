//! Forces on the table that do not depend on its motion.

use model::effects::{ConstantLoad, Gravity, PositionLoad};

/// Forces on the table against motion in the + direction that do not depend on its velocity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Load {
    /// Constant force.
    pub constant: ConstantLoad,
    /// Force that grows along the travel.
    pub position: Option<PositionLoad>,
    /// Torque of gravity on a rotary axis.
    pub gravity: Option<Gravity>,
}

impl Load {
    /// The sum at a position of the table (m), N.
    #[must_use]
    #[inline]
    pub fn force_n(&self, position_m: f64) -> f64 {
        self.constant.force_n + self.varying_n(position_m)
    }

    /// The part that depends on the position of the table (m), N.
    #[must_use]
    #[inline]
    pub fn varying_n(&self, position_m: f64) -> f64 {
        let along = self.position.as_ref().map_or(0.0, |load| load.force_n(position_m));
        along + self.gravity.as_ref().map_or(0.0, |gravity| gravity.force_n(position_m))
    }

    /// Whether [`Self::varying_n`] is anywhere not zero.
    #[must_use]
    pub const fn varies(&self) -> bool {
        self.position.is_some() || self.gravity.is_some()
    }
}
