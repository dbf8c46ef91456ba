//! Resonances from accelerations at the tool.
//!
//! The tool follows the machine below it as a second-order mode, so that the acceleration of the tool over that of the machine is the
//! transmissibility (Den Hartog, Mechanical Vibrations, 1956, section 2.12), with r = f/f₀:
//!
//! |T|² = (1 + (2ζr)²) / ((1 − r²)² + (2ζr)²)
//!
//! A sensor shows the product of |T|² and of the density of the excitation, which it does not show. Two excitations are in use: one of
//! constant density (a tap, motions of any kind), and a sweep whose acceleration grows with its frequency (Klipper's
//! `TEST_RESONANCES`), of density ∝ f². [`mode`] fits the peaks of the [`Density`] with both, and the interval covers both. A peak
//! narrower than the spectrum resolves may be a forced vibration, and one that is not shaped as a mode is not told as one.

pub mod json;
pub mod mode;
pub mod text;

use numerics::spectrum::{Density, density};

use mode::Peak;

/// Distance of the frequencies that is aimed at, Hz.
const STEP_HZ: f64 = 0.8;

/// Fewest segments of a spectrum: half of them overlap.
const FEWEST_SEGMENTS: usize = 5;

/// Peaks are searched from this frequency on, Hz: below it motions show.
const LOWEST_HZ: f64 = 5.0;

/// Share of the sample rate up to which peaks are searched: above it, the filter of a sensor shows.
const HIGHEST_SHARE: f64 = 0.4;

/// What one axis of the sensor shows.
#[derive(Clone, Debug)]
pub struct AxisResonances {
    /// Axis of the sensor.
    pub axis: String,
    /// Power spectral density, (m/s²)²/Hz.
    pub density: Density,
    /// Peaks, the one with the largest acceleration first.
    pub peaks: Vec<Peak>,
}

/// The resonances that an axis of a sensor shows; accelerations in m/s². `None` if there are fewer than 3 s of them, or fewer than 60
/// samples per second.
#[must_use]
pub fn of_axis(axis: &str, accelerations_m_per_s2: &[f64], rate_hz: f64) -> Option<AxisResonances> {
    let too_short = (accelerations_m_per_s2.len() as f64) < 3.0 * rate_hz;
    if too_short || rate_hz < 60.0 {
        return None;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples")]
    let wanted = (rate_hz / STEP_HZ) as usize;
    let longest = 2 * accelerations_m_per_s2.len() / (FEWEST_SEGMENTS + 1);
    let length = wanted.min(longest).max(16) & !1;
    let density = density(accelerations_m_per_s2, rate_hz, length)?;
    let mut peaks = mode::peaks(&density, LOWEST_HZ..HIGHEST_SHARE * rate_hz);
    peaks.sort_by(|a, b| b.rms_m_per_s2.total_cmp(&a.rms_m_per_s2));
    Some(AxisResonances { axis: axis.to_owned(), density, peaks })
}
