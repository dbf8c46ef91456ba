//! The smallest slope of a position over a position that is an effect.

/// A temperature difference of 0.05 K changes the length of steel by 0.5 µm/m.
pub const LEAST_SLOPE_UM_PER_M: f64 = 0.5;
