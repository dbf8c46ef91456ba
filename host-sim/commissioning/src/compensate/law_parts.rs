//! The terms of laws, and products of positions, as parts of a compensation.

use shared::compensate::CompensationSettings;

use crate::compensate::choice::{Choice, Part};
use crate::compensate::laws::{self, Place};
use crate::compensate::mapped;
use crate::compensate::planning::Planning;
use crate::compensate::prediction::PredictionError;
use model::machine::Axis;
use model::residual_law::Term;
use model::residual_table::{TableVariable, first_other};
use plant::tool_parameters::ToolParameters;

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
        let place = self.place([index, other], travel_m)?;
        for (part, term, refused) in law_terms(axis, index) {
            if refused.is_none() && choice.has(&part) {
                laws::add(compensation, term, &place);
            }
        }
        Ok(())
    }

    /// Adds the displacements of the tool of an axis by the product of its position and that of another one, as [`Self::add_laws`].
    pub(crate) fn add_position_products(
        &self,
        index: usize,
        tool: &ToolParameters,
        (compensation, travel_m): (&mut CompensationSettings, [f64; 2]),
    ) -> Result<(), PredictionError> {
        for (source, m_per_m2) in tool.per_position_product_m() {
            let Some(other) = self.model.axis.get_index_of(source) else { continue };
            // In m per m² it is the same number as in µm per mm².
            let of = vec![TableVariable::PositionMm, TableVariable::OtherPositionMm];
            let term = Term::Product { of, coefficient: m_per_m2 };
            laws::add(compensation, &term, &self.place([index, other], travel_m)?);
        }
        Ok(())
    }

    /// The travels of an axis, which its tables cover, and of another one, by their indices.
    fn place(&self, [own, other]: [usize; 2], travel_m: [f64; 2]) -> Result<Place, PredictionError> {
        let other_travel_m =
            mapped::known_m(&self.model.axis[other], mapped::travel_m(self.model, self.tests, other)?);
        let number = |axis: usize| u8::try_from(axis).unwrap_or(u8::MAX);
        Ok(Place { own: number(own), other: number(other), travel_m, other_travel_m })
    }
}
