//! The comparison of what was found with the truth.

use circle::Analysis;

use super::generator::{Circle, Truth};

/// Intervals that contain the truth, and all.
#[derive(Clone, Copy, Debug, Default)]
pub struct Coverage {
    pub covered: usize,
    pub all: usize,
}

impl Coverage {
    pub fn add(&mut self, other: Self) {
        self.covered += other.covered;
        self.all += other.all;
    }

    pub fn fraction(self) -> f64 {
        self.covered as f64 / self.all as f64
    }
}

/// What is wrong: true parts off by more than a fraction of the greatest, and parts called certain that are not there. Intervals of the
/// true parts that were found are counted.
pub fn judge(analysis: &Analysis, truth: &[Truth], fraction: f64) -> (Vec<String>, Coverage) {
    let greatest = truth.iter().map(|part| part.um).fold(0.0, f64::max);
    let mut wrong = Vec::new();
    let mut coverage = Coverage::default();
    for part in truth {
        let found = analysis.parts.iter().find(|f| f.name.word() == part.name && f.axis == part.axis);
        let um = found.map_or(0.0, |found| found.um);
        if (um - part.um).abs() > fraction * greatest {
            wrong.push(format!("{} {}: {um:.3} instead of {:.3}", part.name, part.axis, part.um));
        }
        if let Some(found) = found {
            coverage.all += 1;
            coverage.covered += usize::from((found.ci95[0]..=found.ci95[1]).contains(&part.um));
        }
    }
    for found in &analysis.parts {
        let is_true = truth.iter().any(|part| found.name.word() == part.name && found.axis == part.axis);
        if !is_true && found.is_certain() && found.um > fraction * greatest {
            wrong.push(format!("{} {}: {:.3} is not there", found.name.word(), found.axis, found.um));
        }
    }
    (wrong, coverage)
}

/// Judges what is found of circles with seeds from 100, and returns the coverage of the intervals.
pub fn sweep(seeds: u64, correlation_s: f64, found: impl Fn(&Circle) -> Analysis) -> Coverage {
    let mut coverage = Coverage::default();
    let mut all = Vec::new();
    for seed in 100..100 + seeds {
        let circle = Circle::random(seed, correlation_s);
        let truth: Vec<Truth> = circle.parts.iter().map(|part| circle.truth(part)).collect();
        let (wrong, covered) = judge(&found(&circle), &truth, 0.05);
        if !wrong.is_empty() {
            all.push(format!("seed {seed}: {wrong:?} {:?}", circle.parts));
        }
        coverage.add(covered);
    }
    assert!(all.is_empty(), "{} of {seeds}: {}", all.len(), all.join("\n"));
    coverage
}
