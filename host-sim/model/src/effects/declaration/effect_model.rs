//! What every effect declares, in its own file.

use shared::config::Rates;

use super::abscissa::Abscissa;
use super::context::{EffectContext, Misplaced, Neighbours, Placement, Prerequisite};
use super::coordinate::Coordinate;
use super::draw::Draw;
use super::identity::{Distinction, Occurrence};
use super::parameter::Parameter;
use super::stage::Stage;
use super::wording::Wording;
use crate::axis::Settings;

/// One kind of effect: everything about it that the simulator, the tracer, the report and the demo ask for, except its
/// place in the simulated machine.
pub trait EffectModel: Sized + Clone {
    /// Name in machine files and results.
    const NAME: &'static str;

    /// A key that tells this effect from another of the same name, where there is one.
    const TOLD_BY_KEY: Option<&'static str> = None;

    /// Its parameters, in the order of [`EffectModel::values`]. Those at the end may be missing from an effect.
    const PARAMETERS: &'static [Parameter];

    /// Whether an axis may have more than one.
    const OCCURRENCE: Occurrence;

    /// The stages of which at least one is needed to look for it. If none can be formed, what the first one lacks is
    /// the reason that is told.
    const SHOWN_IN: &'static [Stage];

    /// The number by which a seed of `demo` draws this effect; absent: it is not drawn. Numbers are never given
    /// again, and a new one changes what every seed draws.
    const DRAW_NUMBER: Option<u32> = None;

    /// What the machine file has to declare before this effect can be looked for.
    #[must_use]
    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::Met
    }

    /// What a machine file does not allow about this effect in its place; values are checked before.
    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        None
    }

    /// The stages whose residual it shapes; the one that it is first looked for in comes first.
    fn stages(&self) -> &'static [Stage];

    /// The values that a fit of this effect starts from: none if the axis lacks what the effect needs; several where the
    /// error is not convex (a period, a time constant).
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self>;

    /// The numbers to fit.
    fn coordinates(&self) -> Vec<Coordinate>;

    /// The numbers to fit on an axis with these loops, where the rates of the loops bound them.
    fn coordinates_at(&self, _rates: Rates) -> Vec<Coordinate> {
        self.coordinates()
    }

    /// The same effect at other coordinates, in the order of [`EffectModel::coordinates`].
    #[must_use]
    fn at(&self, coordinates: &[f64]) -> Self;

    /// Whether it is larger than what a declared model leaves open in any case.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        true
    }

    /// The values of its parameters.
    fn values(&self) -> Vec<f64>;

    /// What tells it from another of its name on the same axis.
    fn distinction(&self) -> Distinction<'_> {
        Distinction::None
    }

    /// What it does, as a clause without an end; every value that is not a phase occurs in it.
    fn sentence(&self, wording: &Wording) -> String;

    /// The variable over which its residual is drawn.
    fn abscissa(&self) -> Abscissa;

    /// One of a size that is worth a repair, drawn at random.
    fn draw(_draw: &mut Draw<'_>) -> Option<Self> {
        None
    }
}
