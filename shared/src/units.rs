//! Machine units and their conversion to SI.
//!
//! | quantity | machine unit | why |
//! |---|---|---|
//! | position | [`Position`]: i64, 2⁻²⁰ nm | exact on ±8,796 km·10⁻³; a difference is exact anywhere on the travel |
//! | error, distance | 1.024 µm = 2³⁰ position units | a fixed-point signal then resolves 1/16 nm and holds ±134 mm |
//! | increment per tick | 16 nm = 2²⁴ position units | resolves 2⁻¹⁰ nm, holds ±2.1 mm a tick |
//! | velocity | 16.384 µm/s | resolves 1 nm/s, holds ±2.147 m/s |
//! | position as a signal | 1.05 mm = 2⁴⁰ position units | resolves 64 nm, holds ±137 m |
//! | force | 1 N | resolves 61 µN, holds ±131 kN |
//!
//! Resolution and range are those of the fixed-point signal ([`crate::scalar::Fixed`]).
//! On a rotary axis read 1 µdeg for 1 nm (hence 1 deg for 1 mm) and N·m for N.

use core::ops::{Add, AddAssign, Sub};

/// Position units in one nanometre.
pub const PER_NM: i64 = 1 << 20;

/// Position units in one metre.
pub const PER_M: f64 = 1e9 * PER_NM as f64;

/// Metres per second in one velocity unit.
pub const VELOCITY_M_PER_S: f64 = 16.384e-6;

/// Metres in one unit of a per-tick increment.
pub const INCREMENT_M: f64 = 16e-9;

/// Metres in one unit of error or distance.
pub const LENGTH_M: f64 = 1.024e-6;

/// Metres in one unit of a position as a signal, 2⁴⁰ position units.
pub const SCALED_POSITION_M: f64 = 1024.0 * LENGTH_M;

/// Greatest magnitude of an accepted position, m. Far inside the range of i64, so that sums and squares of differences
/// are exact.
pub const TRAVEL_LIMIT_M: f64 = 100.0;

/// A position on an axis in units of 2⁻²⁰ nm, in every number format.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct Position(pub i64);

impl Position {
    /// The position nearest to a value in metres; `None` beyond ±[`TRAVEL_LIMIT_M`] or for a NaN.
    #[must_use]
    pub fn from_m(m: f64) -> Option<Self> {
        // The comparison is false for a NaN.
        (m.abs() <= TRAVEL_LIMIT_M).then(|| {
            #[expect(clippy::cast_possible_truncation, reason = "within the travel limit")]
            Self(libm::rint(m * PER_M) as i64)
        })
    }

    /// The position in metres, to double precision.
    #[must_use]
    pub fn to_m(self) -> f64 {
        self.0 as f64 / PER_M
    }
}

/// The distance from `other` to this position, position units: exact (wraps at ±2⁶³, far outside the travel).
impl Sub for Position {
    type Output = i64;

    fn sub(self, other: Self) -> i64 {
        self.0.wrapping_sub(other.0)
    }
}

/// The position `distance` position units further on.
impl Add<i64> for Position {
    type Output = Self;

    fn add(self, distance: i64) -> Self {
        Self(self.0.wrapping_add(distance))
    }
}

/// The position `distance` position units further back.
impl Sub<i64> for Position {
    type Output = Self;

    fn sub(self, distance: i64) -> Self {
        Self(self.0.wrapping_sub(distance))
    }
}

impl AddAssign<i64> for Position {
    fn add_assign(&mut self, distance: i64) {
        *self = *self + distance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_metre_and_a_picometre_add_exactly() {
        // 1 m + 1 pm is 1.048576e15 + 1048.6 units. f32 would round the sum by up to 60 nm.
        let metre = Position::from_m(1.0).unwrap();
        let further = metre + 1049;
        assert_eq!(further - metre, 1049);
        assert_eq!(metre.0, 1_048_576_000_000_000);
    }

    #[test]
    fn positions_out_of_range_are_rejected() {
        for m in [f64::NAN, f64::INFINITY, 100.1, -100.1] {
            assert_eq!(Position::from_m(m), None);
        }
    }
}
