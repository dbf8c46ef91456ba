//! The numbers of an effect, formatted for its sentence.

use std::ops::Range;

use files::format::with_spread;

use super::parameter::Parameter;

/// Values with their confidence intervals and units, on a linear or a rotary axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Wording {
    parameters: Vec<&'static Parameter>,
    values: Vec<f64>,
    half_widths: Vec<f64>,
    is_rotary: bool,
}

impl Wording {
    /// The wording of an effect's values, each with its declaration. Missing half widths are omitted.
    #[must_use]
    pub fn new(
        parameters: Vec<&'static Parameter>,
        values: Vec<f64>,
        half_widths: &[f64],
        is_rotary: bool,
    ) -> Self {
        Self { parameters, values, half_widths: half_widths.to_vec(), is_rotary }
    }

    /// Value of a parameter without its unit.
    #[must_use]
    pub fn number(&self, index: usize) -> String {
        with_spread(self.values[index], self.half_width(index))
    }

    /// Value of a parameter with its unit.
    #[must_use]
    pub fn value(&self, index: usize) -> String {
        self.parameters[index].unit.with(&self.number(index), self.is_rotary)
    }

    /// Absolute value of a parameter with its unit.
    #[must_use]
    pub fn size(&self, index: usize) -> String {
        self.parameters[index].unit.with(&self.magnitude(index), self.is_rotary)
    }

    /// Absolute value of a parameter without its unit.
    #[must_use]
    pub fn magnitude(&self, index: usize) -> String {
        with_spread(self.values[index].abs(), self.half_width(index))
    }

    /// Greatest less least of some values of a list with their unit.
    #[must_use]
    pub fn peak_to_peak(&self, list: Range<usize>) -> String {
        let by_value = |a: &usize, b: &usize| self.values[*a].total_cmp(&self.values[*b]);
        let ends = list.clone().min_by(by_value).zip(list.max_by(by_value));
        ends.map_or_else(String::new, |(least, greatest)| {
            let half_width = libm::hypot(self.half_width(least), self.half_width(greatest));
            let size = with_spread(self.values[greatest] - self.values[least], half_width);
            self.parameters[least].unit.with(&size, self.is_rotary)
        })
    }

    /// One of two texts, selected by the sign of the first parameter.
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
