//! A guide that becomes warm, and whose cooler switches on and off: its temperature, what its sensor reads, and its friction.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::sensors::rounded;

/// Time constant of the sensor, s.
const SENSOR_S: f64 = 3.0;
/// Temperature at which the law of Vogel has its pole, °C; a usual value of mineral oils.
const VOGEL_C: f64 = -95.0;
/// Resolution of the sensor.
const STEPS_PER_DEGREE: f64 = 10.0;

/// The temperature of a guide over the session: start + rise·(1 − exp(−t/τ)) + cycle·sin(2π·t/period + phase), and the laws of its friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warming {
    /// Temperature at the start, °C.
    pub start_c: f64,
    /// Rise until the end of the warm-up, °C.
    pub rise_c: f64,
    /// τ.
    pub time_constant_s: f64,
    /// Amplitude of the cycles of the cooler, °C.
    pub cycle_c: f64,
    /// Period of the cycles.
    pub cycle_s: f64,
    /// Phase of the cycles.
    pub cycle_rad: f64,
    /// Relative loss of viscosity per degree at [`Self::nominal_c`]; by the law of Vogel, η ∝ exp(B/(T − T∞)), it is less above.
    pub viscosity_per_c: f64,
    /// Relative loss of Coulomb friction per degree.
    pub level_per_c: f64,
}

impl Warming {
    /// Draws a warm-up of 3 to 8 °C with cycles of 1 to 3 °C within minutes, and a lubricant that loses 2 to 6 % of its viscosity per degree.
    pub fn draw(random: &mut ChaCha8Rng) -> Self {
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        Self {
            start_c: between(17.0, 23.0),
            rise_c: between(3.0, 8.0),
            time_constant_s: between(40.0, 120.0),
            cycle_c: between(1.0, 3.0),
            cycle_s: between(60.0, 150.0),
            cycle_rad: between(0.0, TAU),
            viscosity_per_c: between(0.02, 0.06),
            level_per_c: between(0.006, 0.015),
        }
    }

    /// The temperature at a time of the session (s), °C.
    #[must_use]
    pub fn at_c(&self, time_s: f64) -> f64 {
        let risen = -libm::expm1(-time_s / self.time_constant_s);
        let cycle = libm::sin(TAU * time_s / self.cycle_s + self.cycle_rad);
        self.start_c + self.rise_c * risen + self.cycle_c * cycle
    }

    /// Temperature at which the friction is that of the mechanics: within the warm-up.
    fn nominal_c(&self) -> f64 {
        self.start_c + 0.7 * self.rise_c
    }

    /// Viscous and Coulomb friction at a time of the session (s), relative to those of the mechanics.
    #[must_use]
    pub fn factors(&self, time_s: f64) -> [f64; 2] {
        let above_c = self.at_c(time_s) - self.nominal_c();
        let from_pole_c = self.nominal_c() - VOGEL_C;
        // B/(T − T∞) − B/(T0 − T∞) with B = β·(T0 − T∞)².
        let exponent = -self.viscosity_per_c * above_c * from_pole_c / (from_pole_c + above_c);
        [libm::exp(exponent), 1.0 - self.level_per_c * above_c]
    }

    /// Temperature of the sensor at a time of the session (s), °C: the response of a lag of first order, long after the machine was switched on.
    #[must_use]
    pub fn sensor_c(&self, time_s: f64) -> f64 {
        let left = libm::exp(-time_s / self.time_constant_s) / (1.0 - SENSOR_S / self.time_constant_s);
        let angular = TAU / self.cycle_s;
        let behind_rad = libm::atan(angular * SENSOR_S);
        let cycle = libm::cos(behind_rad) * libm::sin(angular * time_s + self.cycle_rad - behind_rad);
        self.start_c + self.rise_c * (1.0 - left) + self.cycle_c * cycle
    }

    /// What the sensor reads at a time of the session (s), °C, with noise of its resolution.
    pub fn read_c(&self, time_s: f64, random: &mut ChaCha8Rng) -> f64 {
        let dither = random.random_range(-0.5..0.5) / STEPS_PER_DEGREE;
        rounded(self.sensor_c(time_s) + dither, STEPS_PER_DEGREE)
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    /// T' = (guide − T)/τ, by central differences: a step of 10 ms has an error of 1e-8 °C/s.
    #[test]
    fn the_sensor_follows_the_guide_by_a_lag_of_first_order() {
        let warming = Warming::draw(&mut ChaCha8Rng::seed_from_u64(7));
        for step in 0..50 {
            let time_s = 3.7 * f64::from(step);
            let rate = (warming.sensor_c(time_s + 0.01) - warming.sensor_c(time_s - 0.01)) / 0.02;
            let expected = (warming.at_c(time_s) - warming.sensor_c(time_s)) / SENSOR_S;
            assert!((rate - expected).abs() < 1e-6, "{time_s}: {rate} {expected}");
        }
    }

    #[test]
    fn friction_falls_with_the_temperature_that_the_sensor_reads_late() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..20 {
            let warming = Warming { cycle_c: 0.0, ..Warming::draw(&mut random) };
            let [cold, warm] = [0.0, 1e4].map(|time_s| warming.factors(time_s));
            // Nominal in between; over the whole rise γ·ΔT, and by Vogel's law exp(B/(T − T∞)) at both ends.
            assert!(cold[0] > 1.0 && cold[1] > 1.0 && warm[0] < 1.0 && warm[1] < 1.0);
            let [viscosity, level] = [warm[0] / cold[0], warm[1] - cold[1]];
            let above_pole = |part: f64| warming.start_c + part * warming.rise_c + 95.0;
            let b = warming.viscosity_per_c * above_pole(0.7).powi(2);
            assert!((viscosity.ln() - b * (above_pole(1.0).recip() - above_pole(0.0).recip())).abs() < 1e-9);
            assert!((level + warming.level_per_c * warming.rise_c).abs() < 1e-9);
            assert!((warming.read_c(50.0, &mut random) - warming.sensor_c(50.0)).abs() < 0.1 + 1e-9);
        }
    }
}
