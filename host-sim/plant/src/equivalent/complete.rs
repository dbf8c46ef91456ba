//! Axes of which enough is declared.

use model::machine::Axis;
use model::servo;

use crate::parameters::AxisParameters;

/// Whether an axis can be simulated as it is declared.
pub(super) fn is_complete(axis: &Axis) -> bool {
    let settings = &axis.settings;
    settings.has_mass() && servo::settings(settings, &AxisParameters::of(axis).servo).is_ok()
}
