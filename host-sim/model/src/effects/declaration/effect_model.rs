//! The declaration of an effect.

use shared::config::Rates;

use super::abscissa::Abscissa;
use super::any_effect::AnyEffect;
use super::compensation::EffectCompensation;
use super::context::{EffectContext, Misplaced, Neighbours, Placement, Prerequisite};
use super::coordinate::Coordinate;
use super::draw::Draw;
use super::found::{Found, Substitute};
use super::harmonic::PeriodicError;
use super::identity::{Distinction, Occurrence};
use super::imitation::{Imitation, ImitationContext};
use super::mode::Mode;
use super::parameter::Parameter;
use super::residual_shape::ResidualShape;
use super::slope::SlopeOf;
use super::stage::Stage;
use super::timing::Timing;
use super::wording::Wording;
use crate::axis::{Drive, Settings};

/// One kind of effect: all that the simulator, the tracer, the report and the demo need, except the equation of motion,
/// which is in the crate `plant`.
pub trait EffectModel: Sized + Clone {
    /// Name in machine files and results.
    const NAME: &'static str;

    /// Description in half a line, for tables.
    const SUMMARY: &'static str;

    /// Key that distinguishes this kind from another kind of the same name, if there is one.
    const DISTINGUISHING_KEY: Option<&'static str> = None;

    /// Name of the ordinary effect of which this one is a special form: it is taken in place of that only if it gains as much as
    /// another effect must.
    const SPECIAL_FORM_OF: Option<&'static str> = None;

    /// Parameters in the order of [`EffectModel::values`]. Trailing parameters may be absent from an effect.
    const PARAMETERS: &'static [Parameter];

    /// Required keys whose value is a name, each with its meaning.
    const NAMED_KEYS: &'static [(&'static str, &'static str)] = &[];

    /// Keys whose value is a name and which may be absent, each with its meaning.
    const OPTIONAL_NAMED_KEYS: &'static [(&'static str, &'static str)] = &[];

    /// Whether an axis may have the effect more than once.
    const OCCURRENCE: Occurrence;

    /// Stages of which at least one is needed to search for the effect. If none can be evaluated, the reported reason
    /// is what the first stage lacks.
    const SHOWN_IN: &'static [Stage];

    /// Whether the predictions are linear in all coordinates that a fit varies: their derivatives are then computed once.
    const IS_LINEAR: bool = false;

    /// Whether the effect can be searched for only if every log has the force.
    const NEEDS_FORCE: bool = false;

    /// Whether it acts by the temperature: a log without that channel then cannot be compared with the model.
    const READS_TEMPERATURE: bool = false;

    /// The kinds of drive with which an axis can have the effect.
    const DRIVES: &'static [Drive] = Drive::ALL;

    /// Names of effects that this one contains as a limit of its parameters: it is no rival of one of these.
    const CONTAINS: &'static [&'static str] = &[];

    /// Names of declared effects whose values contain a part of this one if they were identified without it. Once it is found, they
    /// are fitted without their tolerance.
    const PART_OF_DECLARED: &'static [&'static str] = &[];

    /// Number by which a seed of `demo` selects this effect; absent: it is not drawn. Numbers are not reused. A new
    /// number changes the effect that each seed draws.
    const DRAW_NUMBER: Option<u32> = None;

    /// What the machine file must declare before this effect can be searched for.
    #[must_use]
    fn prerequisite(_axis: &Settings, _neighbours: Neighbours) -> Prerequisite {
        Prerequisite::Met
    }

    /// Why a machine file may not contain this effect on its axis, if so. The ranges of the values are checked before.
    fn misplaced(&self, _place: &Placement<'_>) -> Option<Misplaced> {
        None
    }

    /// Stages whose residual the effect changes, in the order in which it is searched for.
    fn stages(&self) -> &'static [Stage];

    /// Initial guesses of the fit: none if the axis lacks a prerequisite; several if the sum of squares is not convex
    /// (in a period, a time constant).
    fn initial_guesses(context: &EffectContext<'_>) -> Vec<Self>;

    /// The coordinates to fit.
    fn coordinates(&self) -> Vec<Coordinate>;

    /// The coordinates to fit on an axis with these loop rates, which may bound them.
    fn coordinates_at(&self, _rates: Rates) -> Vec<Coordinate> {
        self.coordinates()
    }

    /// This effect with other values of the coordinates, in the order of [`EffectModel::coordinates`].
    #[must_use]
    fn at(&self, coordinates: &[f64]) -> Self;

    /// Whether the effect is larger than the accuracy of a declared model. A smaller effect is not added.
    fn exceeds_tolerance(&self, _declared: &Settings, _rates: Rates) -> bool {
        true
    }

    /// What the logged channels do not tell apart from the effect, of the size and with the interval that were found. With one
    /// of them the effect is not certain.
    fn imitations(&self, _context: &ImitationContext<'_>) -> Vec<Imitation> {
        Vec::new()
    }

    /// This effect, if it may have been taken for the found one: both explain most of the same residual, and the other effects that
    /// decide between them are found later. Once all are found, it is tried in place of the found one.
    #[must_use]
    fn in_place_of(_found: &Found<'_>) -> Option<Substitute<Self>> {
        None
    }

    /// The forms of this effect that may be assumed before the mechanics are fitted, if it changes the force as a mass does: without it
    /// the fit of the mechanics has another mass, beside which no effect of the closed loop describes the motor.
    #[must_use]
    fn assumed() -> Vec<Self> {
        Vec::new()
    }

    /// A form of this effect that hides how friction changes the closed loop. It is fitted before the loop is asked whether it confirms
    /// a friction.
    #[must_use]
    fn hides_friction() -> Option<Self> {
        None
    }

    /// The effect that is added before this one, if the model does not have it: a part of what this one describes that is no
    /// part of its own coordinates. Judged alone, it may make a log worse.
    fn added_with(&self) -> Option<AnyEffect> {
        None
    }

    /// An effect that describes how this one varies over the position, by what its residual shows there and the travel, mm. Both are
    /// tried together if this one alone is not supported. The shape of the residual takes long to compute: it is asked for where it is
    /// needed.
    fn variation(&self, _residual: &dyn Fn() -> ResidualShape, _travel_mm: [f64; 2]) -> Option<AnyEffect> {
        None
    }

    /// The simpler form that says as much as this one where a fit takes a parameter of it to a limit of its range. `None`: there is none,
    /// and the effect is dropped there.
    fn at_its_limit(&self) -> Option<Self> {
        None
    }

    /// This effect with a finer resolution, if the residual that it leaves supports one.
    #[must_use]
    fn refined(&self, _residual: &dyn Fn() -> ResidualShape) -> Option<Self> {
        None
    }

    /// The form of the effect beside another one of its kind, with coordinates that are fixed while it is alone. `None`: the same.
    #[must_use]
    fn among_several(&self) -> Option<Self> {
        None
    }

    /// Other points at which the fit of this effect starts, beside another one of its kind.
    fn other_starts(&self) -> Vec<Self> {
        Vec::new()
    }

    /// This effect with another value of a key that is a name, if it has one that no coordinate of the fit describes. Once the effect is
    /// found, it is tried in its place; where the logs do not tell which it is, it is its rival.
    #[must_use]
    fn other_form(&self) -> Option<Self> {
        None
    }

    /// Mean and standard deviation of the prior of all coordinates, beside the declared settings.
    fn prior(&self, _declared: &Settings) -> Option<[f64; 2]> {
        None
    }

    /// The stage in which the effect describes a residual of any shape over the position: what remains there is no defect of its own.
    fn describes_any_shape_of(&self) -> Option<Stage> {
        None
    }

    /// Whether the effect differs between the directions of motion.
    fn depends_on_direction(&self) -> bool {
        false
    }

    /// The wave over the position of the screw that the effect is.
    fn wave(&self) -> Option<PeriodicError> {
        None
    }

    /// Whether a wave is no larger than what this effect leaves of the same part of the machine: a remainder.
    fn leaves(&self, _wave: PeriodicError) -> bool {
        false
    }

    /// The error of the linear scale that shows the same in the table stage.
    fn of_scale(&self) -> Option<AnyEffect> {
        None
    }

    /// What this effect is a slope of.
    fn slope(&self) -> Option<SlopeOf> {
        None
    }

    /// The mode of the tool that the effect is.
    fn mode(&self) -> Option<Mode> {
        None
    }

    /// The time that the effect describes.
    fn timing(&self) -> Option<Timing> {
        None
    }

    /// What logs that end at this time on the session clock (s) show of the effect, if they do not show the whole, by the half
    /// widths of its interval.
    fn within_logs(&self, _half_widths: &[f64], _end_s: f64) -> Option<AnyEffect> {
        None
    }

    /// The positions, mm, at which the effect is known, if it is an error over the position; without positions: on the travel of
    /// the logs.
    fn over_position(&self) -> Option<&[f64]> {
        None
    }

    /// What the controller does about the effect, or why it does nothing.
    fn compensation(&self) -> EffectCompensation;

    /// Values of the parameters, those of a list one after the other.
    fn values(&self) -> Vec<f64>;

    /// Number of values of each parameter; one unless it is a list.
    fn lengths(&self) -> Vec<usize> {
        vec![1; Self::PARAMETERS.len()]
    }

    /// The property that distinguishes effects of the same name on one axis.
    fn distinction(&self) -> Distinction<'_> {
        Distinction::None
    }

    /// Description as a clause without a full stop. It contains every value except phases.
    fn sentence(&self, wording: &Wording) -> String;

    /// The variable over which the residual is plotted.
    fn abscissa(&self) -> Abscissa;

    /// A random effect, large enough to require a repair.
    fn draw(_draw: &mut Draw<'_>) -> Option<Self> {
        None
    }
}
