//! Small numerical functions that several crates share. It depends on no other crate of this workspace.
//!
//! - [`extremes`]: minimum, maximum, peak to peak, maximum magnitude
//! - [`averages`]: mean, root mean square, standard deviation, median, quantile
//! - [`bins`]: mean of one variable over equal bins of another
//! - [`noise`]: standard normal deviates
//! - [`spectrum`]: power spectrum
//! - [`distributions`]: F test, Student's t, Wilson's interval of a probability
//!
//! Sums run from the first value to the last, in plain f64, so that results are the same bits on every host. `statrs`
//! and `rand_distr` have most of this, but other approximations and another order of draws: recorded results and
//! seeds would change.

pub mod averages;
pub mod bins;
pub mod distributions;
pub mod extremes;
pub mod noise;
pub mod spectrum;

pub use averages::{mean, mean_and_deviation, median, quantile, rms, rms_reduction_percent};
pub use extremes::{max, max_abs, min, min_max, peak_to_peak};
