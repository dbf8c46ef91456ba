//! The sensor readings of an axis.

use crate::units::Position;

/// Distances by which the readings of an axis are shifted when its origin is set, position units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OriginShift {
    /// Motor encoder or resolver.
    pub motor: i64,
    /// Linear scale.
    pub table: i64,
}

impl OriginShift {
    /// Both shifts one after the other.
    #[must_use]
    pub const fn then(self, other: Self) -> Self {
        Self { motor: self.motor.wrapping_add(other.motor), table: self.table.wrapping_add(other.table) }
    }
}

/// The sensor readings of an axis at one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// Motor encoder or resolver, converted to table travel.
    pub motor: Position,
    /// Linear scale; `None` if there is none, or if its signal is lost.
    pub table: Option<Position>,
}

impl Reading {
    /// The readings from a shifted origin.
    #[must_use]
    pub fn shifted(self, origin: OriginShift) -> Self {
        Self { motor: self.motor + origin.motor, table: self.table.map(|table| table + origin.table) }
    }
}
