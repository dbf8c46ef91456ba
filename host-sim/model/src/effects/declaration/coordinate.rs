//! The variables of an effect that are fitted.

/// A variable of the fit.
///
/// Coordinates may differ from the reported parameters: a harmonic is fitted by its sine and cosine coefficients, in
/// which the model is linear, and reported as amplitude and phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// Value in the unit of the effect's file entry, unless the effect documents another one.
    pub value: f64,
    /// Step of the finite difference: small compared with the nonlinearity of the effect, large compared with rounding.
    pub step: f64,
    /// Lower bound of the next step of the fit.
    pub lower: f64,
    /// Upper bound of the next step of the fit.
    pub upper: f64,
    /// Limits of the search range. A fit that ends at a limit has not determined the value. Infinite if the bound is
    /// exact (an amplitude of zero) or holds for one step only.
    pub limits: [f64; 2],
}

impl Coordinate {
    /// A coordinate of either sign, between −limit and limit.
    #[must_use]
    pub const fn signed(value: f64, step: f64, limit: f64) -> Self {
        Self { value, step, lower: -limit, upper: limit, limits: [-limit, limit] }
    }

    /// A positive coordinate between two bounds that may differ by orders of magnitude. As the model is nonlinear in
    /// the coordinate, one step of the fit changes it by a factor of at most three.
    #[must_use]
    pub fn scale(value: f64, lower: f64, upper: f64) -> Self {
        let [lowest, highest] = [value / 3.0, 3.0 * value].map(|bound| bound.clamp(lower, upper));
        Self { value, step: 0.02 * value, lower: lowest, upper: highest, limits: [lower, upper] }
    }

    /// A coordinate between two bounds. Both are limits of the search, except for a lower bound of zero, which is exact.
    #[must_use]
    pub const fn between(value: f64, step: f64, lower: f64, upper: f64) -> Self {
        let lowest = if lower == 0.0 { f64::NEG_INFINITY } else { lower };
        Self { value, step, lower, upper, limits: [lowest, upper] }
    }

    /// This coordinate with bounds that hold for one step only and are no limits of the search.
    #[must_use]
    pub const fn stepwise(self) -> Self {
        Self { limits: [f64::NEG_INFINITY, f64::INFINITY], ..self }
    }

    /// The limit of the search that the value has reached, if any. A limit counts as reached within 0.1 %, as a
    /// truncated step may miss it by a rounding error.
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
