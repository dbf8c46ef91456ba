//! From the values of a column to those of a channel.

use files::error::{InputError, quoted};

use crate::request::Request;
use crate::table::ForeignColumn;
use crate::unit::Quantity;

/// How the values of a column become those of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    /// Units of the log per unit of the column; of a velocity, per second.
    pub factor: f64,
    /// Whether the column is a velocity, which is integrated.
    pub is_rate: bool,
}

impl Conversion {
    /// A factor alone.
    #[must_use]
    pub const fn scale(factor: f64) -> Self {
        Self { factor, is_rate: false }
    }
}

/// What the units of columns follow from.
#[derive(Clone, Copy, Debug)]
pub struct Units<'a> {
    /// What the user says.
    pub request: &'a Request,
    /// Name of the file, for messages.
    pub source: &'a str,
}

impl Units<'_> {
    /// The conversion of a column, whose unit is that of the user, of the header, or else our own. Only the user's may be a velocity.
    ///
    /// # Errors
    /// If the unit is none of the quantity, or a velocity that only the header names.
    pub fn conversion(
        &self,
        ours: &str,
        quantity: Quantity,
        column: &ForeignColumn,
        notes: &mut Vec<String>,
    ) -> Result<Conversion, InputError> {
        let asked = self.request.units.iter().find(|unit| unit.ours == ours).map(|unit| unit.unit.as_str());
        let name = quoted(&column.name);
        let Some(unit) = asked.or(column.unit.as_deref()) else {
            if column.name != ours {
                let own = ours.rsplit('_').next().unwrap_or_default();
                notes.push(format!(
                    "{ours}: column {name} is taken as {own}; --unit {ours}=UNIT says otherwise"
                ));
            }
            return Ok(Conversion::scale(1.0));
        };
        if let Some(factor) = quantity.factor(unit) {
            notes.push(format!("{ours}: column {name}, {unit}"));
            return Ok(Conversion::scale(factor));
        }
        let place = if asked.is_some() { "--unit" } else { self.source };
        let expected = |what: String| InputError::expected(place, what, quoted(unit)).at_key(ours);
        match quantity.rate_factor(unit) {
            None => Err(expected(quantity.allowed())),
            Some(_) if asked.is_none() => {
                Err(expected(format!("a position, or --unit {ours}={unit} to integrate the velocity")))
            }
            Some(factor) => {
                notes.push(format!(
                    "{ours}: column {name}, {unit}, is integrated: the position begins at zero, and its drift is not known"
                ));
                Ok(Conversion { factor, is_rate: true })
            }
        }
    }
}
