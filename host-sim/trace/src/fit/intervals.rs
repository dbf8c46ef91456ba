//! Confidence intervals of fitted parameters.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use numerics::distributions::student_t_975;

use super::axis_model::FreeParameter;
use super::fit_data::FitData;
use super::least_squares::Fitted;
use super::normal_equations::normal;
use crate::options::SearchOptions;
use model::effects::{Coordinate, Effect};
use model::range;

/// Covariance of the free parameters of a fit, estimated from the blocks of the logs.
#[derive(Clone, Debug)]
pub struct Covariance {
    matrix: DMatrix<f64>,
    /// H⁻¹.
    inverse: DMatrix<f64>,
    /// Shift of the parameters by the subtracted error of the tracer's own simulation. It is taken as uncertain as it is large:
    /// the machine does not step as the simulation does, and nothing but the simulation confirms it.
    bias_shift: DVector<f64>,
    /// Shifts of the parameters by each value whose fit stopped at a bound: see [`Self::with_values_at_bounds`].
    bound_shifts: Vec<DVector<f64>>,
    /// Number of blocks less one.
    degrees_of_freedom: usize,
}

/// Covariance of the free parameters of a fit, H⁻¹·(Σ g·gᵀ + P)·H⁻¹: over the blocks of the logs (sandwich estimator), which
/// is valid for errors that are correlated within a block, and for the priors, whose precision is P.
#[must_use]
pub fn covariance(data: &FitData<'_>, fitted: &Fitted) -> Covariance {
    let n = fitted.parameters.len();
    let (curvature, _) = normal(&fitted.blocks, &fitted.parameters);
    let mut regular =
        curvature.clone() + DMatrix::from_diagonal(&(curvature.diagonal() * 1e-9).add_scalar(1e-12));
    let at_bound: Vec<usize> = (0..n).filter(|&i| is_at_bound(&fitted.parameters[i].coordinate)).collect();
    // A parameter at a bound is treated as known.
    for &i in &at_bound {
        regular[(i, i)] += 1e9 * (1.0 + curvature[(i, i)]);
    }
    let inverse = regular.cholesky().map_or_else(|| DMatrix::zeros(n, n), |c| c.inverse());
    // The gradients of all stages over one block of one log are summed. Blocks without a sample that counts are skipped.
    let mut sums: Vec<((usize, usize), DVector<f64>)> = Vec::new();
    for block in fitted.blocks.iter().filter(|block| block.samples > 0) {
        let key = (block.log, block.number);
        match sums.iter_mut().find(|(k, _)| *k == key) {
            Some((_, sum)) => *sum += &block.gradient,
            None => sums.push((key, block.gradient.clone())),
        }
    }
    let precision = |parameter: &FreeParameter| parameter.prior.map_or(0.0, |(_, spread)| spread.powi(-2));
    let priors = DVector::from_iterator(n, fitted.parameters.iter().map(precision));
    let outer_products = sums.iter().fold(DMatrix::zeros(n, n), |sum, (_, g)| sum + g * g.transpose());
    let shift_of_bound = |&i: &usize| {
        let (mean, spread) = fitted.parameters[i].prior?;
        let deviation = spread.min((fitted.parameters[i].coordinate.value - mean).abs());
        Some(&inverse * curvature.column(i) * deviation)
    };
    Covariance {
        bound_shifts: at_bound.iter().filter_map(shift_of_bound).collect(),
        matrix: &inverse * (outer_products + DMatrix::from_diagonal(&priors)) * &inverse,
        bias_shift: &inverse * bias_gradient(data, fitted),
        inverse,
        degrees_of_freedom: sums.len().saturating_sub(1),
    }
}

/// Whether a value is at one of its bounds but for rounding. A friction of 0.01 N is not at its bound of zero, though its range ends at 100 kN.
fn is_at_bound(coordinate: &Coordinate) -> bool {
    let Coordinate { value, step, lower, upper, .. } = *coordinate;
    let near = 1e-6 * step;
    value - lower < near || upper - value < near
}

/// Jᵀ·b of the weighted error b that is subtracted from the residuals.
fn bias_gradient(data: &FitData<'_>, fitted: &Fitted) -> DVector<f64> {
    let mut gradient = DVector::zeros(fitted.parameters.len());
    for (index, series) in fitted.residuals.iter().enumerate() {
        if let Some(bias) = data.bias_of(series) {
            fitted.add_gradient(&mut gradient, index, &bias.values.iter().copied());
        }
    }
    gradient
}

impl Covariance {
    /// Number of parameters.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.bias_shift.len()
    }

    /// Covariance of some of the parameters, with the uncertain error of the tracer's own simulation as one more deviation.
    #[must_use]
    pub fn of(&self, indices: &[usize]) -> DMatrix<f64> {
        let t = student_t_975(self.degrees_of_freedom);
        DMatrix::from_fn(indices.len(), indices.len(), |i, j| {
            let (i, j) = (indices[i], indices[j]);
            self.matrix[(i, j)] + self.bias_shift[i] * self.bias_shift[j] / (t * t)
        })
    }

    /// Change of the parameters by a change of the gradient `JᵀWr`: −H⁻¹·g.
    #[must_use]
    pub fn shift_by(&self, gradient: &DVector<f64>) -> DVector<f64> {
        -(&self.inverse * gradient)
    }

    /// This covariance with independent deviations of the parameters added, each of one standard deviation.
    #[must_use]
    pub fn with_shifts(mut self, shifts: &[DVector<f64>]) -> Self {
        for shift in shifts {
            self.matrix += shift * shift.transpose();
        }
        self
    }

    /// This covariance with the uncertainty of values at a bound, which a fit takes as known. Where it stops is no knowledge of a value: if it has a
    /// prior, it may as well be there. An interval that is reported contains this; a search goes by what a fit knows.
    #[must_use]
    pub fn with_values_at_bounds(mut self) -> Self {
        let shifts = std::mem::take(&mut self.bound_shifts);
        self.with_shifts(&shifts)
    }

    /// This covariance with one more deviation of the parameters added, whose 95 % interval has this half width.
    #[must_use]
    pub fn with_half_width(self, shift: &DVector<f64>) -> Self {
        let t = student_t_975(self.degrees_of_freedom);
        self.with_shifts(&[shift / t])
    }

    /// Half width of the 95 % confidence interval of a free parameter, by Student's t.
    #[must_use]
    pub fn half_width(&self, index: usize) -> f64 {
        self.half_width_of_sum(&[index])
    }

    /// Half width of the 95 % confidence interval of the sum of free parameters, by Student's t.
    #[must_use]
    pub fn half_width_of_sum(&self, indices: &[usize]) -> f64 {
        let variance: f64 =
            indices.iter().flat_map(|&i| indices.iter().map(move |&j| self.matrix[(i, j)])).sum();
        let shift: f64 = indices.iter().map(|&i| self.bias_shift[i]).sum();
        libm::hypot(student_t_975(self.degrees_of_freedom) * variance.max(0.0).sqrt(), shift)
    }
}

/// Half widths of the 95 % confidence intervals of an effect's parameters, by Student's t, with the error of the model itself. `indices` are those of the
/// effect's coordinates in the covariance.
#[must_use]
pub fn half_widths(effect: &Effect, covariance: &Covariance, indices: Range<usize>) -> Vec<f64> {
    let of_effect = covariance.matrix.view((indices.start, indices.start), (indices.len(), indices.len()));
    let coordinates = effect.coordinates();
    let values: Vec<f64> = coordinates.iter().map(|c| c.value).collect();
    let (parameters, declared) = (effect.values(), effect.declared_parameters());
    let mut jacobian = DMatrix::zeros(parameters.len(), values.len());
    for (j, coordinate) in coordinates.iter().enumerate() {
        let mut moved = values.clone();
        let step = 1e-3 * coordinate.step;
        moved[j] += step;
        for (i, value) in effect.at(&moved).values().into_iter().enumerate() {
            let mut change = value - parameters[i];
            if let Some(period) = declared[i].period {
                change = numerics::wrapped(change, period);
            }
            jacobian[(i, j)] = change / step;
        }
    }
    let of_parameters = &jacobian * of_effect * jacobian.transpose();
    let shifts = &jacobian * covariance.bias_shift.rows(indices.start, indices.len());
    let t = student_t_975(covariance.degrees_of_freedom);
    let both = |(variance, shift): (&f64, &f64)| libm::hypot(t * variance.max(0.0).sqrt(), *shift);
    let of_fit = of_parameters.diagonal().iter().zip(&shifts).map(both).collect::<Vec<_>>();
    let of_model =
        parameters.iter().zip(&declared).map(|(value, declared)| declared.model_error * value.abs());
    of_fit
        .into_iter()
        .zip(of_model)
        .map(|(fit, model)| if model > 0.0 { libm::hypot(fit, model) } else { fit })
        .collect()
}

/// Whether an effect is less than [`SearchOptions::min_size`] half widths of its interval large.
#[must_use]
pub fn may_be_zero(effect: &Effect, half_widths: &[f64], options: &SearchOptions) -> bool {
    let size = effect.values().first().copied().unwrap_or(0.0);
    half_widths.first().is_some_and(|half_width| size.abs() < options.min_size * half_width)
}

/// Whether an effect has parameters besides its size that are positive, such as a time constant or a speed, and the logs
/// determine none of those that were fitted: each interval contains zero. As the shape of the effect is unknown, so is
/// its cause.
#[must_use]
pub fn has_unknown_shape(effect: &Effect, half_widths: &[f64]) -> bool {
    let (values, declared) = (effect.values(), effect.declared_parameters());
    let parameters = declared.iter().zip(&values).zip(half_widths).skip(1);
    let mut fitted = parameters
        .filter(|((parameter, _), half_width)| {
            parameter.range == range::Range::Positive && **half_width > 0.0
        })
        .peekable();
    fitted.peek().is_some() && fitted.all(|((_, value), half_width)| *half_width >= value.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::axis_model::AxisModel;
    use crate::fit::fit_data::ResidualSeries;
    use crate::fit::normal_equations::{BLOCKS, Block, DerivativeSeries};
    use crate::options::{ModelOptions, TraceOptions};
    use model::effects::{ForceWindup, FrictionWarmUp, ServoMismatch, Stage};
    use model::machine::Axis;
    use shared::config::Rates;
    use std::sync::Arc;

    /// Steps are 2 N and 0.02·8 mm/s.
    #[test]
    fn a_value_is_at_its_bound_only_within_a_rounding() {
        let friction = |value| Coordinate::between(value, 2.0, 0.0, 1e5);
        assert!(is_at_bound(&friction(0.0)) && is_at_bound(&friction(1e-6)));
        assert!(!is_at_bound(&friction(3e-6)) && !is_at_bound(&friction(0.0097)));
        assert!(is_at_bound(&friction(1e5)) && !is_at_bound(&friction(1e5 - 1e-5)));
        let at = |value| Coordinate { value, ..Coordinate::scale(8.0, 0.1, 300.0) };
        assert!(is_at_bound(&at(8.0 / 3.0)) && is_at_bound(&at(24.0)) && !is_at_bound(&at(8.0)));
    }

    /// A fit of one parameter to `logs` logs: each block has curvature 1 and a gradient of ±1; the first block of each log
    /// has no counting sample.
    fn fitted(logs: usize) -> Fitted {
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let block = |(log, number): (usize, usize)| Block {
            stage: Stage::Motor,
            log,
            number,
            fold: 0,
            weight: 1.0,
            samples: if number == 0 { 0 } else { 100 },
            squares: 1.0,
            gradient: DVector::from_element(1, if number == 0 { 0.0 } else { 1.0 }),
            curvature: DMatrix::from_element(1, 1, if number == 0 { 0.0 } else { 1.0 }),
        };
        let blocks = (0..logs).flat_map(|log| (0..BLOCKS).map(move |number| (log, number))).map(block);
        let coordinate = Coordinate::between(0.0, 0.1, -100.0, 100.0);
        Fitted {
            model: AxisModel::new(&Axis::default(), rates, ModelOptions::default()),
            parameters: vec![FreeParameter { coordinate, prior: None }],
            blocks: blocks.collect(),
            weights: Vec::new(),
            residuals: Vec::new(),
            columns: Vec::new(),
        }
    }

    /// Half width of the parameter of [`fitted`] under a bias.
    fn half_width(fitted: &Fitted, bias: &[ResidualSeries]) -> f64 {
        let rates = Rates { velocity_loop_hz: 1000.0, position_loop_divider: 1 };
        let options = TraceOptions::default();
        let data = FitData { bias, ..FitData::new(&[], &[], 0, rates, &options) };
        let effect = Effect::ServoMismatch(ServoMismatch { percent: 10.0 });
        let covariance = covariance(&data, fitted);
        let half = half_widths(&effect, &covariance, 0..1)[0];
        assert!((covariance.half_width(0) / half - 1.0).abs() < 1e-9);
        half
    }

    /// Variance Σg²/H² = 1/n of n blocks; t(22) = 2.074 for one log, t(68) = 1.995 for three.
    #[test]
    fn the_degrees_of_freedom_follow_from_the_blocks_with_samples() {
        for (logs, blocks, t) in [(1, 23.0, 2.074), (3, 69.0, 1.995)] {
            let half = half_width(&fitted(logs), &[]);
            assert!((half * f64::sqrt(blocks) / t - 1.0).abs() < 5e-4, "{logs}: {half}");
        }
    }

    /// A prior of standard deviation 0.1 has the precision 100: variance (23 + 100)/(23 + 100)².
    #[test]
    fn a_prior_adds_its_own_variance() {
        let mut fitted = fitted(1);
        fitted.parameters[0].prior = Some((0.0, 0.1));
        let half = half_width(&fitted, &[]);
        assert!((half * f64::sqrt(123.0) / 2.074 - 1.0).abs() < 5e-4, "{half}");
    }

    #[test]
    fn an_effect_has_no_shape_if_its_interval_contains_a_time_constant_of_zero() {
        let warm_up = |half_width: f64| {
            let effect = Effect::FrictionWarmUp(FrictionWarmUp { force_n: 1.6, time_constant_s: 3234.0 });
            has_unknown_shape(&effect, &[0.7, half_width])
        };
        assert!(warm_up(9410.0) && warm_up(3234.0) && !warm_up(3233.0));
        // A time constant that is not fitted, and effects whose only parameter is their size.
        assert!(!warm_up(0.0));
        let gain = Effect::ServoMismatch(ServoMismatch { percent: 10.0 });
        assert!(!has_unknown_shape(&gain, &[100.0]));
        // Of stiffness, friction and presliding distance, one is determined.
        let windup = ForceWindup { stiffness_n_per_um: 1.0, friction_n: 2.0, presliding_mm: Some(0.1) };
        let windup = Effect::ForceWindup(windup);
        assert!(
            has_unknown_shape(&windup, &[0.1, 0.2, 0.2]) && !has_unknown_shape(&windup, &[0.1, 0.2, 0.05])
        );
    }

    /// Ten samples of slope 2, weight 3 and error 0.5: the shift is 9·10·2·0.5/23 = 3.913, which is the half width, beside
    /// 2.074/√23 = 0.4325 by chance.
    #[test]
    fn a_subtracted_error_is_as_uncertain_as_it_is_large() {
        let series = |value| ResidualSeries { stage: Stage::Motor, log: 0, values: vec![value; 10] };
        let mut fitted = fitted(1);
        (fitted.weights, fitted.residuals) = (vec![3.0], vec![series(1.0)]);
        fitted.columns = vec![Arc::new(vec![DerivativeSeries::of(&series(0.0), &series(1.0), 0.5)])];
        let half = half_width(&fitted, &[series(0.5)]);
        assert!((half / 3.913f64.hypot(0.4325) - 1.0).abs() < 1e-3, "{half}");
    }
}
