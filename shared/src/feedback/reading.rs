//! The sensor readings of an axis.

use crate::units::Position;

/// The sensor readings of an axis at one tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// Motor encoder or resolver, converted to table travel.
    pub motor: Position,
    /// Linear scale; `None` if there is none, or if its signal is lost.
    pub table: Option<Position>,
}
