//! How many terms a law has, and which: the smallest number beyond which no further term lowers the residual significantly.

use super::library::{self, POSITIONS, is_same_form};
use super::samples::{Normal, Samples};
use super::subsets::{Library, Subset};
use super::waves::{maximum, strongest};
use crate::options::SearchOptions;
use model::residual_law::{Term, WavePosition};
use model::residual_table::TableVariable;
use numerics::min_max;

/// Largest number of terms.
const MOST_TERMS: usize = 3;

/// Range in which a distance or a period is refined, as factors.
const REFINED: [f64; 2] = [0.6, 1.7];

/// Range in which a period is refined, as a fraction of the resolution of the travel.
const PERIOD_REFINED: f64 = 0.3;

/// The law that describes the fitted samples best, and others of its size that leave little more.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The terms that were tried.
    pub library: Library,
    /// Normal equations of the library, block by block.
    pub blocks: Vec<Normal>,
    /// Subsets by size, best first.
    pub by_size: Vec<Vec<Subset>>,
    /// Number of terms of the law.
    pub size: usize,
    /// Travel along own and other position, mm.
    pub travel_mm: [f64; 2],
}

impl Chosen {
    /// The choice for these samples; `None` if no term lowers their residual significantly.
    #[must_use]
    pub fn of(samples: &Samples<'_>, variables: &[TableVariable], options: &SearchOptions) -> Option<Self> {
        let known = |over: WavePosition| variables.contains(&over.variable());
        let travel_mm = POSITIONS.map(|over| {
            let [min, max] = min_max(samples.pairs(over).into_iter().map(|pair| pair.0));
            if known(over) { max - min } else { 0.0 }
        });
        let mut terms = library::terms(variables);
        let mut rest = samples.clone();
        // The waves of what remains beside the best law so far, until it has the most terms.
        for size in 0..MOST_TERMS {
            terms.extend(
                POSITIONS.into_iter().filter(|over| known(*over)).filter_map(|over| strongest(&rest, over)),
            );
            let library = Library::new(terms.clone(), samples.always());
            let total = Normal::sum(samples.normal(&library.terms).iter())?;
            let by_size = library.best(&total, size + 1, price(options));
            let Some(best) = by_size[size + 1].first() else { break };
            let law = refined(samples, library.with_coefficients(best));
            for (index, term) in best.terms.iter().zip(&law) {
                terms[*index] = term.clone();
            }
            let always: Vec<f64> =
                best.coefficients[..samples.always()].iter().map(|(_, value)| *value).collect();
            rest = samples.without(&always, &law);
        }
        let library = Library::new(terms, samples.always());
        let blocks = samples.normal(&library.terms);
        let by_size = library.best(&Normal::sum(blocks.iter())?, MOST_TERMS, price(options));
        let chosen = Self { library, blocks, by_size, size: 0, travel_mm };
        let size = (1..=MOST_TERMS).take_while(|&size| chosen.is_needed(size, options)).last()?;
        Some(Self { size, ..chosen })
    }

    /// Whether the best law with this number of terms is significantly better than that with one term less: it earns the price of its
    /// values, and each of its terms differs from zero.
    fn is_needed(&self, size: usize, options: &SearchOptions) -> bool {
        let (Some(smaller), Some(larger)) = (self.by_size[size - 1].first(), self.by_size[size].first())
        else {
            return false;
        };
        let t = self.library.t_of_terms(&self.blocks, larger);
        larger.score < smaller.score && t.iter().all(|t| *t >= options.min_t_of(self.blocks.len()))
    }

    /// Whether two terms say the same of these logs.
    #[must_use]
    pub fn is_same_form(&self, a: &Term, b: &Term) -> bool {
        is_same_form(a, b, |over| self.travel_mm[usize::from(over == WavePosition::OtherPositionMm)])
    }
}

/// The factor on Σr² that each further value has to earn.
#[must_use]
pub fn price(options: &SearchOptions) -> f64 {
    1.0 / (1.0 - options.min_reduction)
}

/// By how many standard errors, estimated from the blocks, a subset leaves less than another one.
#[must_use]
pub fn improvement_t(blocks: &[Normal], worse: &Subset, better: &Subset) -> f64 {
    let gains = blocks
        .iter()
        .map(|block| block.squares_with(&worse.coefficients) - block.squares_with(&better.coefficients));
    t_of_sum(&gains.collect::<Vec<_>>())
}

/// A sum over blocks in units of its standard error.
fn t_of_sum(gains: &[f64]) -> f64 {
    let n = gains.len() as f64;
    let mean = numerics::mean(gains.iter().copied());
    let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let error = (n * variance).sqrt();
    if error > 0.0 { n * mean / error } else { 0.0 }
}

/// The terms with the distance or the period of each that leaves least, one after the other, twice.
fn refined(samples: &Samples<'_>, mut terms: Vec<Term>) -> Vec<Term> {
    for _ in 0..2 {
        for index in 0..terms.len() {
            let with = |length_mm: f64| {
                let mut changed = terms.clone();
                changed[index] = terms[index].with_length(length_mm);
                changed
            };
            let left = |length_mm: f64| {
                let library = Library::new(with(length_mm), samples.always());
                let all = (0..library.terms.len()).collect();
                let total = Normal::sum(samples.normal(&library.terms).iter());
                total
                    .and_then(|total| library.fitted(&total, all, 1.0))
                    .map_or(f64::INFINITY, |fit| fit.squares)
            };
            let range = match &terms[index] {
                Term::Product { .. } => continue,
                Term::Hysteresis { distance_mm, .. } => REFINED.map(|factor| factor * distance_mm),
                Term::Wave { over, period_mm, .. } => {
                    let [min, max] = min_max(samples.pairs(*over).into_iter().map(|pair| pair.0));
                    let step = PERIOD_REFINED / (max - min);
                    [step, -step].map(|step| 1.0 / (1.0 / period_mm + step))
                }
            };
            let best = libm::exp(maximum(|log| -left(libm::exp(log)), range.map(libm::log)));
            terms = with(best);
        }
    }
    terms
}
