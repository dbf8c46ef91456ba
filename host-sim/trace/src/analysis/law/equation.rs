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
            let [of_first, of_second] = found.half_widths;
            let per = units(&found.term, unit);
            let form = self.form(&found.term);
            match &found.term {
                Term::Wave { .. } => {
                    let (amplitude, half) = (libm::hypot(first, second), libm::hypot(of_first, of_second));
                    format!("{} {symbol} · {form}", with_spread(amplitude, half))
                }
                _ => format!("{} {symbol}{per} · {form}", with_spread(first, of_first)),
            }
        };
        self.terms.iter().map(term).collect::<Vec<_>>().join(" + ")
    }

    /// The form of a term, with the names of the axes.
    #[must_use]
    pub fn form(&self, term: &Term) -> String {
        term.form(&self.axis, &self.other)
    }
}

/// The unit of the variables of a product: `/(mm·m/s)`.
fn units(term: &Term, unit: Unit) -> String {
    let Term::Product { of, .. } = term else { return String::new() };
    let is_rotary = unit == Unit::Degree;
    let of_variable = |variable: &V| match variable {
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
    };
    match of.iter().filter_map(of_variable).collect::<Vec<_>>()[..] {
        [] => String::new(),
        ["mm"] => "/mm".to_owned(),
        ref all => format!("/({})", all.join("·")),
    }
}
