//! Linear least squares, and the ellipse fit of equations (7) and (8).

use nalgebra::{DMatrix, DVector};

use crate::reproduce::study::ReproduceError;

/// A least-squares solution.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearFit {
    /// One coefficient per column.
    pub coefficients: Vec<f64>,
    /// Standard error of each coefficient, from the residuals of the fit.
    pub standard_errors: Vec<f64>,
}

/// Linear least squares by the normal equations. The columns must be of similar magnitude and not nearly parallel.
///
/// # Errors
/// If the columns are linearly dependent.
pub fn linear_fit(columns: &[&[f64]], right: &[f64]) -> Result<LinearFit, ReproduceError> {
    let design = DMatrix::from_fn(right.len(), columns.len(), |row, column| columns[column][row]);
    let right = DVector::from_row_slice(right);
    let dependent = || ReproduceError::Numerics("least squares: the columns are not independent".to_owned());
    let normal = design.tr_mul(&design).cholesky().ok_or_else(dependent)?;
    let solution = normal.solve(&design.tr_mul(&right));
    let variance =
        (&design * &solution - &right).norm_squared() / (right.len() as f64 - columns.len() as f64);
    let errors = normal.inverse().diagonal().map(|diagonal| (variance * diagonal).sqrt());
    Ok(LinearFit {
        coefficients: solution.iter().copied().collect(),
        standard_errors: errors.iter().copied().collect(),
    })
}

/// Half axes A, B, m, of the upright ellipse x²/A² + y²/B² = 1 through points: least squares in 1/A², 1/B² and the
/// two linear terms of an offset centre. Points and half axes are scaled by `radius_m`.
///
/// # Errors
/// If the points do not lie on an ellipse.
pub fn ellipse_half_axes_m(points: &[[f64; 2]], radius_m: f64) -> Result<[f64; 2], ReproduceError> {
    // In units of the radius, so that all four unknowns are of order 1.
    let column = |term: fn(f64, f64) -> f64| -> Vec<f64> {
        points.iter().map(|[x, y]| term(x / radius_m, y / radius_m)).collect()
    };
    let columns = [column(|x, _| x * x), column(|_, y| y * y), column(|x, _| x), column(|_, y| y)];
    let conic = linear_fit(&columns.each_ref().map(Vec::as_slice), &vec![1.0; points.len()])?.coefficients;
    let (a, b) = (conic[0], conic[1]);
    // Completed square: a·x² + c·x = a·(x + c/2a)² − c²/4a.
    let right_side = 1.0 + conic[2].powi(2) / (4.0 * a) + conic[3].powi(2) / (4.0 * b);
    if a > 0.0 && b > 0.0 {
        Ok([a, b].map(|coefficient| radius_m * (right_side / coefficient).sqrt()))
    } else {
        Err(ReproduceError::Numerics("the points lie on no ellipse".to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// An upright ellipse, a few µm from a circle and off centre: the fit returns its half axes.
    #[test]
    fn the_half_axes_of_an_ellipse_are_recovered() {
        let (a, b, x0, y0) = (2.003e-3, 1.996e-3, 4e-6, -7e-6);
        let at = |i: u32| TAU * f64::from(i) / 100.0;
        let points: Vec<[f64; 2]> = (0..100).map(|i| [x0 + a * at(i).cos(), y0 + b * at(i).sin()]).collect();
        let [found_a, found_b] = ellipse_half_axes_m(&points, 2e-3).unwrap();
        assert!((found_a - a).abs() < 1e-12 && (found_b - b).abs() < 1e-12, "{found_a} {found_b}");
        // A hyperbola is rejected.
        let open: Vec<[f64; 2]> = (0..100).map(|i| [1e-3 * at(i).cosh(), 1e-3 * at(i).sinh()]).collect();
        assert!(ellipse_half_axes_m(&open, 2e-3).is_err());
    }
}
