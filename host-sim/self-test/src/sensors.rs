//! Noise and resolution of the channels of a log.

use numerics::noise::box_muller;
use rand_chacha::ChaCha8Rng;

/// A channel of the log: value + noise, rounded to steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Standard deviation of its noise, mm or N.
    pub noise: f64,
    /// Resolution, steps per mm or per N.
    pub steps_per_unit: f64,
}

impl Sensor {
    /// Its reading of a value, mm or N.
    pub fn read(self, value: f64, random: &mut ChaCha8Rng) -> f64 {
        rounded(value + self.noise * box_muller(random), self.steps_per_unit)
    }

    /// Standard deviation of noise and rounding together: √(σ² + q²/12), mm or N.
    #[must_use]
    pub fn deviation(self) -> f64 {
        libm::hypot(self.noise, 1.0 / (self.steps_per_unit * 12_f64.sqrt()))
    }
}

/// The sensors of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// Motor encoder or resolver.
    pub motor: Sensor,
    /// Linear scale.
    pub table: Sensor,
    /// Probe at the tool.
    pub tool: Sensor,
    /// Commanded force.
    pub force: Sensor,
}

impl Default for Sensors {
    /// The sensors of the textbook cases.
    fn default() -> Self {
        Self {
            motor: Sensor { noise: 10e-6, steps_per_unit: 1e5 },
            table: Sensor { noise: 20e-6, steps_per_unit: 1e5 },
            tool: Sensor { noise: 80e-6, steps_per_unit: 1e5 },
            force: Sensor { noise: 2.0, steps_per_unit: 10.0 },
        }
    }
}

impl Sensors {
    /// An encoder with steps of 0.5 µm, a scale with steps of 0.1 µm, a noisy probe. The noise of the force is that of
    /// its log; the steps of the encoder add some 50 N through the loops.
    #[must_use]
    pub fn coarse() -> Self {
        Self {
            motor: Sensor { noise: 10e-6, steps_per_unit: 2e3 },
            table: Sensor { noise: 40e-6, steps_per_unit: 1e4 },
            tool: Sensor { noise: 215e-6, steps_per_unit: 1e5 },
            ..Self::default()
        }
    }

    /// Without noise, with steps of 1 fm and 1 nN.
    #[must_use]
    pub fn ideal() -> Self {
        let position = Sensor { noise: 0.0, steps_per_unit: 1e12 };
        let force = Sensor { noise: 0.0, steps_per_unit: 1e9 };
        Self { motor: position, table: position, tool: position, force }
    }
}

/// Rounded to the resolution of the log: the same f64 that reading the decimals of the file gives.
#[must_use]
pub fn rounded(value: f64, steps_per_unit: f64) -> f64 {
    // The sum turns −0 into 0, which the file would write as "-0.0".
    (value * steps_per_unit).round() / steps_per_unit + 0.0
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn steps_read_as_their_decimals_and_zero_has_no_sign() {
        assert_eq!(rounded(0.123_456_7, 1e5).to_bits(), 0.12346_f64.to_bits());
        assert_eq!(rounded(39.495_87, 2e3).to_bits(), 39.496_f64.to_bits());
        assert_eq!(rounded(-0.04, 10.0).to_bits(), 0.0_f64.to_bits());
    }

    #[test]
    fn readings_scatter_by_noise_and_steps() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let sensor = Sensors::coarse().table;
        // A ramp, so that the error of rounding is uniform over a step.
        let errors = (0..20_000).map(|i| {
            let value = 1e-3 * f64::from(i) * 0.777;
            sensor.read(value, &mut random) - value
        });
        let scatter = numerics::rms(errors.collect::<Vec<_>>());
        // √(40² + 100²/12) nm; the rms of 20 000 values is known to 0.5 %: four standard deviations.
        assert!((scatter / sensor.deviation() - 1.0).abs() < 0.02, "{scatter}");
        assert!((sensor.deviation() - 49.3e-6).abs() < 0.1e-6, "{}", sensor.deviation());
    }
}
