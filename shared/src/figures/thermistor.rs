//! A thermistor of negative coefficient, between the input of a converter and ground, with a resistor to the reference of the converter.
//!
//! ```text
//! R(T) = R₂₅·exp(β·(1/T − 1/298.15 K))        counts = full·R/(R + series)
//! ```
//!
//! The tick compares counts with those of the greatest temperature, which are computed at the start with libm: no logarithm protects a
//! power stage. The temperature itself is for people. Counts beyond −40 °C to 150 °C are those of a broken wire or of a short circuit:
//! they count as too hot, as nobody knows then how hot the stage is.
//!
//! # Example
//!
//! 10 kΩ at 25 °C is half of the range with 10 kΩ.
//!
//! ```
//! use shared::figures::{Thermistor, ThermistorSettings};
//!
//! let settings = ThermistorSettings { resistance_25_ohm: 1e4, beta_k: 3950.0, series_ohm: 1e4, full_counts: 4096 };
//! let thermistor = Thermistor::new(&settings, 80_000).unwrap();
//! assert!((thermistor.temperature_mc(2048).unwrap() - 25_000).abs() < 50);
//! assert!(!thermistor.is_too_hot(2048) && thermistor.is_too_hot(0) && thermistor.is_too_hot(4096));
//! ```

use super::logarithm;

/// 0 °C, K.
const ZERO_K: f64 = 273.15;

/// Temperature of the nominal resistance, K.
const NOMINAL_K: f64 = ZERO_K + 25.0;

/// Least and greatest temperature of a thermistor whose wires are whole, m°C.
const TRUSTED_MC: [i32; 2] = [-40_000, 150_000];

/// 1 over the temperature of the nominal resistance, 1/K, and 0 °C, K.
#[expect(clippy::cast_possible_truncation, reason = "for display")]
const NOMINAL: [f32; 2] = [(1.0 / NOMINAL_K) as f32, ZERO_K as f32];

/// A thermistor and its resistor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermistorSettings {
    /// Resistance at 25 °C, Ω, 10 to 10⁷.
    pub resistance_25_ohm: f64,
    /// β, K, 1000 to 10,000.
    pub beta_k: f64,
    /// Resistor to the reference of the converter, Ω, 10 to 10⁷.
    pub series_ohm: f64,
    /// Counts at the reference, at least 256.
    pub full_counts: u16,
}

/// A thermistor at a converter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermistor {
    /// Series resistor over the nominal resistance.
    ratio: f32,
    /// 1/β, 1/K.
    per_beta: f32,
    full_counts: u16,
    /// Counts of wires that are whole.
    trusted: [u16; 2],
    /// Least counts of a stage that is not too hot.
    hottest: u16,
}

impl ThermistorSettings {
    /// Counts at a temperature, m°C.
    fn counts(&self, mc: i32) -> f64 {
        let kelvin = ZERO_K + f64::from(mc) / 1e3;
        let resistance = self.resistance_25_ohm * libm::exp(self.beta_k * (1.0 / kelvin - 1.0 / NOMINAL_K));
        f64::from(self.full_counts) * resistance / (resistance + self.series_ohm)
    }
}

impl Thermistor {
    /// A thermistor of stages that may have `max_mc`, m°C, at most. `None` for a setting out of its range, and if the limit is colder than
    /// −40 °C.
    #[must_use]
    pub fn new(settings: &ThermistorSettings, max_mc: i32) -> Option<Self> {
        let ThermistorSettings { resistance_25_ohm, beta_k, series_ohm, full_counts } = *settings;
        let ohms = 10.0..=1e7;
        let [coldest_mc, hottest_mc] = TRUSTED_MC;
        let plausible = ohms.contains(&resistance_25_ohm) && ohms.contains(&series_ohm);
        if !plausible || !(1e3..=1e4).contains(&beta_k) || full_counts < 256 || max_mc < coldest_mc {
            return None;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the full counts"
        )]
        let least = |mc| libm::ceil(settings.counts(mc)) as u16;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "between 0 and the full counts"
        )]
        let most = |mc| libm::floor(settings.counts(mc)) as u16;
        #[expect(clippy::cast_possible_truncation, reason = "for display")]
        let (ratio, per_beta) = ((series_ohm / resistance_25_ohm) as f32, (1.0 / beta_k) as f32);
        // Neither 0 nor all counts, whose resistance would be 0 or infinite.
        let trusted = [least(hottest_mc).max(1), most(coldest_mc).min(full_counts - 1)];
        let hottest = least(max_mc.min(hottest_mc)).max(trusted[0]);
        Some(Self { ratio, per_beta, full_counts, trusted, hottest })
    }

    /// Whether the stage is hotter than its limit, or a wire is broken or shorted. In integers, for a tick.
    #[must_use]
    pub const fn is_too_hot(&self, counts: u16) -> bool {
        counts < self.hottest || counts > self.trusted[1]
    }

    /// The temperature, m°C; `None` with a broken or shorted wire. Not for a tick.
    #[must_use]
    pub fn temperature_mc(&self, counts: u16) -> Option<i32> {
        let [least, most] = self.trusted;
        if !(least..=most).contains(&counts) {
            return None;
        }
        let [per_nominal, zero] = NOMINAL;
        // Below the full counts.
        let resistance = self.ratio * f32::from(counts) / f32::from(self.full_counts - counts);
        let kelvin = 1.0 / (per_nominal + self.per_beta * logarithm(resistance));
        #[expect(clippy::cast_possible_truncation, reason = "below 200,000; a cast saturates")]
        let mc = (1e3 * (kelvin - zero)) as i32;
        Some(mc)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: ThermistorSettings =
        ThermistorSettings { resistance_25_ohm: 1e4, beta_k: 3950.0, series_ohm: 4700.0, full_counts: 4096 };

    /// Temperature of counts by libm, m°C.
    fn exact_mc(counts: u16) -> f64 {
        let ThermistorSettings { resistance_25_ohm, beta_k, series_ohm, full_counts } = SETTINGS;
        let resistance = series_ohm * f64::from(counts) / f64::from(full_counts - counts);
        1e3 * (1.0 / (1.0 / 298.15 + libm::log(resistance / resistance_25_ohm) / beta_k) - 273.15)
    }

    /// What is too hot follows from the temperature by libm at every count, on both sides: hotter than the limit, hotter than a thermistor
    /// that is not shorted, colder than one that is connected.
    #[test]
    fn the_limit_is_that_of_the_temperature_at_every_count() {
        for max_mc in [-40_000, 60_000, 80_000, 149_000, 150_000, i32::MAX] {
            let thermistor = Thermistor::new(&SETTINGS, max_mc).unwrap();
            let limit = f64::from(max_mc.min(150_000));
            for counts in 0..=4096u16 {
                let exact = if counts == 0 || counts == 4096 { f64::INFINITY } else { exact_mc(counts) };
                let allowed = exact <= limit && exact >= -40_000.0;
                assert_eq!(thermistor.is_too_hot(counts), !allowed, "{max_mc}, {counts}: {exact} m°C");
                let trusted = (-40_000.0..=150_000.0).contains(&exact);
                assert_eq!(thermistor.temperature_mc(counts).is_some(), trusted, "{counts}: {exact} m°C");
            }
        }
    }

    #[test]
    fn implausible_thermistors_are_rejected() {
        let new = |change: fn(&mut ThermistorSettings)| {
            let mut settings = SETTINGS;
            change(&mut settings);
            Thermistor::new(&settings, 80_000).is_some()
        };
        assert!(new(|_| {}) && Thermistor::new(&SETTINGS, -40_001).is_none());
        assert!(new(|s| s.beta_k = 1000.0) && !new(|s| s.beta_k = 999.0) && !new(|s| s.beta_k = 10_001.0));
        assert!(!new(|s| s.resistance_25_ohm = 9.0) && !new(|s| s.resistance_25_ohm = f64::NAN));
        assert!(
            !new(|s| s.series_ohm = 0.0) && !new(|s| s.series_ohm = 1.1e7) && !new(|s| s.full_counts = 255)
        );
        // No count between the limits may be without a resistance.
        for (resistance_25_ohm, series_ohm) in [(10.0, 1e7), (1e7, 10.0)] {
            let settings = ThermistorSettings { resistance_25_ohm, series_ohm, ..SETTINGS };
            let thermistor = Thermistor::new(&settings, 80_000).unwrap();
            for counts in [0, 1, 2048, 4095, 4096, u16::MAX] {
                let plausible =
                    thermistor.temperature_mc(counts).is_none_or(|mc| (-41_000..151_000).contains(&mc));
                assert!(plausible, "{counts}: {:?}", thermistor.temperature_mc(counts));
            }
        }
    }
}
