//! The friction of a motor for which none is declared.

use super::scope::{Mechanics, Scope};
use model::axis::Settings;
use model::effects::{Coordinate, Stage};

/// Coulomb friction of the motor, N, as a coordinate with the standard deviation of its prior about zero, if the machine file declares
/// none: it is unknown, not zero. `nominal` are the declared settings, `value_n` the present value. Table and force together show
/// it, as the screw does not transmit it. The deviation is the friction of the guideway.
#[must_use]
pub fn unknown_motor_friction(
    nominal: &Settings,
    value_n: Option<f64>,
    scope: &Scope,
) -> Option<(Coordinate, f64)> {
    let mechanics = &nominal.mechanics;
    let shows_it = scope.mechanics == Mechanics::All
        && [Stage::Table, Stage::Force].iter().all(|stage| scope.stages.contains(stage));
    let is_unknown = mechanics.motor_coulomb_n.is_none()
        && mechanics.spring_n_per_um().is_some()
        && mechanics.plant_tolerance_percent.is_some_and(|percent| percent > 0.0);
    let spread_n = mechanics.coulomb_n.filter(|&force_n| force_n > 0.0 && shows_it && is_unknown)?;
    let value_n = value_n.unwrap_or(0.0);
    Some((Coordinate::between(value_n, 0.01 * spread_n, 0.0, 10.0 * spread_n), spread_n))
}
