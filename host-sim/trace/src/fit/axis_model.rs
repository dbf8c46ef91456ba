//! The model of one axis in a fit. Its free parameters are in [`free_parameters`].

mod free_parameters;

pub use free_parameters::FreeParameter;

use shared::config::Rates;

use super::held_effects;
use super::limits::{self, ParameterAtLimit};
use super::scope::{Mechanics, Scope};
use super::trim::{FIRST_DRIVES, Trims};
use crate::options::ModelOptions;
use model::axis::{Drive, TOLERATED, Tolerated};
use model::effects::{Effect, Stage};
use model::machine::Axis;
use model::machine::nominal::{LogOffsets, Nominal, fit_range};
use plant::parameters::AxisParameters;

/// The model of one axis during a trace.
#[derive(Clone, Debug)]
pub struct AxisModel {
    /// The axis of the machine file.
    declared: Axis,
    /// The declared axis at its nominal values, which are the centres of the tolerances.
    nominal: Axis,
    /// The axis with fitted values. Its effects are the declared ones, followed by those found.
    pub axis: Axis,
    /// Zero of the linear scale relative to the motor's, µm.
    pub table_zero_um: f64,
    /// Zero of the tool-point probe relative to the table's, µm.
    pub tool_zero_um: f64,
    /// Timing that the machine file does not declare.
    trims: Trims,
    rates: Rates,
    options: ModelOptions,
    /// Whether each declared effect is held at its declared values: see [`held_effects`].
    held: Vec<bool>,
    /// Keys whose values are bounded by their tolerance.
    within_tolerance: Vec<&'static str>,
    /// Value of the mass that [`Mechanics::MotorMass`] fits, from the fit to table and force.
    pinned_mass_kg: Option<[f64; 2]>,
}

impl AxisModel {
    /// The declared model.
    #[must_use]
    pub fn new(declared: &Axis, rates: Rates, options: ModelOptions) -> Self {
        let offsets = declared.log_offsets.unwrap_or_default();
        Self {
            declared: declared.clone(),
            nominal: declared.at_nominal(),
            axis: declared.clone(),
            table_zero_um: offsets.table_zero_um.unwrap_or(0.0),
            tool_zero_um: offsets.tool_zero_um.unwrap_or(0.0),
            trims: Trims::of(declared, rates, &options),
            rates,
            options,
            held: held_effects::held(&declared.effect),
            within_tolerance: Vec::new(),
            pinned_mass_kg: None,
        }
    }

    /// After a fit of all mechanics to a force, pins the mass to its fitted value: the motor stage may change it by 1 % only,
    /// or by the half width of its interval if the force determines it less well; an error of the mass would otherwise be an
    /// error of the controller's gain. Without a force, the motor stage determines the mass.
    pub fn pin_mass(&mut self, scope: &Scope, half_width_kg: f64) {
        if scope.mechanics == Mechanics::All && scope.stages.contains(&Stage::Force) {
            let mass_alone = Scope { stages: Vec::new(), mechanics: Mechanics::MotorMass, ..scope.clone() };
            let mass =
                self.adjustable(&mass_alone).next().and_then(|(key, _)| (key.get)(&self.axis.settings));
            self.pinned_mass_kg = mass.map(|mass_kg| [mass_kg, half_width_kg]);
        }
    }

    /// Pins the mass again, after a step of the fit of this scope that pinned it, see [`AxisModel::pin_mass`].
    pub fn update_mass_constraint(&mut self, scope: &Scope) {
        if let Some([_, half_width_kg]) = self.pinned_mass_kg {
            self.pin_mass(scope, half_width_kg);
        }
    }

    /// The declared axis at its nominal values.
    #[must_use]
    pub fn nominal(&self) -> &Axis {
        &self.nominal
    }

    /// Whether the machine file was written by a trace.
    #[must_use]
    pub fn was_fitted(&self) -> bool {
        self.declared.nominal.is_some() || self.declared.log_offsets.is_some()
    }

    /// The axis for the machine file that `--model` writes: fitted values, nominal values (the centres of the tolerances),
    /// and offsets of the fitted logs.
    #[must_use]
    pub fn written(&self) -> Axis {
        let mut nominal = Nominal::default();
        let mut offsets = LogOffsets::default();
        for (key, centre) in self.tolerated_keys() {
            nominal.set(key.key, centre);
        }
        if self.tolerance() > 0.0 {
            let declared = self.nominal.effect.iter().zip(&self.axis.effect);
            // The nominal value of an effect that was fitted without a tolerance is its fitted value.
            let centre = |(nominal, fitted)| if self.is_untolerated(fitted) { fitted } else { nominal };
            nominal.effect = declared.map(centre).cloned().collect();
        }
        self.trims.write(&self.axis, &mut offsets);
        let zero = |um: f64| (um != 0.0).then_some(um);
        offsets.table_zero_um = zero(self.table_zero_um);
        offsets.tool_zero_um = zero(self.tool_zero_um);
        Axis {
            nominal: (nominal != Nominal::default()).then_some(nominal),
            log_offsets: (offsets != LogOffsets::default()).then_some(offsets),
            ..self.axis.clone()
        }
    }

    /// This model with its declared values at their nominal values.
    #[must_use]
    pub fn at_nominal(&self) -> Self {
        let mut model = self.clone();
        for key in TOLERATED {
            if let Some(value) = (key.get)(&self.nominal.settings) {
                (key.set)(&mut model.axis.settings, value);
            }
        }
        model
    }

    /// This model with a declared value bounded by its tolerance, and moved to the bound if it is beyond.
    #[must_use]
    pub fn within_tolerance(&self, key: &Tolerated) -> Self {
        let mut model = self.clone();
        model.within_tolerance.push(key.key);
        if let Some((nominal, value)) = (key.get)(&self.nominal.settings).zip((key.get)(&self.axis.settings))
        {
            let [least, most] = model.range(key, nominal);
            (key.set)(&mut model.axis.settings, value.clamp(least, most));
        }
        model
    }

    /// This model with all declared values bounded by their tolerance, from their nominal values.
    #[must_use]
    pub fn all_within_tolerance(&self) -> Self {
        let mut model = self.at_nominal();
        model.within_tolerance = TOLERATED.iter().map(|key| key.key).collect();
        model
    }

    /// This model without the bounds of [`AxisModel::all_within_tolerance`].
    #[must_use]
    pub fn without_bounds(&self) -> Self {
        Self { within_tolerance: Vec::new(), ..self.clone() }
    }

    /// Whether declared values are bounded by their tolerance, see [`AxisModel::within_tolerance`].
    #[must_use]
    pub fn has_bounds(&self) -> bool {
        !self.within_tolerance.is_empty()
    }

    /// Whether a declared value is outside its tolerance.
    #[must_use]
    pub fn is_beyond_tolerance(&self) -> bool {
        self.tolerated_keys().any(|(key, nominal)| {
            let value = (key.get)(&self.axis.settings).unwrap_or(nominal);
            (value / nominal - 1.0).abs() > 1.0001 * self.tolerance_of(key)
        })
    }

    /// The range in which a fit may move a declared value.
    fn range(&self, key: &Tolerated, nominal: f64) -> [f64; 2] {
        let tolerance = self.tolerance_of(key);
        if self.within_tolerance.contains(&key.key) {
            return [nominal * (1.0 - tolerance), nominal * (1.0 + tolerance)];
        }
        fit_range(key, nominal, tolerance)
    }

    /// Keys of declared values that ended at a bound of their range, including poorly determined ones.
    #[must_use]
    pub fn at_bounds(&self) -> Vec<&'static str> {
        let is_at_bound = |(key, nominal): &(&'static Tolerated, f64)| {
            let [least, most] = self.range(key, *nominal);
            let value = (key.get)(&self.axis.settings).unwrap_or(*nominal);
            value < 1.0001 * least || value > 0.9999 * most
        };
        self.tolerated_keys().filter(is_at_bound).map(|(key, _)| key.key).collect()
    }

    /// The effects found.
    #[must_use]
    pub fn found(&self) -> &[Effect] {
        &self.axis.effect[self.declared.effect.len()..]
    }

    /// The parameter of a found effect, by its index in [`AxisModel::found`], that is at a limit of its search range.
    #[must_use]
    pub fn at_limit(&self, found: usize) -> Option<ParameterAtLimit> {
        self.found().get(found).and_then(|effect| limits::of(effect, self.rates))
    }

    /// The first found effect with a parameter at a limit of its search range: its index and the limit.
    #[must_use]
    pub fn first_at_limit(&self) -> Option<(usize, ParameterAtLimit)> {
        (0..self.found().len()).find_map(|index| Some((index, self.at_limit(index)?)))
    }

    /// This model with an effect added.
    #[must_use]
    pub fn with(&self, effect: Effect) -> Self {
        let mut model = self.clone();
        model.axis.effect.push(effect);
        model
    }

    /// The declared model with an effect assumed, which is held at its values as if it were declared.
    #[must_use]
    pub fn assuming(&self, effect: &Effect) -> Self {
        let mut model = self.clone();
        for axis in [&mut model.declared, &mut model.nominal, &mut model.axis] {
            axis.effect.push(effect.clone());
        }
        model.held.push(true);
        model
    }

    /// The model in which the effect that was [assumed](Self::assuming) is one of those found, in the order of the scopes in which they
    /// are found.
    #[must_use]
    pub fn with_assumed_as_found(&self, scopes: &[Scope]) -> Self {
        let mut model = self.clone();
        for axis in [&mut model.declared, &mut model.nominal] {
            axis.effect.pop();
        }
        model.held.pop();
        let scope_of = |effect: &Effect| scopes.iter().position(|scope| scope.holds(effect));
        model.axis.effect[self.declared.effect.len() - 1..].sort_by_key(scope_of);
        model
    }

    /// This model without the found effect at an index of [`AxisModel::found`].
    #[must_use]
    pub fn without(&self, found: usize) -> Self {
        let mut model = self.clone();
        model.axis.effect.remove(self.declared.effect.len() + found);
        model
    }

    /// This model with the found effect at an index of [`AxisModel::found`] in its other form, if it has one.
    #[must_use]
    pub fn in_other_form(&self, found: usize) -> Option<Self> {
        let form = self.found().get(found)?.other_form()?;
        let mut model = self.clone();
        model.axis.effect[self.declared.effect.len() + found] = form;
        Some(model)
    }

    /// This model with other first values of a drive whose velocity is commanded: the fit of its time constant, integral part and dead
    /// time has several optima. None for another drive, and for a file that a trace wrote.
    #[must_use]
    pub fn other_starts(&self, scope: &Scope) -> Vec<Self> {
        let is_unknown = self.declared.settings.controller.drive == Drive::Velocity && !self.was_fitted();
        let others = if is_unknown && scope.stages.contains(&Stage::Motor) { &FIRST_DRIVES[..] } else { &[] };
        let other = |&drive: &[f64; 2]| Self { trims: self.trims.with_velocity_drive(drive), ..self.clone() };
        others.iter().map(other).collect()
    }

    /// Parameters for the simulation of the axis.
    #[must_use]
    pub fn parameters(&self) -> AxisParameters {
        self.trims.applied(AxisParameters::of(&self.axis), &self.axis.effect)
    }

    /// Relative tolerance of the declared mechanical values that have none of their own, and of the declared effects.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        0.01 * self.declared.settings.mechanics.plant_tolerance_percent.unwrap_or(0.0)
    }

    /// Relative tolerance of a declared value.
    #[must_use]
    pub fn tolerance_of(&self, key: &Tolerated) -> f64 {
        key.tolerance(&self.declared.settings)
    }

    /// The larger relative tolerance of the masses.
    #[must_use]
    pub fn mass_tolerance(&self) -> f64 {
        numerics::max(TOLERATED.iter().filter(|key| key.is_mass()).map(|key| self.tolerance_of(key)))
    }

    /// Sum of the nominal masses.
    #[must_use]
    pub fn nominal_mass_kg(&self) -> f64 {
        let mechanics = &self.nominal.settings.mechanics;
        [mechanics.motor_mass_kg, mechanics.table_mass_kg].into_iter().flatten().sum()
    }

    /// Keys with a tolerance, with their nominal values.
    fn tolerated_keys(&self) -> impl Iterator<Item = (&'static Tolerated, f64)> {
        TOLERATED
            .iter()
            .filter_map(|key| (key.get)(&self.nominal.settings).filter(|&v| v > 0.0).map(|v| (key, v)))
            .filter(|(key, _)| self.tolerance_of(key) > 0.0)
    }

    /// Whether a declared effect is fitted without its tolerance: a found one is a part of it if it was identified without that. A
    /// load identified with symmetric friction, for example, contains the mean of the asymmetry over the motion.
    fn is_untolerated(&self, declared: &Effect) -> bool {
        self.found().iter().any(|found| found.kind().part_of_declared.contains(&declared.name()))
    }
}
