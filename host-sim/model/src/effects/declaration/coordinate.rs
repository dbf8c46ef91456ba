//! The numbers of an effect that a fit moves.

/// One of the numbers that an optimiser may move.
///
/// A coordinate need not be a reported parameter: a harmonic is fitted as its cosine and sine parts, in which the model
/// is linear, and reported as amplitude and phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// The value, in the unit of the effect's file entry.
    pub value: f64,
    /// A change that is small beside what the effect does and large beside rounding.
    pub step: f64,
    /// Smallest value that has a meaning.
    pub lower: f64,
    /// Largest value that has a meaning.
    pub upper: f64,
    /// Ends of the range that is searched. A fit that ends at one of them was stopped there and has measured
    /// nothing. Infinite where a bound is exact (a size of zero) or holds for one step only.
    pub limits: [f64; 2],
}

impl Coordinate {
    /// A coordinate that may take any sign.
    #[must_use]
    pub const fn signed(value: f64, step: f64, limit: f64) -> Self {
        Self { value, step, lower: -limit, upper: limit, limits: [-limit, limit] }
    }

    /// A positive coordinate of any size within two bounds. One step of a fit changes it by a factor of three at the
    /// most: the model is far from linear in it.
    #[must_use]
    pub fn scale(value: f64, lower: f64, upper: f64) -> Self {
        let [lowest, highest] = [value / 3.0, 3.0 * value].map(|bound| bound.clamp(lower, upper));
        Self { value, step: 0.02 * value, lower: lowest, upper: highest, limits: [lower, upper] }
    }

    /// A coordinate between two bounds. Both are limits of the search, except a lower bound of zero, which is exact.
    #[must_use]
    pub const fn between(value: f64, step: f64, lower: f64, upper: f64) -> Self {
        let lowest = if lower == 0.0 { f64::NEG_INFINITY } else { lower };
        Self { value, step, lower, upper, limits: [lowest, upper] }
    }

    /// The same with bounds that hold for one step only: the next step may go on from there.
    #[must_use]
    pub const fn stepwise(self) -> Self {
        Self { limits: [f64::NEG_INFINITY, f64::INFINITY], ..self }
    }

    /// The limit of the search that the value has reached, if it has one. A step that is cut off there ends within
    /// rounding of it; the last per mille counts as reached.
    #[must_use]
    pub fn limit(&self) -> Option<f64> {
        const NEAR: f64 = 1e-3;
        let [lowest, highest] = self.limits;
        let is_at = |limit: f64, excess: f64| limit.is_finite() && excess >= -NEAR * limit.abs();
        if is_at(highest, self.value - highest) {
            return Some(highest);
        }
        is_at(lowest, lowest - self.value).then_some(lowest)
    }
}
