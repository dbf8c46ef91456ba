//! Declaration of a parameter: key, unit, range.

use super::unit::Unit;
use crate::range::Range;

/// A parameter of an effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in a machine file and in the JSON of a linear axis. It ends with the unit.
    pub key: &'static str,
    /// Unit of the value.
    pub unit: Unit,
    /// Permitted values.
    pub range: Range,
    /// Period of the value: values that differ by a multiple of it are equivalent. Absent: not periodic.
    pub period: Option<f64>,
    /// Whether the key holds a list of values.
    pub is_list: bool,
    /// Half width of an interval of 95 %, as a part of the value, that is due to the model and not to the noise: the effect is a simple form of what
    /// machines have. 0: none.
    pub model_error: f64,
}

impl Parameter {
    /// A parameter that is not periodic.
    #[must_use]
    pub const fn new(key: &'static str, unit: Unit, range: Range) -> Self {
        Self { key, unit, range, period: None, is_list: false, model_error: 0.0 }
    }

    /// A list of numbers, each in this range.
    #[must_use]
    pub const fn list(key: &'static str, unit: Unit, range: Range) -> Self {
        Self { is_list: true, ..Self::new(key, unit, range) }
    }

    /// A phase, rad.
    #[must_use]
    pub const fn phase(key: &'static str) -> Self {
        Self { period: Some(std::f64::consts::TAU), ..Self::new(key, Unit::Radian, Range::Signed) }
    }

    /// The key on a linear or rotary axis. The value is the same on both.
    #[must_use]
    pub fn key_on(&self, is_rotary: bool) -> String {
        let [linear, rotary] = self.unit.key_ends();
        match self.key.strip_suffix(linear) {
            Some(stem) if is_rotary => format!("{stem}{rotary}"),
            _ => self.key.to_owned(),
        }
    }

    /// The key without its unit, with spaces instead of underscores. Empty if the key consists of the unit.
    #[must_use]
    pub fn title(&self) -> String {
        let [end, _] = self.unit.key_ends();
        self.key.strip_suffix(end).unwrap_or(self.key).replace('_', " ").trim_end().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_is_the_key_without_its_unit() {
        let title = |key, unit| Parameter::new(key, unit, Range::Signed).title();
        assert_eq!(title("static_excess_n", Unit::Newton), "static excess");
        assert_eq!(title("velocity_mm_s", Unit::MillimetrePerSecond), "velocity");
        assert_eq!(title("um_per_m2", Unit::MicrometrePerSquareMetre), "");
        assert_eq!(title("damping_ratio", Unit::One), "damping ratio");
    }

    #[test]
    fn rotary_keys_contain_degrees_and_newton_metres() {
        for (key, unit, rotary) in [
            ("stiffness_n_per_um", Unit::NewtonPerMicrometre, "stiffness_nm_per_mdeg"),
            ("slope_um_per_m", Unit::MicrometrePerMetre, "slope_mdeg_per_kdeg"),
            ("slope_n_per_m", Unit::NewtonPerMetre, "slope_nm_per_kdeg"),
            ("curvature_n_per_m2", Unit::NewtonPerSquareMetre, "curvature_nm_per_kdeg2"),
            ("width_um", Unit::Micrometre, "width_mdeg"),
            ("period_mm", Unit::Millimetre, "period_deg"),
            ("friction_n", Unit::Newton, "friction_nm"),
            ("velocity_mm_s", Unit::MillimetrePerSecond, "velocity_deg_s"),
            ("damping_ratio", Unit::One, "damping_ratio"),
            ("phase_rad", Unit::Radian, "phase_rad"),
            ("ms", Unit::Millisecond, "ms"),
        ] {
            let parameter = Parameter::new(key, unit, Range::Signed);
            assert_eq!(parameter.key_on(true), rotary);
            assert_eq!(parameter.key_on(false), key);
        }
    }
}
