//! Sensors: white noise and quantisation.

use numerics::noise::sum_of_uniforms;
use rand_chacha::ChaCha8Rng;

/// A position sensor (m) or the force reading (N).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Quantisation step; zero: not quantised.
    pub resolution: f64,
    /// Standard deviation of the white noise, which is added before quantisation.
    pub noise: f64,
}

impl Sensor {
    /// A reading of a value.
    #[inline]
    pub fn read(&self, value: f64, random: &mut ChaCha8Rng) -> f64 {
        let noisy = if self.noise > 0.0 { value + self.noise * sum_of_uniforms(random) } else { value };
        // A quantisation step below the resolution of f64 has no effect.
        let steps = (noisy / self.resolution).round();
        if self.resolution > 0.0 && steps.is_finite() { steps * self.resolution } else { noisy }
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn noise_has_its_standard_deviation() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let sensor = Sensor { resolution: 0.0, noise: 2.0 };
        let n = 100_000;
        let squares: f64 = (0..n).map(|_| sensor.read(0.0, &mut random).powi(2)).sum();
        // The variance of n squares of a normal deviate is 2σ⁴/n: 1 % is more than two sigma of it.
        assert!((squares / f64::from(n) / 4.0 - 1.0).abs() < 0.012);
    }

    #[test]
    fn readings_are_multiples_of_the_resolution() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let sensor = Sensor { resolution: 0.25, noise: 0.0 };
        assert!((sensor.read(0.9, &mut random) - 1.0).abs() < 1e-12);
    }
}
