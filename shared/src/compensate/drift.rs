//! Thermal drift: a displacement of the tool over the time since the compensation was set.
//!
//! Time is a count of ticks, an integer, which does not lose precision in a long session. A [`Table`] is used for the values,
//! with one nanometre on its position axis for one tick: 100 m are then 10¹¹ ticks, 57 days at 20 kHz.

use super::names::DRIFT;
use super::settings::{Points, TimePoints};
use super::table::{Table, ValueRange};
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::{LENGTH_M, PER_NM, Position};

/// Metres on the axis of the table per tick.
const M_PER_TICK: f64 = 1e-9;

/// Greatest number of ticks, so that the position on the axis does not overflow.
const MAX_TICKS: u64 = i64::MAX.unsigned_abs() / PER_NM.unsigned_abs() / 2;

/// The displacement over the time, error units.
#[derive(Clone, Copy, Debug)]
pub struct Drift<S: Scalar>(Table<S>);

impl<S: Scalar> Drift<S> {
    /// From settings, for ticks every 1/`tick_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] with a setting of `drift`: as [`Table::new`]; the values have to cover from 1100 to 10¹¹ ticks.
    pub fn new(settings: &TimePoints, tick_hz: f64, bound_m: f64) -> Result<Self, ConfigError> {
        let axis_m_per_s = tick_hz * M_PER_TICK;
        let points = Points {
            start_m: settings.start_s * axis_m_per_s,
            spacing_m: settings.spacing_s * axis_m_per_s,
            values: settings.values.clone(),
        };
        let seconds = |error| match error {
            ConfigError::OutOfRange { name, min, max } if [DRIFT.start, DRIFT.spacing].contains(&name) => {
                ConfigError::OutOfRange { name, min: min / axis_m_per_s, max: max / axis_m_per_s }
            }
            other => other,
        };
        let range = ValueRange { unit: LENGTH_M, bound: bound_m };
        Ok(Self(Table::new(&DRIFT, &points, range).map_err(seconds)?))
    }

    /// Correction of the command, error units: − the displacement after a number of ticks.
    #[must_use]
    pub fn correction(&self, ticks: u64) -> S {
        -self.0.at(Position(ticks.min(MAX_TICKS).cast_signed() * PER_NM))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;

    /// 20 µm·(1 − e^(−t/τ)) with τ = 600 s in 64 points over 3000 s, at 20 kHz: linear between points, off by at most
    /// (47.6 s/τ)²/8 of 20 µm, 16 nm; the number of ticks, 6·10⁷, is resolved to 2⁻²⁹ of the span.
    fn worst_nm<S: Scalar>() -> f64 {
        let drift_m = |t: f64| 20e-6 * -(-t / 600.0).exp_m1();
        let spacing_s = 3000.0 / 63.0;
        let values = (0..64).map(|k| drift_m(spacing_s * f64::from(k))).collect();
        let settings = TimePoints { start_s: 0.0, spacing_s, values };
        let drift = Drift::<S>::new(&settings, 20_000.0, 1e-3).unwrap();
        let mut worst = 0.0f64;
        for second in (0u32..3000).step_by(7) {
            let correction_m = drift.correction(u64::from(second) * 20_000).value() * LENGTH_M;
            worst = worst.max((correction_m + drift_m(second.into())).abs() * 1e9);
        }
        worst
    }

    #[test]
    fn the_correction_follows_the_time() {
        for worst in [worst_nm::<Fixed>(), worst_nm::<f32>(), worst_nm::<f64>()] {
            assert!((10.0..16.0).contains(&worst), "{worst}");
        }
    }

    /// In 20 days at 20 kHz, 3.5·10¹⁰ ticks, a second of a slope is still resolved; the last value is kept for ever, and the
    /// first before its time.
    #[test]
    fn a_long_session_loses_no_precision() {
        let day = 86_400.0;
        let values = [1e-6, 1e-6, 5e-6].into_iter().collect();
        let settings = TimePoints { start_s: 18.0 * day, spacing_s: day, values };
        let drift = Drift::<f64>::new(&settings, 20_000.0, 1e-3).unwrap();
        let at = |s: f64| {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive")]
            let ticks = (s * 20_000.0) as u64;
            drift.correction(ticks).value() * -LENGTH_M
        };
        assert!((at(0.0) - 1e-6).abs() < 1e-15);
        // The position within two days is resolved to 2⁻²⁹ of them, 0.32 ms; half a second of 4 µm a day is 23 pm.
        for later in [0.0, 0.5, 100.0, 43_200.0] {
            let exact = 1e-6 + 4e-6 * later / day;
            assert!((at(19.0 * day + later) - exact).abs() < 1e-13, "{later}");
        }
        // The index is resolved to 2⁻²⁵ of the two intervals: 4 µm of 2⁻²⁴.
        assert!((drift.correction(u64::MAX).value() * LENGTH_M + 5e-6).abs() < 3e-13);
    }

    #[test]
    fn rejected_times_are_named_in_seconds() {
        let new = |start_s, spacing_s| {
            let values = [0.0, 1e-6].into_iter().collect();
            Drift::<Fixed>::new(&TimePoints { start_s, spacing_s, values }, 20_000.0, 1e-3).err()
        };
        assert_eq!(new(-100.0, 10.0), None);
        // 100 m of the table are 10¹¹ ticks, 5·10⁶ s.
        let of_spacing = [(0.0, 1e9), (0.0, 0.0), (0.0, -1.0)].map(|times| (times, "drift.spacing_s"));
        let of_start = [(1e9, 1.0), (f64::NAN, 1.0)].map(|times| (times, "drift.start_s"));
        for ((start_s, spacing_s), setting) in of_spacing.into_iter().chain(of_start) {
            let error = new(start_s, spacing_s);
            assert!(
                matches!(error, Some(ConfigError::OutOfRange { name, max, .. }) if name == setting && max > 4.9e6 && max < 5.1e6),
                "{error:?}"
            );
        }
    }
}
