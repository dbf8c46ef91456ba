//! Which terms the samples support: all smooth ones that can be told apart, then spikes, waves and vibrations one after the other.

use std::ops::Range;

use super::covariance::Covariance;
use super::fit::{Fit, Model, derivatives, refined};
use super::samples::Samples;
use super::search::{self, Candidate};
use super::term::{Shape, Term};

/// Greatest number of spikes, waves and vibrations.
const MAX_ADDED: usize = 8;

/// Angle between samples for the search of spikes, rad: 0.1°.
const COARSE_RAD: f64 = 0.1 * std::f64::consts::PI / 180.0;

/// Greatest number of waves, and of vibrations, of an axis.
const MAX_OF_A_KIND: usize = 2;

/// Smallest amplitude of an added part, in standard errors. It is the greatest of some thousand candidates, and that of noise alone
/// reaches √(2·ln 4000) = 4.1.
const MIN_AMPLITUDE: f64 = 5.0;

/// A fitted model with the covariance of its coefficients and, behind them, of the relative changes of its parameters.
pub struct Fitted {
    /// Terms.
    pub model: Model,
    /// Coefficients.
    pub fit: Fit,
    /// Covariance.
    pub covariance: Covariance,
}

impl Fitted {
    fn new(samples: &Samples, model: Model, fit: Fit) -> Self {
        let derivatives = derivatives(samples, &model, &fit);
        let terms = fit.matrix.ncols();
        let mut all = fit.matrix.clone().resize_horizontally(terms + derivatives.ncols(), 0.0);
        all.columns_mut(terms, derivatives.ncols()).copy_from(&derivatives);
        let covariance = Covariance::new(samples, &all, &fit.residual);
        Self { model, fit, covariance }
    }

    /// Index of a term.
    #[must_use]
    pub fn index(&self, term: Term) -> Option<usize> {
        self.model.terms.iter().position(|other| *other == term)
    }

    /// Amplitude of the terms of a group, root of the sum of squares over its arcs, and its standard error, µm.
    #[must_use]
    pub fn amplitude(&self, group: &Range<usize>) -> (f64, f64) {
        let arcs = (group.len() / 2).max(1) as f64;
        let coefficients = || group.clone().map(|i| self.fit.coefficients[i]);
        let amplitude = (coefficients().map(|c| c * c).sum::<f64>() / arcs).sqrt();
        let weights: Vec<(usize, f64)> =
            group.clone().zip(coefficients().map(|c| c / (arcs * amplitude.max(1e-12)))).collect();
        (amplitude, self.covariance.variance(&weights).sqrt())
    }

    /// Standard error of the relative change of a group's parameter.
    #[must_use]
    pub fn parameter_error(&self, group: usize) -> f64 {
        self.covariance.variance(&[(self.fit.matrix.ncols() + group, 1.0)]).sqrt()
    }
}

/// The smooth terms that these samples can tell apart.
#[must_use]
pub fn smooth_terms(samples: &Samples) -> Vec<Term> {
    let mut terms = vec![Term::Centre(0), Term::Centre(1), Term::Radius, Term::Scale, Term::Square];
    let (both, speeds) = (samples.has_both_directions(), samples.has_several_speeds());
    if both || speeds {
        terms.push(Term::Servo);
    }
    if samples.has_both_axes() {
        // In one direction at one speed, a delay of both axes is a rotation.
        terms.push(Term::Lag);
        if both || speeds {
            terms.push(Term::Rotation);
        }
    }
    if speeds {
        terms.push(Term::SpeedRadius);
    }
    terms.extend([0, 1].map(Term::Backlash));
    terms.extend([0, 1].map(Term::Play));
    terms
}

/// Fits everything that the samples support.
#[must_use]
pub fn fitted(samples: &Samples) -> Fitted {
    let model = Model { terms: smooth_terms(samples), groups: Vec::new() };
    let fit = Fit::new(samples, &model.terms);
    let coarse = samples.thinned(COARSE_RAD);
    let mut best = Fitted::new(samples, model, fit);
    for _ in 0..MAX_ADDED {
        let next = extended(samples, &coarse, &best);
        // The shape of a spike was chosen before the parts that were found after it.
        let Some(next) = next.or_else(|| reshaped(samples, &coarse, &best)) else { break };
        best = next;
    }
    best
}

/// The model with better shapes of its spikes; `None` if they are the best.
fn reshaped(samples: &Samples, coarse: &Samples, before: &Fitted) -> Option<Fitted> {
    let mut model = before.model.clone();
    let error = |model: &mut Model| refined(coarse, model).residual.norm_squared();
    for group in 0..model.groups.len() {
        let mut candidates: Vec<Model> =
            Shape::ALL.iter().map(|shape| model.with_shape(group, *shape)).collect();
        candidates.dedup();
        let errors: Vec<f64> = candidates.iter_mut().map(error).collect();
        let best = (0..candidates.len()).min_by(|&a, &b| errors[a].total_cmp(&errors[b]))?;
        model = candidates.swap_remove(best);
    }
    let shape = |model: &Model| -> Vec<Option<Shape>> {
        let of = |term: &Term| if let Term::Spike(_, shape, _) = term { Some(*shape) } else { None };
        model.terms.iter().map(of).collect()
    };
    if shape(&model) == shape(&before.model) {
        return None;
    }
    let fit = refined(samples, &mut model);
    Some(Fitted::new(samples, model, fit))
}

/// The model with the candidate that explains most, among those that are significant.
fn extended(samples: &Samples, coarse: &Samples, before: &Fitted) -> Option<Fitted> {
    let mut candidates = candidates(samples, coarse, before);
    // What explains less than this cannot be significant, as correlation of the noise only widens the errors of what varies slowly.
    let least = MIN_AMPLITUDE * MIN_AMPLITUDE * before.fit.unpredicted_variance();
    candidates.retain(|(gain, _)| *gain > least);
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0));
    candidates.into_iter().find_map(|(_, terms)| {
        let mut model = before.model.clone();
        model.add(&terms);
        let fit = refined(samples, &mut model);
        let after = Fitted::new(samples, model, fit);
        let is_significant = |group: &Range<usize>| {
            let (amplitude, error) = after.amplitude(group);
            amplitude > MIN_AMPLITUDE * error
        };
        after.model.groups.last().is_some_and(is_significant).then_some(after)
    })
}

/// The best candidate of each kind and axis.
fn candidates(samples: &Samples, coarse: &Samples, before: &Fitted) -> Vec<Candidate> {
    let count = |is: &dyn Fn(&Term) -> bool| {
        before.model.groups.iter().filter(|group| is(&before.model.terms[group.start])).count()
    };
    let coarse_fit = Fit::new(coarse, &before.model.terms);
    // A fall of the sum of squares of a part of the samples stands for that of all.
    let all = samples.instants.len() as f64 / coarse.instants.len().max(1) as f64;
    let of_axis = |axis: usize| {
        let spikes = count(&|term| matches!(term, Term::Spike(a, ..) if *a == axis));
        let waves = count(&|term| matches!(term, Term::Wave(a, ..) if *a == axis));
        let vibrations = count(&|term| matches!(term, Term::Vibration(a, ..) if *a == axis));
        let fit = &before.fit;
        [
            (spikes == 0)
                .then(|| search::spike(coarse, &coarse_fit, axis))
                .flatten()
                .map(|(gain, terms)| (all * gain, terms)),
            (waves < MAX_OF_A_KIND).then(|| search::cyclic(samples, fit, axis)).flatten(),
            (vibrations < MAX_OF_A_KIND).then(|| search::vibration(samples, fit, axis)).flatten(),
        ]
    };
    let (x, y) = rayon::join(|| of_axis(0), || of_axis(1));
    x.into_iter().chain(y).flatten().collect()
}
