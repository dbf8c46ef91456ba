//! Errors of a linear scale, which the control loop and the log both see.

use super::plant::Sinusoid;

/// Errors of a linear scale; an error of value 0 is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// Relative error of its length: 50e-6 reads 50 µm/m too much.
    pub gain: f64,
    /// Error of its mounting over the position, m over m.
    pub wave: Sinusoid,
    /// Disturbance of its signal over time, m over s.
    pub hum: Sinusoid,
    /// Relative expansion of the scale that a session approaches: an expanded scale reads too little.
    pub growth: f64,
    /// Time constant of the expansion, s; above 0 unless the expansion is 0.
    pub growth_s: f64,
}

impl Scale {
    /// Reading at a position of the table and a time on the clock of the session, m.
    #[must_use]
    pub fn reading_m(&self, table_m: f64, time_s: f64) -> f64 {
        let grown =
            if self.growth == 0.0 { 0.0 } else { self.growth * -libm::expm1(-time_s / self.growth_s) };
        table_m * (1.0 + self.gain - grown) + self.wave.at(table_m) + self.hum.at(time_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_contains_each_error_and_without_errors_is_the_position() {
        assert_eq!(Scale::default().reading_m(0.123, 7.0).to_bits(), 0.123_f64.to_bits());
        let scale = Scale {
            gain: 50e-6,
            wave: Sinusoid { amplitude: 3e-6, period: 0.08, phase: 0.0 },
            hum: Sinusoid { amplitude: 60e-9, period: 0.02, phase: 0.0 },
            growth: 30e-6,
            growth_s: 100.0,
        };
        let error_m = |table_m: f64, time_s: f64| scale.reading_m(table_m, time_s) - table_m;
        // A quarter of the wave, no hum at whole periods: 1 µm of gain on 20 mm, 3 µm of wave.
        assert!((error_m(0.02, 0.0) - (1e-6 + 3e-6)).abs() < 1e-12);
        // At position 0, a quarter of a period of the hum.
        assert!((error_m(0.0, 0.005) - 60e-9).abs() < 1e-14);
        // After one time constant, 1 − 1/e of the growth on a whole period of the wave.
        let grown = 30e-6 * (1.0 - (-1.0_f64).exp());
        assert!((error_m(0.08, 100.0) - 0.08 * (50e-6 - grown)).abs() < 1e-12);
    }
}
