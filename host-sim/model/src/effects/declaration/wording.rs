//! The numbers of an effect as they stand in its sentence.

use files::format::with_spread;

use super::parameter::Parameter;

/// Values with their intervals and units, on a linear or a rotary axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Wording {
    parameters: &'static [Parameter],
    values: Vec<f64>,
    half_widths: Vec<f64>,
    is_rotary: bool,
}

impl Wording {
    /// Of an effect's values; half widths that are missing are not told.
    #[must_use]
    pub fn new(
        parameters: &'static [Parameter],
        values: Vec<f64>,
        half_widths: &[f64],
        is_rotary: bool,
    ) -> Self {
        Self { parameters, values, half_widths: half_widths.to_vec(), is_rotary }
    }

    /// A parameter's value without a unit.
    #[must_use]
    pub fn number(&self, index: usize) -> String {
        with_spread(self.values[index], self.half_width(index))
    }

    /// A parameter's value with its unit.
    #[must_use]
    pub fn value(&self, index: usize) -> String {
        self.parameters[index].unit.with(&self.number(index), self.is_rotary)
    }

    /// A parameter's magnitude with its unit.
    #[must_use]
    pub fn size(&self, index: usize) -> String {
        let size = with_spread(self.values[index].abs(), self.half_width(index));
        self.parameters[index].unit.with(&size, self.is_rotary)
    }

    /// One of two texts, by the sign of the first parameter.
    #[must_use]
    pub fn by_sign<'a>(&self, positive: &'a str, negative: &'a str) -> &'a str {
        if self.values[0] >= 0.0 { positive } else { negative }
    }

    /// One of two texts, for a linear or a rotary axis.
    #[must_use]
    pub const fn by_axis<'a>(&self, linear: &'a str, rotary: &'a str) -> &'a str {
        if self.is_rotary { rotary } else { linear }
    }

    fn half_width(&self, index: usize) -> f64 {
        self.half_widths.get(index).copied().unwrap_or(0.0)
    }
}
