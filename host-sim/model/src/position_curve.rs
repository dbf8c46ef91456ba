//! A quantity over position, given at knots: a natural cubic spline between them.

/// A natural cubic spline: it goes through all knots, its second derivative is continuous, and zero at both ends.
/// Beyond the ends the value is that of the end. The value at any position is linear in the values at the knots.
///
/// The second derivatives M at the knots solve, with h the distances and y the values (Stoer and Bulirsch, Introduction
/// to Numerical Analysis, 2.4.2),
///
/// ```text
/// h₀·M₀ + 2·(h₀ + h₁)·M₁ + h₁·M₂ = 6·((y₂ − y₁)/h₁ − (y₁ − y₀)/h₀).
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PositionCurve {
    positions: Vec<f64>,
    values: Vec<f64>,
    second_derivatives: Vec<f64>,
}

impl PositionCurve {
    /// The curve through values at positions, which increase. Values beyond the shorter of both lists are left out.
    #[must_use]
    pub fn new(positions: &[f64], values: &[f64]) -> Self {
        let count = positions.len().min(values.len());
        let (positions, values) = (positions[..count].to_vec(), values[..count].to_vec());
        let second_derivatives = second_derivatives(&positions, &values);
        Self { positions, values, second_derivatives }
    }

    /// The curve over metres through values at positions in mm, all values times `unit`.
    #[must_use]
    pub fn over_mm(positions_mm: &[f64], values: &[f64], unit: f64) -> Self {
        let scaled = |list: &[f64], unit: f64| list.iter().map(|value| unit * value).collect::<Vec<_>>();
        Self::new(&scaled(positions_mm, 1e-3), &scaled(values, unit))
    }

    /// Whether there is no knot; the value is then zero everywhere.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The positions of the first and the last knot; `None` if there is none.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        Some([*self.positions.first()?, *self.positions.last()?])
    }

    /// The value at a position.
    #[must_use]
    #[inline]
    pub fn value(&self, position: f64) -> f64 {
        let count = self.positions.len();
        let after = self.positions.partition_point(|&knot| knot <= position);
        if after == 0 || after == count {
            return self.values.get(after.saturating_sub(1)).copied().unwrap_or(0.0);
        }
        let [left, right] = [after - 1, after].map(|knot| self.positions[knot]);
        let width = right - left;
        let (a, b) = ((right - position) / width, (position - left) / width);
        let cubic = |share: f64| share * (share * share - 1.0);
        a * self.values[after - 1]
            + b * self.values[after]
            + (cubic(a) * self.second_derivatives[after - 1] + cubic(b) * self.second_derivatives[after])
                * (width * width / 6.0)
    }
}

/// Solves the tridiagonal equations by elimination; the matrix is diagonally dominant.
fn second_derivatives(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mut result = vec![0.0; n];
    // Of each row after the elimination: M of the row = right − factor·M of the next row.
    let (mut factors, mut rights) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n.saturating_sub(1) {
        let [before, after] = [x[i] - x[i - 1], x[i + 1] - x[i]];
        let bend = 6.0 * ((y[i + 1] - y[i]) / after - (y[i] - y[i - 1]) / before);
        let pivot = 2.0 * (before + after) - before * factors[i - 1];
        factors[i] = after / pivot;
        rights[i] = (bend - before * rights[i - 1]) / pivot;
    }
    for i in (1..n.saturating_sub(1)).rev() {
        result[i] = rights[i] - factors[i] * result[i + 1];
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_goes_through_its_knots_and_is_constant_beyond_them() {
        let (positions, values) = ([0.0, 1.0, 3.0, 4.0], [1.0, -2.0, 5.0, 0.5]);
        let curve = PositionCurve::new(&positions, &values);
        for (position, value) in positions.iter().zip(values) {
            assert!((curve.value(*position) - value).abs() < 1e-12);
        }
        assert!((curve.value(-7.0) - 1.0).abs() < 1e-12 && (curve.value(9.0) - 0.5).abs() < 1e-12);
        assert!(PositionCurve::default().is_empty() && PositionCurve::default().value(1.0).abs() < 1e-12);
    }

    /// The natural spline through 0, 1, 0 at distances of one: M₁ = 6·(−1 − 1)/4 = −3, so that the value at one half is
    /// ½ + 3/6·(½ − ⅛) = 0.6875.
    #[test]
    fn between_knots_the_curve_is_the_natural_spline() {
        let curve = PositionCurve::new(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]);
        assert!((curve.value(0.5) - 0.6875).abs() < 1e-12 && (curve.value(1.5) - 0.6875).abs() < 1e-12);
        // A straight line has no second derivative.
        let line = PositionCurve::new(&[0.0, 0.7, 2.0, 5.0], &[0.0, 1.4, 4.0, 10.0]);
        assert!((line.value(3.1) - 6.2).abs() < 1e-12);
    }

    /// A sine with eight knots per period: the error of a cubic spline is at most 5/384·h⁴·max|y⁗| = 5/384·(2π/8)⁴ =
    /// 0.005 away from the ends.
    #[test]
    fn a_smooth_function_is_followed_to_the_fourth_order() {
        let positions: Vec<f64> = (0..=24).map(f64::from).collect();
        let sine = |x: f64| (std::f64::consts::TAU * x / 8.0).sin();
        let values: Vec<f64> = positions.iter().map(|&x| sine(x)).collect();
        let curve = PositionCurve::new(&positions, &values);
        let errors = (40..200).map(|i| f64::from(i) * 0.1).map(|x| (curve.value(x) - sine(x)).abs());
        let max = errors.fold(0.0, f64::max);
        assert!(max < 0.005 && max > 1e-4, "{max}");
    }
}
