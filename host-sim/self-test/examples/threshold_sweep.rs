//! What each threshold of the tracer does: the self-test with every option halved, and doubled.
//!
//! `cargo run --release -p self-test --example threshold_sweep -- CASES [FIRST_CASE] [SEED]`
//!
//! The origin of the lines of evidence in `trace/src/options.rs`. Every case is drawn once and traced with the defaults,
//! then twice for each option. Prints a line for each trace whose effects or descriptions differ from those with the
//! defaults, then a table: the number of cases that differ at all, and the changes of the counts.

use std::error::Error;

use rayon::prelude::*;
use self_test::case::Case;
use self_test::score::Outcome;
use self_test::trace_and_score_with;
use trace::TraceOptions;

/// The factors that every option is multiplied by.
const FACTORS: [f64; 2] = [0.5, 2.0];

/// An option multiplied by a factor.
#[derive(Clone, Copy)]
struct Setting {
    name: &'static str,
    factor: f64,
}

/// Sums over cases, as differences to the default options.
#[derive(Clone, Copy, Default)]
struct Difference {
    /// Cases whose JSON differs, if only in the last digits.
    changed: usize,
    /// Cases whose logs are refused.
    refused: usize,
    exact: isize,
    missed: isize,
    false_finds: isize,
    described: isize,
    /// Parameters whose 95 % confidence interval contains the true value.
    covered: isize,
}

impl Difference {
    fn add(&mut self, base: &Outcome, outcome: Option<&Outcome>) {
        let Some(outcome) = outcome else {
            self.refused += 1;
            return;
        };
        let count = |of: &dyn Fn(&Outcome) -> usize| of(outcome).cast_signed() - of(base).cast_signed();
        self.changed += usize::from(outcome != base);
        self.exact += count(&|o| usize::from(o.is_exact()));
        self.missed += count(&|o| o.missed().len());
        self.false_finds += count(&|o| o.false_finds().len());
        self.described += count(&|o| o.described.iter().filter(|described| **described).count());
        self.covered += count(&|o| o.estimates.iter().filter(|estimate| estimate.is_covered()).count());
    }
}

/// What a trace is judged by: the effects that it misses, those that it adds, and what it describes.
fn judgement(outcome: &Outcome) -> String {
    let missed: Vec<String> = outcome.missed().iter().map(|t| format!("{} {}", t.name, t.axis)).collect();
    let added: Vec<String> =
        outcome.false_finds().iter().map(|(name, axis)| format!("{name} {axis}")).collect();
    format!("missed {missed:?}, false {added:?}, described {:?}", outcome.described)
}

fn main() -> Result<(), Box<dyn Error>> {
    let numbers: Vec<u64> = std::env::args().skip(1).map(|text| text.parse()).collect::<Result<_, _>>()?;
    let cases = *numbers.first().ok_or("expected the number of cases")?;
    let first = numbers.get(1).copied().unwrap_or(1);
    let seed = numbers.get(2).copied().unwrap_or(1);
    let defaults = TraceOptions::default();
    let settings: Vec<Setting> =
        TraceOptions::NAMES.iter().flat_map(|&name| FACTORS.map(|factor| Setting { name, factor })).collect();
    let mut differences = vec![Difference::default(); settings.len()];
    for number in first..first + cases {
        let case = Case::draw(seed, number)?;
        let score = |options: &TraceOptions| trace_and_score_with(options, &case, &|_| {});
        let base = score(&defaults)?;
        println!("case {number}: {}", judgement(&base));
        let scaled =
            |setting: &Setting| defaults.scaled(setting.name, setting.factor).map(|o| score(&o).ok());
        let outcomes: Vec<_> = settings.par_iter().filter_map(scaled).collect();
        for ((setting, difference), outcome) in settings.iter().zip(&mut differences).zip(&outcomes) {
            difference.add(&base, outcome.as_ref());
            let judged = outcome.as_ref().map_or_else(|| "refused".to_owned(), judgement);
            if judged != judgement(&base) {
                println!("case {number}, {} x {}: {judged}", setting.name, setting.factor);
            }
        }
    }
    println!("\n{:40} factor changed refused exact missed false described covered", "option");
    for (Setting { name, factor }, d) in settings.iter().zip(&differences) {
        println!(
            "{name:40} {factor:6} {:7} {:7} {:+5} {:+6} {:+5} {:+9} {:+7}",
            d.changed, d.refused, d.exact, d.missed, d.false_finds, d.described, d.covered
        );
    }
    Ok(())
}
