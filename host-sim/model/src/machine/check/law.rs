//! Checks of the laws `[[axis.NAME.law]]`.

use super::Context;
use crate::machine::Machine;
use crate::residual_law::Term;
use files::error::InputError;

/// Largest number of variables of a product.
const MOST_FACTORS: usize = 4;

impl Context<'_> {
    /// Terms with lengths above zero, and another axis where a variable is one of it.
    pub(super) fn law(&self, machine: &Machine) -> Result<(), InputError> {
        for (index, law) in self.axis.residual_law.iter().enumerate() {
            let key = format!("law[{index}]");
            for (number, term) in law.term.iter().enumerate() {
                self.term(&format!("{key}.term[{number}]"), term, machine)?;
            }
        }
        Ok(())
    }

    fn term(&self, key: &str, term: &Term, machine: &Machine) -> Result<(), InputError> {
        let length = match term {
            Term::Product { of, .. } if !(1..=MOST_FACTORS).contains(&of.len()) => {
                return Err(self.refuse(&format!("{key}.of"), &format!("1 to {MOST_FACTORS} variables")));
            }
            Term::Product { .. } => None,
            Term::Wave { period_mm, .. } => Some(("period_mm", *period_mm)),
            Term::Hysteresis { distance_mm, .. } => Some(("distance_mm", *distance_mm)),
        };
        if let Some((name, mm)) = length
            && mm <= 0.0
        {
            return Err(self.refuse(&format!("{key}.{name}"), "a length above 0"));
        }
        if machine.axis.len() < 2 && term.variables().iter().any(|variable| variable.is_of_other_axis()) {
            return Err(self.refuse(key, "variables of this axis, as there is no other"));
        }
        Ok(())
    }
}
