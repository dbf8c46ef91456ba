//! A positioning test: the readings of a laser at targets that were approached from both sides, run by run.

use files::error::InputError;

/// The direction in which a target is approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// In + direction, ↑ in ISO 230-2.
    Positive,
    /// In − direction, ↓ in ISO 230-2.
    Negative,
}

impl Way {
    /// Both, + first.
    pub const BOTH: [Self; 2] = [Self::Positive, Self::Negative];

    /// +1 or −1.
    #[must_use]
    pub const fn sign(self) -> f64 {
        match self {
            Self::Positive => 1.0,
            Self::Negative => -1.0,
        }
    }

    /// As it is printed.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Positive => "+",
            Self::Negative => "−",
        }
    }
}

/// One reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Index of the run, in the order of the file.
    pub run: usize,
    /// Direction of the approach.
    pub way: Way,
    /// Where the axis was sent, mm.
    pub target_mm: f64,
    /// Actual position less target, µm; positive: the axis went too far in + direction.
    pub deviation_um: f64,
    /// Time on the clock of the session, s, if the file has it.
    pub time_s: Option<f64>,
    /// Line of the file, counted from 1.
    pub line: usize,
}

/// The readings of one file or of several.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// Name of the file, for messages; of several, that of the first.
    pub source: String,
    /// The readings in the order of the file.
    pub readings: Vec<Reading>,
    /// The number of each run as the file has it; NaN if it is a word.
    pub run_numbers: Vec<f64>,
    /// What was assumed, changed and left out, a sentence each.
    pub notes: Vec<String>,
}

impl Test {
    /// Number of runs.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.run_numbers.len()
    }

    /// The targets in ascending order, each once, mm. Targets that differ by less than a tenth of the usual distance are one, at their
    /// mean: some controls log the command, which jitters by its resolution.
    #[must_use]
    pub fn targets_mm(&self) -> Vec<f64> {
        let mut all: Vec<f64> = self.readings.iter().map(|reading| reading.target_mm).collect();
        all.sort_by(f64::total_cmp);
        let near_mm = self.near_mm();
        let groups: Vec<&[f64]> = all.chunk_by(|a, b| b - a <= near_mm).collect();
        let width_mm = |group: &&[f64]| group[group.len() - 1] - group[0];
        // Targets that are everywhere are no grid, and stay as they are.
        if groups.iter().any(|group| width_mm(group) > 2.0 * near_mm) {
            all.dedup();
            return all;
        }
        groups.into_iter().map(|group| numerics::mean(group.iter().copied())).collect()
    }

    /// Whether most targets are approached only once: they are no grid.
    #[must_use]
    pub fn is_scattered(&self) -> bool {
        self.targets_mm().len() > 2 * self.longest_pass()
    }

    /// Greatest number of readings of a run in one direction.
    #[must_use]
    pub fn longest_pass(&self) -> usize {
        self.passes().iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Distance within which two targets are one, mm: a tenth of the usual distance, and less than that of any two of one pass.
    fn near_mm(&self) -> f64 {
        const FRACTION: f64 = 0.1;
        const OF_LEAST: f64 = 0.3;
        let most = self.longest_pass().max(2);
        let travel_mm = numerics::peak_to_peak(self.readings.iter().map(|reading| reading.target_mm));
        let usual_mm = travel_mm / (most - 1) as f64;
        let steps_mm = self.passes().into_iter().flat_map(|mut pass| {
            pass.sort_by(f64::total_cmp);
            pass.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>()
        });
        let least_mm = numerics::min(steps_mm.filter(|step| *step > 0.0));
        (FRACTION * usual_mm).min(OF_LEAST * least_mm)
    }

    /// The targets of each run in each direction that has any, mm.
    fn passes(&self) -> Vec<Vec<f64>> {
        let of = |run: usize, way: Way| -> Vec<f64> {
            let of_pass =
                self.readings.iter().filter(move |reading| reading.run == run && reading.way == way);
            of_pass.map(|reading| reading.target_mm).collect()
        };
        let all = (0..self.runs()).flat_map(|run| Way::BOTH.map(|way| of(run, way)));
        all.filter(|pass| !pass.is_empty()).collect()
    }

    /// Whether there are readings in both directions.
    #[must_use]
    pub fn has_both_ways(&self) -> bool {
        Way::BOTH.into_iter().all(|way| self.readings.iter().any(|reading| reading.way == way))
    }

    /// Whether every reading has a time.
    #[must_use]
    pub fn has_times(&self) -> bool {
        self.readings.iter().all(|reading| reading.time_s.is_some())
    }

    /// These readings, followed by those of another file. Runs whose numbers are there already are counted on.
    #[must_use]
    pub fn followed_by(mut self, other: Self) -> Self {
        let before = self.runs();
        let last = numerics::max(self.run_numbers.iter().copied());
        let goes_on = other.run_numbers.iter().all(|number| *number > last);
        let numbers = (1..=other.runs()).map(|count| last + count as f64);
        self.run_numbers.extend(if goes_on { other.run_numbers.clone() } else { numbers.collect() });
        if !goes_on {
            self.notes.push(format!(
                "{}: the numbers of its runs begin again; its runs are taken as measured after those before.",
                other.source
            ));
        }
        self.readings
            .extend(other.readings.iter().map(|reading| Reading { run: reading.run + before, ..*reading }));
        self.notes.extend(other.notes);
        self
    }

    /// Refuses what no figure and no effect can be taken from.
    ///
    /// # Errors
    /// Fewer than two targets.
    pub fn checked(self) -> Result<Self, InputError> {
        let targets = self.targets_mm().len();
        if targets < 2 {
            let expected = "readings at two targets or more";
            return Err(InputError::expected(&self.source, expected, targets));
        }
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test_of(targets_mm: &[&[f64]], run_numbers: &[f64]) -> Test {
        let mut readings = Vec::new();
        for (run, targets) in targets_mm.iter().enumerate() {
            readings.extend(targets.iter().map(|target_mm| Reading {
                run,
                way: Way::Positive,
                target_mm: *target_mm,
                deviation_um: 0.0,
                time_s: None,
                line: 2,
            }));
        }
        Test { source: "x.csv".to_owned(), readings, run_numbers: run_numbers.to_vec(), notes: Vec::new() }
    }

    #[test]
    fn targets_that_jitter_are_one_and_targets_that_are_everywhere_are_no_grid() {
        let jitter = test_of(&[&[0.0, 10.0, 20.0], &[0.002, 9.998, 20.0]], &[1.0, 2.0]);
        let targets = jitter.targets_mm();
        assert!(
            targets.len() == 3 && (targets[1] - 9.999).abs() < 1e-9 && !jitter.is_scattered(),
            "{targets:?}"
        );
        let everywhere =
            test_of(&[&[0.0, 7.0, 20.0], &[1.1, 5.8, 17.0], &[2.2, 4.6, 14.0]], &[1.0, 2.0, 3.0]);
        assert!(everywhere.targets_mm().len() == 9 && everywhere.is_scattered());
        let dense = test_of(&[&[0.0, 1.0, 2.0, 500.0, 1000.0], &[0.0, 1.0, 2.0, 500.0, 1000.0]], &[1.0, 2.0]);
        assert_eq!(dense.targets_mm(), [0.0, 1.0, 2.0, 500.0, 1000.0]);
    }

    #[test]
    fn runs_of_a_second_file_follow_and_are_counted_on_if_their_numbers_begin_again() {
        let first = || test_of(&[&[0.0, 1.0], &[0.0, 1.0]], &[1.0, 2.0]);
        let goes_on = first().followed_by(test_of(&[&[0.0, 1.0]], &[5.0]));
        assert_eq!((goes_on.run_numbers, goes_on.readings[4].run), (vec![1.0, 2.0, 5.0], 2));
        assert!(goes_on.notes.is_empty());
        let again = first().followed_by(test_of(&[&[0.0, 1.0]], &[1.0]));
        assert!(again.run_numbers == [1.0, 2.0, 3.0] && again.notes.len() == 1);
    }
}
