//! The free parameters of the model of an axis in a fit.

use super::AxisModel;
use crate::fit::scope::{Mechanics, Scope};
use crate::fit::trim::Instant;
use crate::fit::unknown_friction::unknown_motor_friction;
use model::axis::{TOLERATED, Tolerated};
use model::effects::{Coordinate, Effect, Stage};
use model::machine::nominal::MAX_TOLERANCES;

/// A free parameter of a fit.
#[derive(Clone, Copy, Debug)]
pub struct FreeParameter {
    /// Value, step and bounds.
    pub coordinate: Coordinate,
    /// Normal prior: mean and standard deviation.
    pub prior: Option<(f64, f64)>,
}

impl AxisModel {
    /// The declared values that a scope fits, each with its nominal value and its index among the free parameters.
    pub fn declared_values(&self, scope: &Scope) -> impl Iterator<Item = (usize, &'static Tolerated, f64)> {
        let zeros = [Stage::Table, Stage::Tool].iter().filter(|stage| scope.stages.contains(stage)).count();
        let first = zeros + self.trimmed(scope).len();
        self.adjustable(scope).enumerate().map(move |(i, (key, nominal))| (first + i, key, nominal))
    }

    /// Indices of a found effect's coordinates among the free parameters of a scope.
    #[must_use]
    pub fn indices_of(&self, scope: &Scope, found: usize) -> std::ops::Range<usize> {
        let index = self.declared.effect.len() + found;
        let mut start = self.free_parameters(scope).len();
        for effect in self.axis.effect[index..].iter().filter(|effect| scope.holds(effect)) {
            start -= effect.coordinates().len();
        }
        let width = self.axis.effect.get(index).map_or(0, |effect| effect.coordinates().len());
        start..start + width
    }

    /// Indices of the coordinates of the effect that was added last among the free parameters of a scope; empty without
    /// one.
    #[must_use]
    pub fn indices_of_last(&self, scope: &Scope) -> std::ops::Range<usize> {
        let end = self.free_parameters(scope).len();
        let last = self.found().iter().rev().find(|effect| scope.holds(effect));
        end - last.map_or(0, |effect| effect.coordinates().len())..end
    }

    /// The free parameters of a scope, in this order: zeros, timing, declared values, effects.
    #[must_use]
    pub fn free_parameters(&self, scope: &Scope) -> Vec<FreeParameter> {
        let free = |coordinate| FreeParameter { coordinate, prior: None };
        let mut parameters = Vec::new();
        for (stage, zero) in [(Stage::Table, self.table_zero_um), (Stage::Tool, self.tool_zero_um)] {
            if scope.stages.contains(&stage) {
                parameters.push(free(Coordinate::signed(zero, 0.01, 1e6)));
            }
        }
        parameters.extend(
            self.trimmed(scope)
                .into_iter()
                .map(|(_, coordinate, spread)| FreeParameter { coordinate, prior: Some((0.0, spread)) }),
        );
        parameters.extend(
            self.adjustable(scope).map(|(key, centre)| self.declared_value(key, centre, scope.mechanics)),
        );
        parameters.extend(
            self.unknown_friction(scope)
                .map(|(coordinate, spread_n)| FreeParameter { coordinate, prior: Some((0.0, spread_n)) }),
        );
        for (i, effect) in self.effects_of(scope) {
            let declared = self.nominal.effect.get(i).map(Effect::coordinates);
            for (j, coordinate) in effect.coordinates_at(self.rates).into_iter().enumerate() {
                parameters.push(match &declared {
                    None => FreeParameter {
                        coordinate,
                        prior: effect.prior(&self.nominal.settings).map(|[mean, spread]| (mean, spread)),
                    },
                    Some(_) if self.is_untolerated(effect) => free(coordinate),
                    Some(declared) => {
                        let centre = declared[j].value;
                        let most = MAX_TOLERANCES * self.tolerance() * centre.abs();
                        self.tolerated(coordinate, (centre, self.tolerance()), [centre - most, centre + most])
                    }
                });
            }
        }
        parameters
    }

    fn unknown_friction(&self, scope: &Scope) -> Option<(Coordinate, f64)> {
        let value_n = self.axis.settings.mechanics.motor_coulomb_n;
        unknown_motor_friction(&self.nominal.settings, value_n, scope)
    }

    /// A declared value as a free parameter within its range; a pinned mass within 1 % of all masses or its half width.
    fn declared_value(&self, key: &Tolerated, centre: f64, mechanics: Mechanics) -> FreeParameter {
        let value = (key.get)(&self.axis.settings).unwrap_or(centre);
        let range = self.range(key, centre);
        let coordinate = Coordinate::signed(value, 0.01 * centre, f64::INFINITY);
        let mut parameter = self.tolerated(coordinate, (centre, self.tolerance_of(key)), range);
        let pinned = self.pinned_mass_kg.filter(|_| !key.is_of_controller);
        if let (Mechanics::MotorMass, Some([pinned_kg, half_width_kg])) = (mechanics, pinned) {
            let trim = half_width_kg.max(self.options.mass_trim * self.nominal_mass_kg());
            let Coordinate { lower, upper, .. } = parameter.coordinate;
            parameter.coordinate.lower = lower.max(pinned_kg - trim);
            parameter.coordinate.upper = upper.min(pinned_kg + trim);
        }
        parameter
    }

    /// The model at other values of its [`AxisModel::free_parameters`].
    #[must_use]
    pub fn at(&self, scope: &Scope, values: &[f64]) -> Self {
        let mut model = self.clone();
        let mut values = values.iter().copied();
        let mut next = |old: f64| values.next().unwrap_or(old);
        if scope.stages.contains(&Stage::Table) {
            model.table_zero_um = next(self.table_zero_um);
        }
        if scope.stages.contains(&Stage::Tool) {
            model.tool_zero_um = next(self.tool_zero_um);
        }
        for (instant, coordinate, _) in self.trimmed(scope) {
            model.trims.set_ms(instant, next(coordinate.value));
        }
        for (key, centre) in self.adjustable(scope) {
            (key.set)(&mut model.axis.settings, next(centre));
        }
        if let Some((coordinate, _)) = self.unknown_friction(scope) {
            model.axis.settings.mechanics.motor_coulomb_n = Some(next(coordinate.value));
        }
        for (i, effect) in self.effects_of(scope) {
            let moved: Vec<f64> = effect.coordinates().iter().map(|c| next(c.value)).collect();
            model.axis.effect[i] = effect.at(&moved);
        }
        model
    }

    fn trimmed(&self, scope: &Scope) -> Vec<(Instant, Coordinate, f64)> {
        self.trims.coordinates(&scope.stages, &self.axis, self.rates, &self.options)
    }

    /// Declared keys that a scope fits, with their nominal values: those of the mechanics, then the settings of the controller, which
    /// the motor stage shows. The first is the mass of the motor or, if a rigid axis declares only one mass, that mass.
    pub(super) fn adjustable(&self, scope: &Scope) -> impl Iterator<Item = (&'static Tolerated, f64)> {
        let mechanics = self.tolerated_keys().filter(|(key, _)| !key.is_of_controller);
        let settings = self.tolerated_keys().filter(|(key, _)| key.is_of_controller);
        let shows_controller = scope.stages.contains(&Stage::Motor);
        let mechanics = mechanics.take(match scope.mechanics {
            Mechanics::All | Mechanics::Values => TOLERATED.len(),
            Mechanics::MotorMass => 1,
            Mechanics::None => 0,
        });
        mechanics.chain(settings.filter(move |_| shows_controller))
    }

    /// A coordinate bounded by a range, with a normal prior about its nominal value, by its relative tolerance.
    fn tolerated(
        &self,
        coordinate: Coordinate,
        (nominal, tolerance): (f64, f64),
        [least, most]: [f64; 2],
    ) -> FreeParameter {
        let spread = self.options.prior * tolerance * nominal.abs();
        let bounded = Coordinate {
            lower: coordinate.lower.max(least).min(nominal),
            upper: coordinate.upper.min(most).max(nominal),
            ..coordinate
        };
        FreeParameter { coordinate: bounded, prior: (spread > 0.0).then_some((nominal, spread)) }
    }

    /// The effects that a scope fits, each with its index.
    fn effects_of(&self, scope: &Scope) -> impl Iterator<Item = (usize, &Effect)> {
        let is_held = |index: usize| self.held.get(index).copied().unwrap_or(false);
        let all = self.axis.effect.iter().enumerate();
        all.filter(move |(index, effect)| scope.holds(effect) && !is_held(*index))
    }
}
