//! Periodic errors: up to two periodic tables, added up.

use super::names::CycleNames;
use super::settings::{CYCLES, Cycle};
use super::table::{PeriodicTable, ValueRange};
use crate::config::ConfigError;
use crate::scalar::Scalar;
use crate::units::Position;

/// One table per period.
#[derive(Clone, Copy, Debug)]
pub struct Cycles<S: Scalar> {
    count: usize,
    /// Tables beyond the count are zero.
    tables: [PeriodicTable<S>; CYCLES],
}

impl<S: Scalar> Cycles<S> {
    /// No table.
    pub const NONE: Self = Self { count: 0, tables: [PeriodicTable::ZERO; CYCLES] };

    /// Converts settings.
    ///
    /// # Errors
    /// [`ConfigError`] with one of `names`, as [`PeriodicTable::new`].
    pub fn new(
        names: &[CycleNames; CYCLES],
        settings: &[Cycle],
        range: ValueRange,
    ) -> Result<Self, ConfigError> {
        let mut cycles = Self::NONE;
        for ((table, cycle), names) in cycles.tables.iter_mut().zip(settings).zip(names) {
            *table = PeriodicTable::new(names, cycle, range)?;
            cycles.count += 1;
        }
        Ok(cycles)
    }

    /// Whether there is no table.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The sum at a position.
    #[must_use]
    #[inline]
    pub fn at(&self, position: Position) -> S {
        let [first, second] = &self.tables;
        let sum = first.at(position);
        if self.count > 1 { sum + second.at(position) } else { sum }
    }
}
