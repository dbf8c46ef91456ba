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

#[cfg(test)]
mod tests {
    use super::*;

    /// A reading of 100 and 200 with shifts of 7 and −20: each by its own, and two shifts in a row by their sums.
    #[test]
    fn motor_and_scale_are_shifted_each_by_its_own_distance() {
        let first = OriginShift { motor: 7, table: -20 };
        let then = OriginShift { motor: 1000, table: 3 };
        let reading = Reading { motor: Position(100), table: Some(Position(200)) };
        let shifted = reading.shifted(first);
        assert_eq!(shifted, Reading { motor: Position(107), table: Some(Position(180)) });
        assert_eq!(shifted.shifted(then), reading.shifted(first.then(then)));
        assert_eq!(first.then(then), OriginShift { motor: 1007, table: -17 });
        assert_eq!(Reading { table: None, ..reading }.shifted(first).table, None);
    }
}
