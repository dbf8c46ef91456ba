//! Periodic errors: up to two periodic tables, added up.

use super::settings::{CYCLES, Cycle};
use super::table::{PeriodicTable, ValueRange};
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::Position;

/// One table per period; the empty ones are last.
#[derive(Clone, Copy, Debug)]
pub struct Cycles<S: Scalar>([Option<PeriodicTable<S>>; CYCLES]);

impl<S: Scalar> Cycles<S> {
    /// No table.
    pub const NONE: Self = Self([None; CYCLES]);

    /// Converts settings.
    ///
    /// # Errors
    /// [`ConfigError`] with `name`, as [`PeriodicTable::new`].
    pub fn new(name: &'static str, settings: &[Cycle], range: ValueRange) -> Result<Self, ConfigError> {
        let mut tables = [None; CYCLES];
        for (table, cycle) in tables.iter_mut().zip(settings) {
            *table = Some(PeriodicTable::new(name, cycle, range)?);
        }
        Ok(Self(tables))
    }

    /// Whether there is no table.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.0[0].is_none()
    }

    /// The sum at a position.
    #[must_use]
    pub fn at(&self, position: Position) -> S {
        let [first, second] = self.0.each_ref().map(|table| table.as_ref().map(|table| table.at(position)));
        match (first, second) {
            (Some(first), Some(second)) => first + second,
            (Some(first), None) => first,
            _ => S::ZERO,
        }
    }
}
