//! Amplitude and health of the sine and cosine of a sensor.

use serde::{Deserialize, Serialize};

use super::{level_db, phase_deg, square_root};

/// The signals of a resolver or a sine encoder in a tick, without their errors of offset and gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EncoderSignals {
    /// Sine, counts of the converter.
    pub sine: i32,
    /// Cosine, counts of the converter.
    pub cosine: i32,
    /// Least and greatest amplitude of good signals, counts, in increasing order.
    pub limits: [u16; 2],
}

/// What a person wants to know of the signals of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalFigures {
    /// Amplitude √(sine² + cosine²), counts.
    pub amplitude_counts: f32,
    /// Level of the amplitude relative to the middle of its limits, dB.
    pub level_db: f32,
    /// Phase in the period of the sensor, −180° to 180°.
    pub phase_deg: f32,
    /// Distance of the amplitude to the nearer limit, % of that of the middle; 0 at a limit and beyond.
    pub health_percent: f32,
}

impl EncoderSignals {
    /// The figures. Not for a tick.
    #[must_use]
    pub fn figures(&self) -> SignalFigures {
        let [sine, cosine] = [self.sine as f32, self.cosine as f32];
        let [least, greatest] = self.limits.map(f32::from);
        let (middle, half) = (0.5 * (least + greatest), 0.5 * (greatest - least));
        let amplitude_counts = square_root(sine * sine + cosine * cosine);
        let off =
            if amplitude_counts > middle { amplitude_counts - middle } else { middle - amplitude_counts };
        let health = if half > off { 100.0 * (half - off) / half } else { 0.0 };
        let level_db = if middle > 0.0 { level_db(amplitude_counts / middle) } else { 0.0 };
        SignalFigures {
            amplitude_counts,
            level_db,
            phase_deg: phase_deg(sine, cosine),
            health_percent: health,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(sine: i32, cosine: i32) -> SignalFigures {
        EncoderSignals { sine, cosine, limits: [1050, 1950] }.figures()
    }

    /// 100 % in the middle of the limits, half of it half-way to either, and nothing from a limit on.
    #[test]
    fn the_health_is_the_distance_to_the_nearer_limit() {
        for (amplitude, percent) in
            [(1500, 100.0), (1275, 50.0), (1725, 50.0), (1051, 100.0 / 450.0), (1949, 100.0 / 450.0)]
        {
            let health = figures(amplitude, 0).health_percent;
            assert!((health - percent).abs() < 1e-2, "{amplitude}: {health}");
        }
        for amplitude in [0, 900, 1049, 1951, 4000] {
            assert!(figures(0, amplitude).health_percent.abs() < 1e-9, "{amplitude}");
        }
    }

    /// No signal at all, limits of a sensor that does not exist.
    #[test]
    fn every_signal_has_figures() {
        let none = figures(0, 0);
        assert!(none.amplitude_counts.abs() < 1e-9 && none.phase_deg.abs() < 1e-9);
        assert!((none.level_db - super::super::LEAST_LEVEL_DB).abs() < 1e-9);
        let no_sensor = EncoderSignals { sine: 0, cosine: 0, limits: [0, 0] }.figures();
        assert!(no_sensor.health_percent.abs() < 1e-9 && no_sensor.level_db.abs() < 1e-9);
        let odd = EncoderSignals { sine: i32::MIN, cosine: i32::MAX, limits: [0, 0] }.figures();
        assert!(
            odd.amplitude_counts.is_finite() && odd.level_db.abs() < 1e-9 && odd.health_percent.abs() < 1e-9
        );
    }
}
