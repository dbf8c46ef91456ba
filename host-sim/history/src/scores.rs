//! Values as standard normal scores, without knowing their mean and scatter beforehand.
//!
//! Each value is held against those before it: its recursive residual (R. L. Brown, J. Durbin, J. M. Evans, *J. R. Stat. Soc. B* 37,
//! 1975) over the scatter of the residuals before has Student's distribution, and the normal deviate of the same probability is its
//! score (C. P. Quesenberry, *J. Qual. Technol.* 23, 1991; D. M. Hawkins, *The Statistician* 36, 1987). Of a steady machine the scores are
//! independent and standard normal from the first on, so that limits hold that were computed for known mean and scatter.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::least_squares::Regression;

/// Residuals that must stand before the first score: with fewer, the scatter is hardly known, and a change is not seen.
const MIN_FREEDOM: usize = 3;

/// Largest magnitude of a score: beyond it, probabilities are too small for a double.
const MAX_SCORE: f64 = 8.0;

/// The score of each value; `None` while too few stand before it. `rows` are the regressors of each value: 1, and what it is known to
/// depend on.
#[must_use]
pub fn of(rows: &[Vec<f64>], values: &[f64]) -> Vec<Option<f64>> {
    let (mut squares, mut freedom) = (0.0, 0_usize);
    let mut scores = Vec::with_capacity(values.len());
    for (at, (row, value)) in rows.iter().zip(values).enumerate() {
        let before = Regression::of(&rows[..at], &values[..at]);
        let residual = before.map(|fit| (value - fit.at(row)) / (1.0 + fit.leverage(row)).sqrt());
        scores.push(residual.filter(|_| freedom >= MIN_FREEDOM).map(|residual| {
            let scatter = (squares / freedom as f64).sqrt();
            score(residual / scatter, freedom)
        }));
        if let Some(residual) = residual {
            squares += residual * residual;
            freedom += 1;
        }
    }
    scores
}

/// The normal deviate that is exceeded with the probability with which Student's t exceeds `t`.
fn score(t: f64, freedom: usize) -> f64 {
    if t.is_nan() {
        // 0/0: all values are the same.
        return 0.0;
    }
    let tail = StudentsT::new(0.0, 1.0, freedom as f64).map_or(0.5, |student| student.sf(t.abs()));
    (-Normal::standard().inverse_cdf(tail)).min(MAX_SCORE).copysign(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use numerics::noise::box_muller;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// Printed tables: t with 5 degrees of freedom exceeds 2.015 in 5 of 100, as 1.645 of a normal deviate; 4.032 in 5 of 1000: 2.576.
    #[test]
    fn scores_have_the_probability_of_their_t() {
        for (t, freedom, expected) in
            [(2.015, 5, 1.645), (4.032, 5, 2.576), (-2.015, 5, -1.645), (0.0, 5, 0.0)]
        {
            assert!((score(t, freedom) - expected).abs() < 1e-3, "{t}");
        }
    }

    /// Mean 0, variance 1 and no correlation, in seven standard errors, from the first scores on, with a slow swing that they know of.
    #[test]
    fn scores_of_a_steady_machine_are_independent_and_standard_normal() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let (runs, length) = (400_u32, 30);
        let mut all = Vec::new();
        for _ in 0..runs {
            let rows: Vec<Vec<f64>> = (0..length).map(|i| vec![1.0, (0.2 * f64::from(i)).sin()]).collect();
            let values: Vec<f64> =
                rows.iter().map(|row| 7.0 + 2.0 * row[1] + 0.3 * box_muller(&mut rng)).collect();
            all.push(of(&rows, &values).into_iter().flatten().collect::<Vec<f64>>());
        }
        // Two columns and three residuals stand before the first.
        assert!(all.iter().all(|scores| scores.len() == 25));
        let count = f64::from(25 * runs);
        let sum = |of: &dyn Fn(&[f64]) -> f64| all.iter().map(|scores| of(scores)).sum::<f64>();
        let mean = sum(&|scores| scores.iter().sum()) / count;
        let square = sum(&|scores| scores.iter().map(|score| score * score).sum()) / count;
        let lagged = sum(&|scores| scores.windows(2).map(|pair| pair[0] * pair[1]).sum()) / count;
        assert!(mean.abs() < 7.0 / count.sqrt(), "{mean}");
        assert!((square - 1.0).abs() < 7.0 * (2.0 / count).sqrt(), "{square}");
        assert!(lagged.abs() < 7.0 / count.sqrt(), "{lagged}");
    }
}
