//! Which terms the samples support: all smooth ones that can be told apart, then spikes, waves and vibrations one after the other.

use std::ops::Range;

use super::covariance::Covariance;
use super::fit::{Fit, Model, derivatives, refined};
use super::samples::Samples;
use super::search::{self, Candidate};
use super::term::Term;

/// Greatest number of spikes, waves and vibrations.
const MAX_ADDED: usize = 8;

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
    let mut best = Fitted::new(samples, model, fit);
    for _ in 0..MAX_ADDED {
        let Some(next) = extended(samples, &best) else { break };
        best = next;
    }
    best
}

/// The model with the candidate that explains most, among those that are significant.
fn extended(samples: &Samples, before: &Fitted) -> Option<Fitted> {
    let mut candidates = candidates(samples, before);
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
fn candidates(samples: &Samples, before: &Fitted) -> Vec<Candidate> {
    let count = |is: &dyn Fn(&Term) -> bool| {
        before.model.groups.iter().filter(|group| is(&before.model.terms[group.start])).count()
    };
    let of_axis = |axis: usize| {
        let spikes = count(&|term| matches!(term, Term::Spike(a, ..) if *a == axis));
        let waves = count(&|term| matches!(term, Term::Wave(a, ..) if *a == axis));
        let vibrations = count(&|term| matches!(term, Term::Vibration(a, ..) if *a == axis));
        let fit = &before.fit;
        [
            (spikes == 0).then(|| search::spike(samples, fit, axis)).flatten(),
            (waves < MAX_OF_A_KIND).then(|| search::cyclic(samples, fit, axis)).flatten(),
            (vibrations < MAX_OF_A_KIND).then(|| search::vibration(samples, fit, axis)).flatten(),
        ]
    };
    let (x, y) = (of_axis(0), of_axis(1));
    x.into_iter().chain(y).flatten().collect()
}
