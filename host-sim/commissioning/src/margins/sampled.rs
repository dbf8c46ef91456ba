//! A linear sampled system with one input and one output: x ← A·x + b·u, y = c·x.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, DMatrix, DVector, RowDVector, Schur};

/// A sampled system; its output does not depend on the input of the same sample.
#[derive(Clone, Debug)]
pub struct Sampled {
    a: DMatrix<f64>,
    b: DVector<f64>,
    c: RowDVector<f64>,
}

impl Sampled {
    /// The system with a linear step function of state and input, which returns the next state and the output. The columns of
    /// A, b and c are its values for unit vectors.
    #[must_use]
    pub fn of(states: usize, step: impl Fn(&[f64], f64) -> (Vec<f64>, f64)) -> Self {
        let (mut a, mut c) = (DMatrix::zeros(states, states), RowDVector::zeros(states));
        for i in 0..states {
            let mut unit = vec![0.0; states];
            unit[i] = 1.0;
            let (next, output) = step(&unit, 0.0);
            a.set_column(i, &DVector::from_vec(next));
            c[i] = output;
        }
        let (next, _) = step(&vec![0.0; states], 1.0);
        Self { a, b: DVector::from_vec(next), c }
    }

    /// y/u at the angle θ = ω·T of z = e^(jθ): c·(z − A)⁻¹·b; `None` at a pole.
    #[must_use]
    pub fn response(&self, angle: f64) -> Option<Complex<f64>> {
        let z = Complex::from_polar(1.0, angle);
        let mut matrix = self.a.map(|value| Complex::from(-value));
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += z;
        }
        let state = matrix.lu().solve(&self.b.map(Complex::from))?;
        Some(self.c.iter().zip(state.iter()).map(|(c, x)| x * *c).sum())
    }

    /// Eigenvalues of A.
    #[must_use]
    pub fn poles(&self) -> Vec<Complex<f64>> {
        eigenvalues(&self.a)
    }

    /// Eigenvalues of the closed loop u = −y.
    #[must_use]
    pub fn closed_loop_poles(&self) -> Vec<Complex<f64>> {
        eigenvalues(&(&self.a - &self.b * &self.c))
    }
}

/// Eigenvalues of a matrix. The states have units from metres to newtons: the matrix is balanced first. If the iteration does not
/// converge at a tolerance, a larger one is tried; an infinite eigenvalue, of an unstable system, stands for a matrix without any.
fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    const TOLERANCES: [f64; 3] = [f64::EPSILON, 1e-13, 1e-11];
    const MAX_ITERATIONS: usize = 1000;
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let schur =
        TOLERANCES.iter().find_map(|tolerance| Schur::try_new(balanced.clone(), *tolerance, MAX_ITERATIONS));
    schur.map_or_else(
        || vec![Complex::new(f64::INFINITY, 0.0)],
        |schur| schur.complex_eigenvalues().iter().copied().collect(),
    )
}
