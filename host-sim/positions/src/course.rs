//! The course of a drift over the clock of a test: how much of it has happened at a time.

/// What the clock of a test counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Seconds of the session.
    Seconds,
    /// Runs: the file has no times.
    Runs,
}

/// A course that is 0 at the first instant of the fitted runs and 1 at the last one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// Time constant; `None`: a straight line.
    pub time_constant: Option<f64>,
    /// First and last instant of the fitted runs.
    pub span: [f64; 2],
}

impl Course {
    /// The course at an instant. A straight line is not drawn on for longer than the runs took.
    #[must_use]
    pub fn at(&self, instant: f64) -> f64 {
        let [first, last] = self.span;
        let length = (last - first).max(f64::MIN_POSITIVE);
        let elapsed = (instant - first).clamp(-length, 2.0 * length);
        match self.time_constant {
            None => elapsed / length,
            Some(constant) => libm::expm1(-elapsed / constant) / libm::expm1(-length / constant),
        }
    }

    /// Time constants that are tried: from a twentieth of the span to eight times the span, by a factor of 1.1.
    #[must_use]
    pub fn tried(span: [f64; 2]) -> Vec<f64> {
        const STEP: f64 = 1.1;
        let length = span[1] - span[0];
        let mut all = vec![0.05 * length];
        while let Some(last) = all.last().filter(|last| **last < 8.0 * length) {
            all.push(STEP * last);
        }
        all
    }

    /// The course of a warm-up whose end the runs do not show: it has not ended, and lasts as long as the runs, each of which takes its
    /// part of the clock. A straight line would go on for ever.
    #[must_use]
    pub fn unknown(span: [f64; 2], runs: usize) -> Self {
        let length = span[1] - span[0];
        let n = runs as f64;
        Self { time_constant: Some(length * n / (n - 1.0).max(1.0)), span }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_0_at_the_first_instant_and_1_at_the_last() {
        for time_constant in [None, Some(0.5), Some(3.0), Some(100.0)] {
            let course = Course { time_constant, span: [1.0, 5.0] };
            assert!(course.at(1.0).abs() < 1e-12 && (course.at(5.0) - 1.0).abs() < 1e-12, "{course:?}");
        }
    }

    /// By hand: (1 − exp(−2))/(1 − exp(−1)) = 1.36788 at twice the span, with a time constant of one span.
    #[test]
    fn it_goes_on_as_its_equation_and_a_line_ends_after_another_span() {
        let course = Course { time_constant: Some(4.0), span: [0.0, 4.0] };
        assert!((course.at(8.0) - 1.367_88).abs() < 1e-5);
        let line = Course { time_constant: None, ..course };
        assert!((line.at(6.0) - 1.5).abs() < 1e-12 && (line.at(100.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_warm_up_of_three_runs_lasts_three_runs() {
        assert_eq!(Course::unknown([1.0, 3.0], 3).time_constant, Some(3.0));
        assert_eq!(Course::unknown([0.0, 800.0], 5).time_constant, Some(1000.0));
    }
}
