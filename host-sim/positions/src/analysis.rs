//! A positioning test, evaluated: figures, form of the deviation, effects, and the residual before and after.

use serde::Serialize;

use files::error::InputError;

use super::course::Clock;
use super::drift::mean_course;
use super::effect::Effect;
use super::effects;
use super::fit::{Fit, Samples};
use super::iso::{Figures, Position, figures, positions};
use super::measured::Test;
use super::selection::{Chosen, Search, course};
use super::source::{Feedback, Source};
use super::variant::{Drift, Gap, Grid, Mean, Place, Variant};
use super::wave;

/// Largest number of knots.
const MAX_KNOTS: usize = 100;

/// Fewest and most knots where the targets are no grid.
const SCATTERED_KNOTS: (usize, usize) = (4, 30);

/// What the user says of the axis.
#[derive(Clone, Debug)]
pub struct Options {
    /// Name of the axis.
    pub axis: String,
    /// What closes its loop.
    pub feedback: Feedback,
}

/// Root mean square over the fitted runs and over the validation runs, µm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FitValidate {
    /// Fitted runs.
    pub fit: f64,
    /// Validation runs; `None`: there are none.
    pub validate: Option<f64>,
}

/// The residual, µm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Residual {
    /// The deviations as measured.
    pub before: FitValidate,
    /// Less the effects found.
    pub after: FitValidate,
    /// Less a table of the means at each target in each direction, which is what a control's table can do at best.
    pub table: FitValidate,
    /// Error of fitted runs that were left out one by one; `None` of a single run.
    pub left_out: Option<f64>,
}

/// What the effects leave of a reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Left {
    /// Target, mm.
    pub target_mm: f64,
    /// +1 or −1: direction of the approach.
    pub sign: f64,
    /// What is left, µm.
    pub um: f64,
    /// Whether the reading took part in the fit.
    pub is_fitted: bool,
}

/// The result.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// The fitted runs.
    pub test: Test,
    /// The validation runs.
    pub validate: Vec<Test>,
    /// Targets with their approaches, of the fitted runs.
    pub positions: Vec<Position>,
    /// Figures of the fitted runs.
    pub figures: Figures,
    /// Why figures are not given.
    pub figure_notes: Vec<String>,
    /// Name of the axis.
    pub axis: String,
    /// Knots of the curves, and course of the drift.
    pub grid: Grid,
    /// The form that the runs support.
    pub fit: Fit,
    /// The effects, the largest first.
    pub effects: Vec<Effect>,
    /// The residual.
    pub residual: Residual,
    /// What the effects leave of each reading, those of the fitted runs first.
    pub left: Vec<Left>,
    /// Standard deviation of what no model takes, µm; `None` without degrees of freedom.
    pub scatter_um: Option<f64>,
    /// What was assumed, changed and left out, a sentence each.
    pub notes: Vec<String>,
}

/// Evaluates a test; the validation runs take no part but in the residuals.
///
/// # Errors
/// Readings that determine no form at all.
pub fn analyse(test: Test, validate: Vec<Test>, options: &Options) -> Result<Analysis, InputError> {
    let mut notes: Vec<String> = test.notes.clone();
    let has_times = test.has_times() && validate.iter().all(Test::has_times);
    let clock = if has_times { Clock::Seconds } else { Clock::Runs };
    let samples = Samples::of_test(&test, clock, None);
    let targets_mm = test.targets_mm();
    let knots_mm = knots(&test, &mut notes);
    let has_both_ways = test.has_both_ways();
    let span = numerics::min_max(samples.places.iter().map(|place| place.instant));
    let (course, time_constant_ci95) = course(&samples, &knots_mm, has_both_ways, span);
    let grid = Grid::new(knots_mm, course, mean_course(&course, &samples));
    let search = Search::new(&samples, &grid, has_both_ways);
    let undetermined =
        || InputError::expected(&test.source, "readings that determine an offset", test.readings.len());
    let chosen = Chosen { time_constant_ci95, ..search.choose().ok_or_else(undetermined)? };
    let source = Source {
        fit: &chosen.fit,
        grid: &grid,
        targets_mm: &targets_mm,
        axis: &options.axis,
        feedback: options.feedback,
        clock,
        time_constant_ci95,
    };
    let mut effects = effects::of(&source);
    let held: Vec<Samples> =
        validate.iter().map(|other| Samples::of_test(other, clock, Some((&test, &mut notes)))).collect();
    let held = together(held);
    set_reductions(&mut effects, &chosen.fit, &grid, &held);
    let residual = residual(&search, &chosen, &samples, &held);
    let left =
        left(&chosen.fit, &grid, &samples, true).chain(left(&chosen.fit, &grid, &held, false)).collect();
    for other in &validate {
        notes.extend(other.notes.iter().cloned());
    }
    notes.extend(resolution_note(&targets_mm));
    let positions = positions(&test);
    let (figures, figure_notes) = figures(&positions);
    let scatter_um = chosen.fit.scatter_um();
    let axis = options.axis.clone();
    Ok(Analysis {
        test,
        validate,
        positions,
        figures,
        figure_notes,
        axis,
        grid,
        fit: chosen.fit,
        effects,
        residual,
        left,
        scatter_um,
        notes,
    })
}

impl Samples {
    /// The readings of a test. Runs of a validation file are placed on the clock of the fitted test.
    fn of_test(test: &Test, clock: Clock, fitted: Option<(&Test, &mut Vec<String>)>) -> Self {
        let instants = match fitted {
            None => run_instants(test),
            Some((fitted, notes)) => instants_beside(test, fitted, clock, notes),
        };
        let place = |reading: &super::measured::Reading| Place {
            position_mm: reading.target_mm,
            sign: reading.way.sign(),
            instant: match clock {
                Clock::Seconds => reading.time_s.unwrap_or_default(),
                Clock::Runs => instants[reading.run],
            },
        };
        Self {
            places: test.readings.iter().map(place).collect(),
            deviations_um: test.readings.iter().map(|reading| reading.deviation_um).collect(),
            runs: test.readings.iter().map(|reading| reading.run).collect(),
        }
    }
}

/// The numbers of the runs if they rise, otherwise their order.
fn run_instants(test: &Test) -> Vec<f64> {
    let numbers = &test.run_numbers;
    let rises =
        numbers.iter().all(|number| number.is_finite()) && numbers.windows(2).all(|pair| pair[0] < pair[1]);
    if rises { numbers.clone() } else { (1..=numbers.len()).map(|count| count as f64).collect() }
}

/// Numbers that no fitted run has are of the test of the fitted runs, and tell when theirs were measured; other ones do not.
fn instants_beside(test: &Test, fitted: &Test, clock: Clock, notes: &mut Vec<String>) -> Vec<f64> {
    let taken = run_instants(fitted);
    let is_taken = |number: &f64| taken.iter().any(|other| other.to_bits() == number.to_bits());
    let is_free = |number: &f64| number.is_finite() && !is_taken(number);
    let are_numbers =
        taken.iter().zip(&fitted.run_numbers).all(|(instant, number)| instant.to_bits() == number.to_bits());
    if clock == Clock::Seconds || are_numbers && test.run_numbers.iter().all(is_free) {
        return test.run_numbers.clone();
    }
    notes.push(format!(
        "{}: its runs have numbers of runs in {}, and no times: the drift is taken as it was in the last fitted run.",
        test.source, fitted.source
    ));
    vec![numerics::max(taken); test.runs()]
}

fn together(all: Vec<Samples>) -> Samples {
    let mut one = Samples::default();
    for samples in all {
        one.places.extend(samples.places);
        one.deviations_um.extend(samples.deviations_um);
        one.runs.extend(samples.runs);
    }
    one
}

/// The targets; evenly spaced knots where there are too many of them, or where they are no grid.
fn knots(test: &Test, notes: &mut Vec<String>) -> Vec<f64> {
    let targets = test.targets_mm();
    let count = if test.is_scattered() {
        let count = test.longest_pass().clamp(SCATTERED_KNOTS.0, SCATTERED_KNOTS.1);
        notes.push(format!(
            "{}: the targets are no grid: each was approached once or twice. Curves over position have {count} knots between them.",
            test.source
        ));
        count
    } else if targets.len() > MAX_KNOTS {
        MAX_KNOTS
    } else {
        return targets;
    };
    let [first, last] = numerics::min_max(targets);
    (0..count).map(|i| first + (last - first) * i as f64 / (count - 1) as f64).collect()
}

/// What evenly spaced targets cannot tell.
fn resolution_note(targets_mm: &[f64]) -> Option<String> {
    let spacing_mm = (1e3 * wave::even_spacing_mm(targets_mm)?).round() / 1e3;
    Some(format!(
        "The targets are {spacing_mm} mm apart: a periodic error of {spacing_mm} mm or a whole fraction of it looks like an offset, one below {} mm like a longer one. Uneven targets tell them apart.",
        2.0 * spacing_mm
    ))
}

/// Errors of a fit at samples, µm.
fn errors<'a>(fit: &'a Fit, grid: &'a Grid, samples: &'a Samples) -> impl Iterator<Item = f64> + 'a {
    samples.places.iter().zip(&samples.deviations_um).map(|(place, um)| um - fit.at(grid, place))
}

fn left<'a>(
    fit: &'a Fit,
    grid: &'a Grid,
    samples: &'a Samples,
    is_fitted: bool,
) -> impl Iterator<Item = Left> + 'a {
    let of = move |(place, um): (&Place, f64)| Left {
        target_mm: place.position_mm,
        sign: place.sign,
        um,
        is_fitted,
    };
    samples.places.iter().zip(errors(fit, grid, samples)).map(of)
}

fn set_reductions(effects: &mut [Effect], fit: &Fit, grid: &Grid, held: &Samples) {
    if held.runs.is_empty() {
        return;
    }
    let after = numerics::rms(errors(fit, grid, held));
    for effect in effects {
        let part = held.places.iter().map(|place| fit.variant.row(grid, place).dot(&effect.part));
        let without = numerics::rms(errors(fit, grid, held).zip(part).map(|(error, part)| error + part));
        effect.validate_reduction_percent = (without > 0.0).then(|| 100.0 * (1.0 - after / without));
    }
}

fn residual(search: &Search<'_>, chosen: &Chosen, samples: &Samples, held: &Samples) -> Residual {
    let of = |fit: Option<&Fit>| {
        let rms = |samples: &Samples| match fit {
            Some(fit) => numerics::rms(errors(fit, search.grid, samples)),
            None => numerics::rms(samples.deviations_um.iter().copied()),
        };
        FitValidate { fit: rms(samples), validate: (!held.runs.is_empty()).then(|| rms(held)) }
    };
    let gap = if search.has_both_ways { Gap::Map } else { Gap::None };
    let table = search.fit(&Variant { mean: Mean::Map, gap, drift: Drift::None });
    Residual {
        before: of(None),
        after: of(Some(&chosen.fit)),
        table: of(table.as_ref()),
        left_out: chosen.left_out_um,
    }
}
