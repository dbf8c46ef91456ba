//! Whether two contour errors differ by more than chance, both without the noise of the sensors.
//!
//! The mean square of an error e that is measured with white noise of deviation σ at n samples is e² + σ². From it the estimate of
//! σ² by third differences is subtracted. With c = (1, −3, 3, −1) their autocorrelations are −15/20, 6/20 and −1/20, so that
//! the estimate has the variance 2·(1 + 2·(0.75² + 0.3² + 0.05²))·σ⁴/n = 4.62·σ⁴/n, the mean square of the noise 2·σ⁴/n, and
//! both have the covariance 2·σ⁴/n. The difference has the standard error √((4·e²·σ² + 2.62·σ⁴)/n). What else differs between two
//! runs of the same machine (friction, temperature) is covered by a fixed fraction.

use crate::evaluation::ContourError;

/// Smallest change of the rms that counts, as a fraction of the rms before.
pub const MIN_CHANGE_FRACTION: f64 = 0.05;

/// Smallest change of the mean square that counts, in standard errors of the difference.
const MIN_STANDARD_ERRORS: f64 = 2.0;

/// Variance of the mean square of noise less its estimate, σ⁴/n.
const NOISE_VARIANCE: f64 = 2.62;

/// Whether the rms without noise is larger after than before by more than 5 % and by more than two standard errors.
#[must_use]
pub fn is_worse(before: &ContourError, after: &ContourError) -> bool {
    after.rms_without_noise_um() > (1.0 + MIN_CHANGE_FRACTION) * before.rms_without_noise_um()
        && is_significant(before, after)
}

/// Whether the rms without noise is smaller after than before by more than 5 % and by more than two standard errors.
#[must_use]
pub fn is_better(before: &ContourError, after: &ContourError) -> bool {
    after.rms_without_noise_um() < (1.0 - MIN_CHANGE_FRACTION) * before.rms_without_noise_um()
        && is_significant(before, after)
}

/// By how much the rms without noise may be too small by chance, µm: two standard errors of its square.
#[must_use]
pub fn rms_uncertainty_um(error: &ContourError) -> f64 {
    let rms_um = error.rms_without_noise_um();
    let most_um2 = rms_um.powi(2) + MIN_STANDARD_ERRORS * mean_square_standard_error(error);
    most_um2.sqrt() - rms_um
}

/// Whether the mean square without noise is larger after than before by more than two standard errors.
#[must_use]
pub fn is_larger(before: &ContourError, after: &ContourError) -> bool {
    after.mean_square_um2() > before.mean_square_um2() && is_significant(before, after)
}

fn is_significant(before: &ContourError, after: &ContourError) -> bool {
    let difference = (after.mean_square_um2() - before.mean_square_um2()).abs();
    let standard_error = libm::hypot(mean_square_standard_error(before), mean_square_standard_error(after));
    difference > MIN_STANDARD_ERRORS * standard_error
}

/// Standard error of the mean square without noise, µm².
fn mean_square_standard_error(error: &ContourError) -> f64 {
    let noise = error.noise_um.powi(2);
    let without_noise = error.mean_square_um2().max(0.0);
    ((4.0 * without_noise * noise + NOISE_VARIANCE * noise.powi(2)) / error.samples.max(1) as f64).sqrt()
}
