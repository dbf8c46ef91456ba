//! What the sensors show of the machine: resolution and noise.

use numerics::noise::sum_of_uniforms;
use rand_chacha::ChaCha8Rng;

/// Resolution and noise of one position sensor or of the force reading, in its own unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Readings are whole multiples of this; zero: not quantised.
    pub resolution: f64,
    /// Standard deviation of white noise before quantisation.
    pub noise: f64,
}

impl Sensor {
    /// What the sensor shows of a value.
    #[inline]
    pub fn read(&self, value: f64, random: &mut ChaCha8Rng) -> f64 {
        let noisy = if self.noise > 0.0 { value + self.noise * sum_of_uniforms(random) } else { value };
        // A step too small for a number to count is none.
        let steps = (noisy / self.resolution).round();
        if self.resolution > 0.0 && steps.is_finite() { steps * self.resolution } else { noisy }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn noise_has_the_size_it_says() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let sensor = Sensor { resolution: 0.0, noise: 2.0 };
        let n = 100_000;
        let squares: f64 = (0..n).map(|_| sensor.read(0.0, &mut random).powi(2)).sum();
        // The variance of n squares of a normal deviate is 2σ⁴/n: 1 % is more than two sigma of it.
        assert!((squares / f64::from(n) / 4.0 - 1.0).abs() < 0.012);
    }

    #[test]
    fn readings_are_whole_steps() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let sensor = Sensor { resolution: 0.25, noise: 0.0 };
        assert!((sensor.read(0.9, &mut random) - 1.0).abs() < 1e-12);
    }
}
