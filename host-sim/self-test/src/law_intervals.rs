//! How often the intervals of a law contain the true values.

use serde_json::Value;

/// How many intervals contain the true value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Intervals {
    /// Intervals that contain it.
    pub right: usize,
    /// All intervals.
    pub all: usize,
}

impl Intervals {
    /// Counts the interval of a true value; `interval`: two numbers of a JSON.
    pub fn add(&mut self, truth: f64, interval: &Value) {
        self.all += 1;
        let ends = interval[0].as_f64().zip(interval[1].as_f64());
        self.right += usize::from(ends.is_some_and(|(low, high)| (low..=high).contains(&truth)));
    }

    /// The sum of some counts.
    #[must_use]
    pub fn sum(all: impl Iterator<Item = Self>) -> Self {
        all.fold(Self::default(), |a, b| Self { right: a.right + b.right, all: a.all + b.all })
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_interval_that_is_missing_does_not_contain_the_truth() {
        let mut counts = Intervals::default();
        for (truth, interval) in [(1.0, json!([0.9, 1.1])), (1.0, json!([1.1, 1.2])), (1.0, Value::Null)] {
            counts.add(truth, &interval);
        }
        assert_eq!(counts, Intervals { right: 1, all: 3 });
        assert_eq!(Intervals::sum([counts; 2].into_iter()), Intervals { right: 2, all: 6 });
    }
}
