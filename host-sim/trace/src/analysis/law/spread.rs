//! How uncertain the values of a law are: coefficients, and with them periods and distances.

use nalgebra::DMatrix;

use super::samples::{Normal, Samples, columns_of};
use super::subsets::solved_above;
use model::residual_law::Term;
use numerics::distributions::student_t_975;

/// Relative change of a period or a distance by which its derivative is computed.
const STEP: f64 = 1e-3;

/// Half of the 95 % interval of what the form of a term lacks, of its coefficient: a direction that turns over within a speed that logs do not show, a speed
/// near a reversal, an acceleration that is a filtered difference, a hysteresis of another curve. On 34 machines of a second simulator (seeds 20262161 and
/// 20262163 of `self-test --laws`) the scatter of the logs alone was too narrow in a quarter to a third of the coefficients.
const FORM_ERROR: f64 = 0.003;

/// A period depends on the phase where the positions are far from zero, so that its column may be nearly a combination of the others.
const MIN_INDEPENDENT: f64 = 1e-9;

/// How the values of a law scatter when one block of the fitted samples after the other is left out (Quenouille, 1956), and the terms are fitted
/// again beside the derivatives with respect to periods and distances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// Sums of products of deviations, scaled so that the root of a diagonal element is half of a 95 % interval.
    products: DMatrix<f64>,
    /// For each term its first value, its number of coefficients, and its period or distance.
    terms: Vec<(usize, usize, Option<usize>)>,
}

impl Spread {
    /// The spread of the values of a law.
    #[must_use]
    pub fn of(samples: &Samples<'_>, law: &[Term]) -> Self {
        let terms = numbered(law);
        let values = terms.iter().map(|(_, count, length)| count + usize::from(length.is_some())).sum();
        let blocks = with_lengths(samples, law);
        let always = samples.always();
        let columns: Vec<usize> = (0..always + values).collect();
        let without = |left_out: usize| {
            let others = blocks.iter().enumerate().filter(|(i, _)| *i != left_out).map(|(_, block)| block);
            solved_above(&Normal::sum(others)?, &columns, MIN_INDEPENDENT)
        };
        let fits: Vec<Vec<f64>> = (0..blocks.len()).filter_map(without).collect();
        let n = fits.len() as f64;
        let scale = student_t_975(fits.len().saturating_sub(1)).powi(2) * (n - 1.0) / n;
        let means: Vec<f64> =
            (0..values).map(|i| numerics::mean(fits.iter().map(|fit| fit[always + i]))).collect();
        let mut products = DMatrix::from_fn(values, values, |i, j| {
            let product = |fit: &Vec<f64>| (fit[always + i] - means[i]) * (fit[always + j] - means[j]);
            scale * fits.iter().map(product).sum::<f64>()
        });
        for (term, (first, count, _)) in law.iter().zip(&terms).filter(|(term, _)| !term.has_exact_form()) {
            for (value, coefficient) in term.coefficients().iter().enumerate().take(*count) {
                products[(first + value, first + value)] += (FORM_ERROR * coefficient).powi(2);
            }
        }
        Self { products, terms }
    }

    /// Half of the 95 % interval of a function of the values, by its derivatives with respect to the coefficients of each term, and then with respect to each
    /// period or distance.
    #[must_use]
    pub fn half_width(&self, slopes: &[f64]) -> f64 {
        let row = |i: usize| slopes.iter().enumerate().map(move |(j, slope)| self.products[(i, j)] * slope);
        let square: f64 = slopes.iter().enumerate().map(|(i, slope)| slope * row(i).sum::<f64>()).sum();
        square.sqrt()
    }

    /// Half of the interval of each coefficient of a term.
    #[must_use]
    pub fn of_coefficients(&self, term: usize) -> [f64; 2] {
        let (first, count, _) = self.terms[term];
        [0, 1].map(|i| if i < count { self.of_value(first + i) } else { 0.0 })
    }

    /// Half of the interval of the amplitude of a wave; of another term, of its coefficient.
    #[must_use]
    pub fn of_amplitude(&self, index: usize, term: &Term) -> f64 {
        let ((first, count, _), [a, b]) = (self.terms[index], term.coefficients());
        if count == 1 {
            return self.of_value(first);
        }
        let amplitude = libm::hypot(a, b);
        let mut slopes = vec![0.0; self.products.nrows()];
        slopes[first] = a / amplitude;
        slopes[first + 1] = b / amplitude;
        self.half_width(&slopes)
    }

    /// Half of the interval of a period or a distance, mm.
    #[must_use]
    pub fn of_length(&self, term: usize) -> Option<f64> {
        self.terms[term].2.map(|value| self.of_value(value))
    }

    fn of_value(&self, value: usize) -> f64 {
        self.products[(value, value)].sqrt()
    }
}

/// For each term its first value, its number of coefficients, and its period or distance: all coefficients come first.
fn numbered(law: &[Term]) -> Vec<(usize, usize, Option<usize>)> {
    let mut length = law.iter().map(columns_of).sum();
    let mut first = 0;
    let of_term = |term: &Term| {
        let count = columns_of(term);
        let of_length = term.length_mm().map(|_| length);
        let numbered = (first, count, of_length);
        first += count;
        length += usize::from(of_length.is_some());
        numbered
    };
    law.iter().map(of_term).collect()
}

/// Two terms whose sum is the derivative of a term with respect to its period or distance, per mm; `None` of a product.
#[must_use]
pub fn neighbours(term: &Term) -> Option<[Term; 2]> {
    let mm = term.length_mm()?;
    let [a, b] = term.coefficients();
    let slope = 1.0 / (2.0 * STEP * mm);
    Some(
        [1.0, -1.0].map(|sign| {
            term.with_length(mm * (1.0 + sign * STEP)).with([sign * slope * a, sign * slope * b])
        }),
    )
}

/// The normal equations of the terms of a law, and of their derivatives with respect to periods and distances.
fn with_lengths(samples: &Samples<'_>, law: &[Term]) -> Vec<Normal> {
    let pairs: Vec<[Term; 2]> = law.iter().filter_map(neighbours).collect();
    let all: Vec<Term> = law.iter().chain(pairs.iter().flatten()).cloned().collect();
    let own = samples.always() + law.iter().map(columns_of).sum::<usize>();
    let columns = samples.always() + all.iter().map(columns_of).sum::<usize>();
    let mut combined = DMatrix::<f64>::zeros(columns, own + pairs.len());
    for i in 0..own {
        combined[(i, i)] = 1.0;
    }
    let mut next = own;
    for (length, pair) in pairs.iter().enumerate() {
        for neighbour in pair {
            for coefficient in &neighbour.coefficients()[..columns_of(neighbour)] {
                combined[(next, own + length)] = *coefficient;
                next += 1;
            }
        }
    }
    let combine = |block: Normal| Normal {
        gradient: combined.tr_mul(&block.gradient),
        curvature: combined.tr_mul(&block.curvature) * &combined,
        ..block
    };
    samples.normal(&all).into_iter().map(combine).collect()
}
