//! The terms of laws as parts of a compensation.

use shared::compensate::CompensationSettings;

use crate::compensate::choice::{Choice, Part};
use crate::compensate::laws::{self, Place};
use crate::compensate::mapped;
use crate::compensate::planning::Planning;
use crate::compensate::prediction::PredictionError;
use model::machine::Axis;
use model::residual_law::{ResidualLaw, Term};

/// The terms of the laws of an axis, each with the reason why the controller does not compensate it.
pub(crate) fn law_terms(
    axis: &Axis,
    index: usize,
) -> impl Iterator<Item = (Part, Option<(&'static str, &'static str)>)> {
    let of_law = move |(number, law): (usize, &ResidualLaw)| {
        let terms = law.term.iter().enumerate();
        let part = |(term, of): (usize, &Term)| {
            (Part::LawTerm(index, number, term), laws::refused(axis, law.channel, of))
        };
        terms.map(part).collect::<Vec<_>>()
    };
    axis.residual_law.iter().enumerate().flat_map(of_law)
}

impl Planning<'_> {
    /// Adds the terms of the laws of an axis that are used; the travel of its tables, m.
    pub(crate) fn add_laws(
        &self,
        index: usize,
        choice: &Choice,
        (compensation, travel_m): (&mut CompensationSettings, [f64; 2]),
    ) -> Result<(), PredictionError> {
        let axis = &self.model.axis[index];
        let other = usize::from(index == 0).min(self.model.axis.len() - 1);
        let used = law_terms(axis, index).filter(|(part, refused)| refused.is_none() && choice.has(part));
        let used: Vec<Part> = used.map(|(part, _)| part).collect();
        if used.is_empty() {
            return Ok(());
        }
        let other_travel_m =
            mapped::known_m(&self.model.axis[other], mapped::travel_m(self.model, self.tests, other)?);
        let number = |axis: usize| u8::try_from(axis).unwrap_or(u8::MAX);
        let place = Place { own: number(index), other: number(other), travel_m, other_travel_m };
        for part in used {
            if let Part::LawTerm(_, law, term) = part {
                laws::add(compensation, &axis.residual_law[law].term[term], &place);
            }
        }
        Ok(())
    }
}
