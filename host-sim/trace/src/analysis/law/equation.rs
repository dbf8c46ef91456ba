//! A law as text.

use super::found_law::{FoundLaw, FoundTerm};
use crate::stages::residual_unit;
use files::format::with_spread;
use files::log::Unit;
use model::residual_law::Term;
use model::residual_table::TableVariable as V;

impl FoundLaw {
    /// The equation, without its constant: `1.30 ± 0.02 µm/(mm·mm) · x · y + …`.
    #[must_use]
    pub fn equation(&self, unit: Unit) -> String {
        let (symbol, _) = residual_unit(unit, self.stage);
        let term = |found: &FoundTerm| {
            let [first, second] = found.term.coefficients();
            let per = units(&found.term, unit);
            let value = match &found.term {
                Term::Wave { .. } => libm::hypot(first, second),
                _ => first,
            };
            let length = found.term.length_mm().zip(found.length_half_width);
            let form = match length {
                Some((mm, half)) => {
                    found.term.form_with_length(&self.axis, &self.other, &with_spread(mm, half))
                }
                None => self.form(&found.term),
            };
            format!("{} {symbol}{per} · {form}", with_spread(value, found.amplitude_half_width))
        };
        self.terms.iter().map(term).collect::<Vec<_>>().join(" + ")
    }

    /// The form of a term, with the names of the axes.
    #[must_use]
    pub fn form(&self, term: &Term) -> String {
        term.form(&self.axis, &self.other)
    }
}

/// The unit of a variable on an axis with a unit; `None`: it has none.
#[must_use]
pub fn variable_unit(variable: V, unit: Unit) -> Option<&'static str> {
    let is_rotary = unit == Unit::Degree;
    match variable {
        V::PositionMm | V::OtherPositionMm => Some(if is_rotary { "°" } else { "mm" }),
        V::VelocityMPerS | V::SpeedMPerS | V::OtherVelocityMPerS => {
            Some(if is_rotary { "1000°/s" } else { "m/s" })
        }
        V::AccelerationMPerS2 | V::OtherAccelerationMPerS2 => {
            Some(if is_rotary { "1000°/s²" } else { "m/s²" })
        }
        V::ForceN => Some(if is_rotary { "N·m" } else { "N" }),
        V::TimeS => Some("s"),
        V::Direction | V::OtherDirection => None,
    }
}

/// The unit of the variables of a product: `/(mm·m/s)`.
fn units(term: &Term, unit: Unit) -> String {
    let Term::Product { of, .. } = term else { return String::new() };
    match of.iter().filter_map(|variable| variable_unit(*variable, unit)).collect::<Vec<_>>()[..] {
        [] => String::new(),
        ["mm"] => "/mm".to_owned(),
        ref all => format!("/({})", all.join("·")),
    }
}
