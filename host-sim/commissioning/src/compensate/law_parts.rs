//! The terms of laws as parts of a compensation.

use shared::compensate::CompensationSettings;

use crate::compensate::choice::{Choice, Part};
use crate::compensate::laws::{self, Place};
use crate::compensate::mapped;
use crate::compensate::planning::Planning;
use crate::compensate::prediction::PredictionError;
use model::machine::Axis;
use model::residual_law::Term;
use model::residual_table::first_other;

/// The terms of the laws of an axis, each as a part with the reason why the controller does not compensate it, if there is one.
pub(crate) fn law_terms(
    axis: &Axis,
    index: usize,
) -> impl Iterator<Item = (Part, &Term, Option<(&'static str, &'static str)>)> {
    axis.residual_law.iter().enumerate().flat_map(move |(number, law)| {
        law.term.iter().enumerate().map(move |(at, term)| {
            (Part::LawTerm(index, number, at), term, laws::refused(axis, law.channel, term))
        })
    })
}

impl Planning<'_> {
    /// Adds the laws of an axis to its compensation, as far as they are chosen. `travel_m` is the travel that its tables cover, m.
    pub(crate) fn add_laws(
        &self,
        index: usize,
        choice: &Choice,
        (compensation, travel_m): (&mut CompensationSettings, [f64; 2]),
    ) -> Result<(), PredictionError> {
        let axis = &self.model.axis[index];
        if axis.residual_law.is_empty() {
            return Ok(());
        }
        let other = first_other(index).min(self.model.axis.len() - 1);
        let other_travel_m =
            mapped::known_m(&self.model.axis[other], mapped::travel_m(self.model, self.tests, other)?);
        let number = |axis: usize| u8::try_from(axis).unwrap_or(u8::MAX);
        let place = Place { own: number(index), other: number(other), travel_m, other_travel_m };
        for (part, term, refused) in law_terms(axis, index) {
            if refused.is_none() && choice.has(&part) {
                laws::add(compensation, term, &place);
            }
        }
        Ok(())
    }
}
