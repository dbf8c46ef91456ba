//! The figures of ISO 230-2:2014, clause 3 (terms and definitions), from deviations x = actual − target.
//!
//! At each target i, in each direction, with n approaches: mean x̄ and standard deviation s with divisor n − 1. Then
//!
//! - bidirectional mean x̄ᵢ = (x̄ᵢ↑ + x̄ᵢ↓)/2, reversal Bᵢ = x̄ᵢ↑ − x̄ᵢ↓
//! - repeatability Rᵢ↑ = 4·sᵢ↑, Rᵢ↓ = 4·sᵢ↓, Rᵢ = max(2·sᵢ↑ + 2·sᵢ↓ + |Bᵢ|, Rᵢ↑, Rᵢ↓)
//! - of the axis: B = max |Bᵢ|, B̄ = mean of Bᵢ, M = range of x̄ᵢ, E = range of all x̄ᵢ↑ and x̄ᵢ↓, R = max Rᵢ,
//!   A = max(x̄ᵢ + 2·sᵢ) − min(x̄ᵢ − 2·sᵢ) over both directions; A↑, A↓, E↑, E↓, R↑, R↓ of one direction alone.

use serde::Serialize;

use super::measured::{Test, Way};

/// The figures, µm; `None` where the readings do not give one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Bidirectional accuracy.
    #[serde(rename = "A")]
    pub accuracy: Option<f64>,
    /// Accuracy in + direction, A↑.
    #[serde(rename = "A_positive")]
    pub accuracy_positive: Option<f64>,
    /// Accuracy in − direction, A↓.
    #[serde(rename = "A_negative")]
    pub accuracy_negative: Option<f64>,
    /// Bidirectional systematic deviation.
    #[serde(rename = "E")]
    pub systematic: Option<f64>,
    /// Systematic deviation in + direction, E↑.
    #[serde(rename = "E_positive")]
    pub systematic_positive: Option<f64>,
    /// Systematic deviation in − direction, E↓.
    #[serde(rename = "E_negative")]
    pub systematic_negative: Option<f64>,
    /// Range of the mean bidirectional deviation.
    #[serde(rename = "M")]
    pub mean_range: Option<f64>,
    /// Bidirectional repeatability.
    #[serde(rename = "R")]
    pub repeatability: Option<f64>,
    /// Repeatability in + direction, R↑.
    #[serde(rename = "R_positive")]
    pub repeatability_positive: Option<f64>,
    /// Repeatability in − direction, R↓.
    #[serde(rename = "R_negative")]
    pub repeatability_negative: Option<f64>,
    /// Greatest reversal, regardless of its sign.
    #[serde(rename = "B")]
    pub reversal: Option<f64>,
    /// Mean reversal B̄, signed: below zero the axis stops short of where it stops in − direction, as with a gap.
    #[serde(rename = "B_mean")]
    pub mean_reversal: Option<f64>,
}

/// The approaches to a target in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approaches {
    /// Their number.
    pub count: usize,
    /// Mean deviation x̄, µm.
    pub mean_um: f64,
    /// Standard deviation s, µm; `None` of one approach.
    pub deviation_um: Option<f64>,
}

/// A target.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// Where it is, mm.
    pub target_mm: f64,
    /// Its approaches in + and − direction; `None`: there are none.
    pub ways: [Option<Approaches>; 2],
}

impl Position {
    /// Reversal Bᵢ, µm.
    #[must_use]
    pub fn reversal_um(&self) -> Option<f64> {
        let [positive, negative] = self.ways;
        Some(positive?.mean_um - negative?.mean_um)
    }

    /// Mean bidirectional deviation x̄ᵢ, µm.
    #[must_use]
    pub fn mean_um(&self) -> Option<f64> {
        let [positive, negative] = self.ways;
        Some(0.5 * (positive?.mean_um + negative?.mean_um))
    }

    /// Bidirectional repeatability Rᵢ, µm.
    fn repeatability_um(&self) -> Option<f64> {
        let [positive, negative] = self.ways.map(|way| way.and_then(|way| way.deviation_um));
        let (positive, negative) = (positive?, negative?);
        let both = 2.0 * positive + 2.0 * negative + self.reversal_um()?.abs();
        Some(both.max(4.0 * positive).max(4.0 * negative))
    }
}

/// The targets of a test with their approaches.
#[must_use]
pub fn positions(test: &Test) -> Vec<Position> {
    let targets = test.targets_mm();
    let mut deviations: Vec<[Vec<f64>; 2]> = vec![[Vec::new(), Vec::new()]; targets.len()];
    for reading in &test.readings {
        let way = usize::from(reading.way == Way::Negative);
        deviations[nearest(&targets, reading.target_mm)][way].push(reading.deviation_um);
    }
    let of = |(target_mm, ways): (f64, [Vec<f64>; 2])| Position {
        target_mm,
        ways: ways.each_ref().map(|values| approaches(values)),
    };
    targets.into_iter().zip(deviations).map(of).collect()
}

/// Index of the target that is nearest to a position.
pub(crate) fn nearest(targets_mm: &[f64], position_mm: f64) -> usize {
    let distance = |index: &usize| (targets_mm[*index] - position_mm).abs();
    (0..targets_mm.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

fn approaches(values: &[f64]) -> Option<Approaches> {
    if values.is_empty() {
        return None;
    }
    let (mean_um, with_n) = numerics::mean_and_deviation(values);
    let n = values.len() as f64;
    let deviation_um = (values.len() > 1).then(|| with_n * (n / (n - 1.0)).sqrt());
    Some(Approaches { count: values.len(), mean_um, deviation_um })
}

/// The figures of targets, and a line for each that is not given. A figure needs its value at every target.
#[must_use]
pub fn figures(positions: &[Position]) -> (Figures, Vec<String>) {
    let way = |index: usize| positions.iter().map(move |position| position.ways[index]);
    let ends = |index: usize| -> Option<Vec<f64>> {
        let both = way(index).map(|way| {
            let way = way?;
            let spread = 2.0 * way.deviation_um?;
            Some([way.mean_um - spread, way.mean_um + spread])
        });
        Some(both.collect::<Option<Vec<_>>>()?.concat())
    };
    let means = |index: usize| -> Option<Vec<f64>> { way(index).map(|way| Some(way?.mean_um)).collect() };
    let deviations = |index: usize| -> Option<Vec<f64>> { way(index).map(|way| way?.deviation_um).collect() };
    let together = |[a, b]: [Option<Vec<f64>>; 2]| Some(range([a?, b?].concat()));
    let reversals: Option<Vec<f64>> = positions.iter().map(Position::reversal_um).collect();
    let both_means: Option<Vec<f64>> = positions.iter().map(Position::mean_um).collect();
    let repeatabilities: Option<Vec<f64>> = positions.iter().map(Position::repeatability_um).collect();
    let repeatability = |index: usize| deviations(index).map(|s| 4.0 * numerics::max(s));
    let figures = Figures {
        accuracy: together([ends(0), ends(1)]),
        accuracy_positive: ends(0).map(range),
        accuracy_negative: ends(1).map(range),
        systematic: together([means(0), means(1)]),
        systematic_positive: means(0).map(range),
        systematic_negative: means(1).map(range),
        mean_range: both_means.map(range),
        repeatability: repeatabilities.map(numerics::max),
        repeatability_positive: repeatability(0),
        repeatability_negative: repeatability(1),
        reversal: reversals.as_ref().map(|all| numerics::max_abs(all.iter().copied())),
        mean_reversal: reversals.map(numerics::mean),
    };
    (figures, lines(positions))
}

fn range(values: Vec<f64>) -> f64 {
    numerics::peak_to_peak(values)
}

/// A position with all its digits.
fn printed(mm: f64) -> String {
    mm.to_string().replace('-', "−")
}

/// Why figures are not given, and what is not as the standard asks.
fn lines(positions: &[Position]) -> Vec<String> {
    const APPROACHES: usize = 5;
    let mut lines = Vec::new();
    let counts = |index: usize| positions.iter().map(move |at| at.ways[index].map_or(0, |way| way.count));
    for (way, index) in Way::BOTH.into_iter().zip(0..) {
        let at = |is: &dyn Fn(usize) -> bool| {
            positions.iter().zip(counts(index)).find(|(_, count)| is(*count)).map(|(at, _)| at.target_mm)
        };
        let arrow = if way == Way::Positive { '↑' } else { '↓' };
        if counts(index).all(|count| count == 0) {
            lines.push(format!(
                "No approach in {} direction: A, E, M, R, B, B̄, A{arrow}, E{arrow} and R{arrow} are not given.",
                way.word()
            ));
        } else if let Some(mm) = at(&|count| count == 0) {
            lines.push(format!(
                "No approach to {} mm in {} direction: A, E, M, R, B, B̄, A{arrow}, E{arrow} and R{arrow} are not given.",
                printed(mm),
                way.word()
            ));
        } else if let Some(mm) = at(&|count| count == 1) {
            lines.push(format!(
                "One approach to {} mm in {} direction, which has no standard deviation: A, R, A{arrow} and R{arrow} are not given.",
                printed(mm),
                way.word()
            ));
        }
    }
    let all = || (0..2).flat_map(counts).filter(|count| *count > 0);
    let (fewest, most) = (all().min().unwrap_or(0), all().max().unwrap_or(0));
    if fewest != most {
        lines.push(format!(
            "The targets have {fewest} to {most} approaches each: ISO 230-2 asks for as many at each."
        ));
    } else if most < APPROACHES {
        lines.push(format!(
            "{most} approach{} to each target in each direction: ISO 230-2 asks for {APPROACHES}.",
            if most == 1 { "" } else { "es" }
        ));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured::Reading;

    fn test_of(rows: &[(f64, Way, &[f64])]) -> Test {
        let mut readings = Vec::new();
        for (target_mm, way, deviations) in rows {
            readings.extend(deviations.iter().enumerate().map(|(run, um)| Reading {
                run,
                way: *way,
                target_mm: *target_mm,
                deviation_um: *um,
                time_s: None,
                line: run + 2,
            }));
        }
        Test { source: "x.csv".to_owned(), readings, run_numbers: vec![1.0, 2.0, 3.0], notes: Vec::new() }
    }

    /// By hand, with √3 = 1.7321:
    ///
    /// - 0 mm: ↑ 1, 2, 3: x̄ = 2, s = 1. ↓ −1, −1, 2: x̄ = 0, s = √((1 + 1 + 4)/2) = √3. B = 2, mean 1,
    ///   R = max(2 + 2·√3 + 2, 4, 4·√3) = 7.4641
    /// - 100 mm: ↑ 4, 6, 8: x̄ = 6, s = 2. ↓ 7, 7, 7: x̄ = 7, s = 0. B = −1, mean 6.5, R = max(4 + 0 + 1, 8, 0) = 8
    /// - A = (6 + 4) − (0 − 2·√3) = 13.4641, A↑ = 10 − 0, A↓ = 7 + 2·√3, E = 7 − 0, E↑ = 6 − 2, E↓ = 7 − 0, M = 6.5 − 1
    #[test]
    fn figures_are_those_computed_by_hand() {
        let test = test_of(&[
            (0.0, Way::Positive, &[1.0, 2.0, 3.0]),
            (0.0, Way::Negative, &[-1.0, -1.0, 2.0]),
            (100.0, Way::Positive, &[4.0, 6.0, 8.0]),
            (100.0, Way::Negative, &[7.0, 7.0, 7.0]),
        ]);
        let (found, notes) = figures(&positions(&test));
        let root = 3.0_f64.sqrt();
        for (name, value, expected) in [
            ("A", found.accuracy, 10.0 + 2.0 * root),
            ("A↑", found.accuracy_positive, 10.0),
            ("A↓", found.accuracy_negative, 7.0 + 2.0 * root),
            ("E", found.systematic, 7.0),
            ("E↑", found.systematic_positive, 4.0),
            ("E↓", found.systematic_negative, 7.0),
            ("M", found.mean_range, 5.5),
            ("R", found.repeatability, 8.0),
            ("R↑", found.repeatability_positive, 8.0),
            ("R↓", found.repeatability_negative, 4.0 * root),
            ("B", found.reversal, 2.0),
            ("B̄", found.mean_reversal, 0.5),
        ] {
            assert!((value.unwrap() - expected).abs() < 1e-12, "{name}: {value:?}");
        }
        assert_eq!(notes, ["3 approaches to each target in each direction: ISO 230-2 asks for 5."]);
    }

    #[test]
    fn what_cannot_be_given_is_none_with_a_line() {
        let one_way = test_of(&[(0.0, Way::Positive, &[1.0, 2.0]), (10.0, Way::Positive, &[0.0, 0.0])]);
        let (found, notes) = figures(&positions(&one_way));
        assert_eq!((found.accuracy, found.reversal, found.systematic_negative), (None, None, None));
        assert!(
            (found.systematic_positive.unwrap() - 1.5).abs() < 1e-12 && found.accuracy_positive.is_some()
        );
        assert!(notes[0].starts_with("No approach in − direction: A, E, M, R, B, B̄, A↓"), "{notes:?}");
        let once = test_of(&[(-5.0, Way::Positive, &[1.0]), (10.0, Way::Positive, &[0.0, 0.0])]);
        let (found, notes) = figures(&positions(&once));
        assert!(found.accuracy_positive.is_none() && found.systematic_positive.is_some());
        assert!(notes[0].starts_with("One approach to −5 mm in + direction"), "{notes:?}");
        assert!(notes.iter().any(|note| note.contains("1 to 2 approaches each")), "{notes:?}");
    }
}
