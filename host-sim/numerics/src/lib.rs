//! Numerical functions that several crates share. The crate depends on no other crate of this workspace.
//!
//! - [`extremes`]: minimum, maximum, peak to peak, largest absolute value, the minima beside a maximum
//! - [`averages`]: mean, root mean square, standard deviation, median, quantile
//! - [`bins`]: mean of one variable over equal bins of another
//! - [`noise`]: standard normal deviates
//! - [`periodic`]: values that repeat with a period, such as angles
//! - [`resample`]: a sampled signal, delayed
//! - [`spectrum`]: power spectrum
//! - [`distributions`]: F test, Student's t, Wilson's interval of a probability
//!
//! Sums are computed in f64 from the first value to the last, so that results are bit-identical on every host. `statrs` and
//! `rand_distr` contain most of these functions, but with other approximations and another order of random draws: recorded
//! results and the meaning of seeds would change.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod averages;
pub mod bins;
pub mod distributions;
pub mod extremes;
pub mod noise;
pub mod periodic;
pub mod resample;
pub mod spectrum;

pub use averages::{
    mean, mean_and_deviation, median, quantile, rms, rms_reduction_percent, squares_of_difference,
};
pub use extremes::{max, max_abs, min, min_max, peak_to_peak, saddle};
pub use periodic::wrapped;
