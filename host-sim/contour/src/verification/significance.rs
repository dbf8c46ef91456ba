//! Whether two contour errors differ by more than chance.
//!
//! The mean square of an error e that is measured with white noise of deviation σ at n samples has a standard error of
//! √((4·e²·σ² + 2·σ⁴)/n). The noise is that of the logs themselves. What else differs between two runs of the same machine
//! (friction, temperature) is covered by a fixed fraction.

use crate::evaluation::ContourError;

/// Smallest change of the rms that counts, as a fraction of the rms before.
pub const MIN_CHANGE_FRACTION: f64 = 0.05;

/// Smallest change of the mean square that counts, in standard errors of the difference.
const MIN_STANDARD_ERRORS: f64 = 2.0;

/// Whether the rms after is larger than before by more than 5 % and by more than two standard errors.
#[must_use]
pub fn is_worse(before: &ContourError, after: &ContourError) -> bool {
    after.rms_um > (1.0 + MIN_CHANGE_FRACTION) * before.rms_um && is_significant(before, after)
}

/// Whether the rms after is smaller than before by more than 5 % and by more than two standard errors.
#[must_use]
pub fn is_better(before: &ContourError, after: &ContourError) -> bool {
    after.rms_um < (1.0 - MIN_CHANGE_FRACTION) * before.rms_um && is_significant(before, after)
}

/// Standard error of the rms from the sensors' noise, µm.
#[must_use]
pub fn rms_standard_error_um(error: &ContourError) -> f64 {
    if error.rms_um > 0.0 { 0.5 * mean_square_standard_error(error) / error.rms_um } else { 0.0 }
}

fn is_significant(before: &ContourError, after: &ContourError) -> bool {
    let difference = (after.rms_um.powi(2) - before.rms_um.powi(2)).abs();
    let standard_error = mean_square_standard_error(before).hypot(mean_square_standard_error(after));
    difference > MIN_STANDARD_ERRORS * standard_error
}

/// Standard error of the mean square, µm².
fn mean_square_standard_error(error: &ContourError) -> f64 {
    let noise = error.noise_um.powi(2);
    // The rms contains the noise.
    let without_noise = (error.rms_um.powi(2) - noise).max(0.0);
    ((4.0 * without_noise * noise + 2.0 * noise.powi(2)) / error.samples.max(1) as f64).sqrt()
}
