//! The temperature of a guide over time, on which its friction may depend.

use std::sync::Arc;

/// Temperatures at equally spaced times.
#[derive(Clone, Debug)]
pub struct GuideTemperature {
    start_s: f64,
    sample_s: f64,
    celsius: Arc<[f64]>,
}

/// Of the same measurement: equal curves of different ones count as different.
impl PartialEq for GuideTemperature {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.celsius, &other.celsius)
    }
}

impl GuideTemperature {
    /// Temperatures (°C) from a time on the session clock on, both in s. `None` without any.
    #[must_use]
    pub fn new(start_s: f64, sample_s: f64, celsius: Vec<f64>) -> Option<Self> {
        (!celsius.is_empty()).then(|| Self { start_s, sample_s, celsius: celsius.into() })
    }

    /// The temperature, °C, at a time on the session clock, s: linear between the samples, constant beyond them.
    #[must_use]
    #[inline]
    pub fn at(&self, time_s: f64) -> f64 {
        let last = self.celsius.len() - 1;
        let at = ((time_s - self.start_s) / self.sample_s).clamp(0.0, last as f64);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the samples")]
        let before = at as usize;
        let [from, to] = [before, last.min(before + 1)].map(|i| self.celsius[i]);
        from + (at - before as f64) * (to - from)
    }

    /// The temperatures of the samples, °C; at least one.
    #[must_use]
    pub fn celsius(&self) -> &[f64] {
        &self.celsius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_temperature_is_linear_between_samples_and_constant_beyond() {
        let curve = GuideTemperature::new(10.0, 0.5, vec![20.0, 21.0, 25.0]).unwrap();
        for (time_s, expected) in [
            (0.0, 20.0),
            (10.0, 20.0),
            (10.25, 20.5),
            (10.5, 21.0),
            (10.75, 23.0),
            (11.0, 25.0),
            (99.0, 25.0),
        ] {
            assert!((curve.at(time_s) - expected).abs() < 1e-12, "{time_s}: {}", curve.at(time_s));
        }
        assert!(GuideTemperature::new(0.0, 1.0, Vec::new()).is_none());
    }
}
