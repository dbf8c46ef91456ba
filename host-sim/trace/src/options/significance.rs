//! The threshold of significance for few blocks.

use numerics::distributions::{f_test_p_value, student_t_beyond};

use super::SearchOptions;

/// Number of blocks of each log that is long enough for it. Standard errors are computed from the scatter of the blocks.
pub const BLOCKS: usize = 24;

impl SearchOptions {
    /// [`Self::min_t`] for a standard error from this number of blocks: Student's t that is exceeded with the same probability
    /// as that threshold is with the blocks of one log.
    #[must_use]
    pub fn min_t_of(&self, blocks: usize) -> f64 {
        match blocks {
            0 | 1 => f64::INFINITY,
            BLOCKS.. => self.min_t,
            _ => {
                let probability = f_test_p_value(self.min_t.powi(2), 1, BLOCKS - 1);
                student_t_beyond(probability, blocks - 1)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::options::TraceOptions;

    /// One standard error of a mean of two blocks exceeds t with the probability 1/2 − atan(t)/π per tail.
    #[test]
    fn few_blocks_must_show_more() {
        let search = TraceOptions::default().search;
        assert_eq!([24, 72].map(|blocks| search.min_t_of(blocks).to_bits()), [search.min_t.to_bits(); 2]);
        // Printed tables, two tails: with 23 degrees of freedom 3.485 at 0.2 %, with 4 7.173, with 10 4.144.
        for (blocks, at_least, at_most) in [(5, 7.1, 7.4), (11, 4.1, 4.2)] {
            let t = search.min_t_of(blocks);
            assert!((at_least..at_most).contains(&t), "{blocks}: {t}");
        }
        assert!(search.min_t_of(2) > 300.0 && search.min_t_of(1).is_infinite());
    }
}
