//! Units of parameters: suffix of the key in a file and printed symbol, for linear and rotary axes.

/// The unit of a parameter. On a rotary axis, degrees replace mm, and N·m replaces N, with the same numbers; 1000°
/// replace a metre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// µm; millidegrees.
    Micrometre,
    /// mm; degrees.
    Millimetre,
    /// mm/s; °/s.
    MillimetrePerSecond,
    /// µm/m; millidegrees per 1000°, which are ppm.
    MicrometrePerMetre,
    /// µm/m²; millidegrees per (1000°)².
    MicrometrePerSquareMetre,
    /// µm/min; millidegrees per minute.
    MicrometrePerMinute,
    /// µm per m/s²; millidegrees per 1000°/s².
    MicrometrePerAcceleration,
    /// m/s²; 1000°/s².
    MetrePerSecondSquared,
    /// N; N·m.
    Newton,
    /// N/m; N·m per 1000°.
    NewtonPerMetre,
    /// N/m²; N·m per (1000°)².
    NewtonPerSquareMetre,
    /// N/µm; N·m per millidegree.
    NewtonPerMicrometre,
    /// N·s/m; N·m·s per 1000°.
    NewtonSecondPerMetre,
    /// °C.
    DegreeCelsius,
    /// N/°C; N·m/°C.
    NewtonPerDegreeCelsius,
    /// %/°C.
    PercentPerDegreeCelsius,
    /// s.
    Second,
    /// ms.
    Millisecond,
    /// Hz.
    Hertz,
    /// rad, of a phase.
    Radian,
    /// %.
    Percent,
    /// Dimensionless.
    One,
}

impl Unit {
    /// Whether it is proportional to a force.
    #[must_use]
    pub const fn is_of_force(self) -> bool {
        matches!(
            self,
            Self::Newton
                | Self::NewtonPerMetre
                | Self::NewtonPerSquareMetre
                | Self::NewtonPerMicrometre
                | Self::NewtonSecondPerMetre
                | Self::NewtonPerDegreeCelsius
        )
    }

    /// Suffixes of keys with a value in this unit, for linear and for rotary axes. Empty if dimensionless.
    #[must_use]
    pub const fn key_ends(self) -> [&'static str; 2] {
        match self {
            Self::Micrometre => ["um", "mdeg"],
            Self::Millimetre => ["mm", "deg"],
            Self::MillimetrePerSecond => ["mm_s", "deg_s"],
            Self::MicrometrePerMetre => ["um_per_m", "mdeg_per_kdeg"],
            Self::MicrometrePerSquareMetre => ["um_per_m2", "mdeg_per_kdeg2"],
            Self::MicrometrePerMinute => ["um_per_min", "mdeg_per_min"],
            Self::MicrometrePerAcceleration => ["um_s2_per_m", "mdeg_s2_per_kdeg"],
            Self::MetrePerSecondSquared => ["m_per_s2", "kdeg_per_s2"],
            Self::Newton => ["n", "nm"],
            Self::NewtonPerMetre => ["n_per_m", "nm_per_kdeg"],
            Self::NewtonPerSquareMetre => ["n_per_m2", "nm_per_kdeg2"],
            Self::NewtonPerMicrometre => ["n_per_um", "nm_per_mdeg"],
            Self::NewtonSecondPerMetre => ["n_s_per_m", "nm_s_per_kdeg"],
            Self::DegreeCelsius => ["c"; 2],
            Self::NewtonPerDegreeCelsius => ["n_per_c", "nm_per_c"],
            Self::PercentPerDegreeCelsius => ["percent_per_c"; 2],
            Self::Second => ["s"; 2],
            Self::Millisecond => ["ms"; 2],
            Self::Hertz => ["hz"; 2],
            Self::Radian => ["rad"; 2],
            Self::Percent => ["percent"; 2],
            Self::One => [""; 2],
        }
    }

    /// Printed symbols, for linear and for rotary axes. Empty if dimensionless.
    #[must_use]
    pub const fn symbols(self) -> [&'static str; 2] {
        match self {
            Self::Micrometre => ["µm", "mdeg"],
            Self::Millimetre => ["mm", "°"],
            Self::MillimetrePerSecond => ["mm/s", "°/s"],
            Self::MicrometrePerMetre => ["µm/m", "ppm"],
            Self::MicrometrePerSquareMetre => ["µm/m²", "mdeg per (1000°)²"],
            Self::MicrometrePerMinute => ["µm/min", "mdeg/min"],
            Self::MicrometrePerAcceleration => ["µm per m/s²", "mdeg per 1000°/s²"],
            Self::MetrePerSecondSquared => ["m/s²", "1000°/s²"],
            Self::Newton => ["N", "N·m"],
            Self::NewtonPerMetre => ["N/m", "N·m per 1000°"],
            Self::NewtonPerSquareMetre => ["N/m²", "N·m per (1000°)²"],
            Self::NewtonPerMicrometre => ["N/µm", "N·m/mdeg"],
            Self::NewtonSecondPerMetre => ["N·s/m", "N·m·s per 1000°"],
            Self::DegreeCelsius => ["°C"; 2],
            Self::NewtonPerDegreeCelsius => ["N/°C", "N·m/°C"],
            Self::PercentPerDegreeCelsius => ["%/°C"; 2],
            Self::Second => ["s"; 2],
            Self::Millisecond => ["ms"; 2],
            Self::Hertz => ["Hz"; 2],
            Self::Radian => ["rad"; 2],
            Self::Percent => ["%"; 2],
            Self::One => [""; 2],
        }
    }

    /// A printed number with this unit. The degree sign of an angle follows the number without a space.
    #[must_use]
    pub fn with(self, number: &str, is_rotary: bool) -> String {
        match self.symbols()[usize::from(is_rotary)] {
            "" => number.to_owned(),
            symbol if symbol.starts_with('°') && self != Self::DegreeCelsius => format!("{number}{symbol}"),
            symbol => format!("{number} {symbol}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_degree_sign_follows_its_number_without_a_space() {
        assert_eq!(Unit::MillimetrePerSecond.with("3.1", true), "3.1°/s");
        assert_eq!(Unit::MillimetrePerSecond.with("3.1", false), "3.1 mm/s");
        assert_eq!(Unit::One.with("0.05", true), "0.05");
        assert_eq!(Unit::DegreeCelsius.with("21.5", true), "21.5 °C");
    }
}
