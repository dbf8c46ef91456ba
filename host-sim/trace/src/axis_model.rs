//! The model of one axis and the numbers in it that a fit may move.

use shared::config::Rates;

use super::limits::{self, AtLimit};
use super::scope::{Mechanics, Scope};
use super::trim::{Instant, Trims};
use model::effects::{Coordinate, Effect, Stage};
use model::machine::Axis;
use model::machine::nominal::{LogOffsets, Nominal, TOLERATED, Tolerated};
use plant::parameters::AxisParameters;

/// One axis: what is declared of it, with values and effects as fitted so far.
#[derive(Clone, Debug)]
pub struct AxisModel {
    /// As in the machine file.
    declared: Axis,
    /// The same at its nominal values, the centres of the tolerances.
    nominal: Axis,
    /// With fitted values, declared and found effects.
    pub axis: Axis,
    /// Zero of the linear scale against the motor's, µm.
    pub table_zero_um: f64,
    /// Zero of the tool-point probe against the table's, µm.
    pub tool_zero_um: f64,
    /// Instants that the machine file leaves open.
    trims: Trims,
    rates: Rates,
    /// The mass that [`Mechanics::MotorMass`] fits, as the mechanics were fitted with it.
    weighed_kg: Option<f64>,
}

/// How far the motor stage may move a mass that was fitted to the force, as a share of all masses:
/// what filtering and stepping leave uncertain.
const WEIGHING: f64 = 0.01;

/// A number that a fit may move.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    /// Value, step and bounds.
    pub coordinate: Coordinate,
    /// What is known of it beforehand: centre and spread.
    pub prior: Option<(f64, f64)>,
}

impl AxisModel {
    /// The declared model.
    #[must_use]
    pub fn new(declared: &Axis, rates: Rates) -> Self {
        let [table_zero_um, tool_zero_um] = declared
            .log_offsets
            .as_ref()
            .map_or([0.0; 2], |offsets| offsets.zeros_um().map(|(_, um)| um.unwrap_or(0.0)));
        Self {
            declared: declared.clone(),
            nominal: declared.at_nominal(),
            axis: declared.clone(),
            table_zero_um,
            tool_zero_um,
            trims: Trims::of(declared, rates),
            rates,
            weighed_kg: None,
        }
    }

    /// Holds the mass where the mechanics were fitted with it: the motor stage may only trim it.
    pub fn weigh(&mut self, scope: &Scope) {
        if scope.mechanics == Mechanics::All {
            let weighing = Scope { stages: Vec::new(), mechanics: Mechanics::MotorMass };
            let weighed =
                self.adjustable(&weighing).next().and_then(|(key, _)| (key.get)(&self.axis.settings));
            self.weighed_kg = weighed;
        }
    }

    /// The axis as the machine file has it, at its nominal values.
    #[must_use]
    pub fn nominal(&self) -> &Axis {
        &self.nominal
    }

    /// Whether the machine file is that of a trace.
    #[must_use]
    pub fn was_fitted(&self) -> bool {
        self.declared.nominal.is_some() || self.declared.log_offsets.is_some()
    }

    /// The axis of the better machine file: fitted, with what the fit was held to and with the offsets of its logs.
    #[must_use]
    pub fn written(&self) -> Axis {
        let mut nominal = Nominal::default();
        let mut offsets = LogOffsets::default();
        for (key, centre) in self.tolerated_keys() {
            (key.set_nominal)(&mut nominal, centre);
        }
        if self.tolerance() > 0.0 {
            let declared = self.nominal.effect.iter().zip(&self.axis.effect);
            // What was let go of its tolerance has a new centre.
            let centre = |(nominal, fitted)| if self.trades(fitted) { fitted } else { nominal };
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

    /// The same model with its declared values as they are declared.
    #[must_use]
    pub fn unbent(&self) -> Self {
        let mut model = self.clone();
        for key in TOLERATED {
            if let Some(value) = (key.get)(&self.nominal.settings) {
                (key.set)(&mut model.axis.settings, value);
            }
        }
        model
    }

    /// Keys of declared values that ended at a bound of their tolerance, of those that any motion should show.
    #[must_use]
    pub fn at_bounds(&self) -> Vec<&'static str> {
        const HARDLY_SHOWN: [&str; 3] =
            ["damping_n_s_per_m", "presliding_stiffness_n_per_um", "presliding_damping_n_s_per_m"];
        let is_at_bound = |key: &&Tolerated| {
            let values = (key.get)(&self.nominal.settings).zip((key.get)(&self.axis.settings));
            let spread = |declared: f64| self.tolerance() * declared.abs();
            values.is_some_and(|(declared, value)| {
                spread(declared) > 0.0 && (value - declared).abs() > 0.9999 * spread(declared)
            })
        };
        let at_bounds = TOLERATED.iter().filter(|key| !HARDLY_SHOWN.contains(&key.key)).filter(is_at_bound);
        at_bounds.map(|key| key.key).collect()
    }

    /// The effects that were found.
    #[must_use]
    pub fn found(&self) -> &[Effect] {
        &self.axis.effect[self.declared.effect.len()..]
    }

    /// Which parameter of a found effect, by its index in [`AxisModel::found`], stands at a limit of its search.
    #[must_use]
    pub fn at_limit(&self, found: usize) -> Option<AtLimit> {
        self.found().get(found).and_then(|effect| limits::of(effect, self.rates))
    }

    /// The same model with one effect more.
    #[must_use]
    pub fn with(&self, effect: Effect) -> Self {
        let mut model = self.clone();
        model.axis.effect.push(effect);
        model
    }

    /// The same model without the found effect at an index of [`AxisModel::found`].
    #[must_use]
    pub fn without(&self, found: usize) -> Self {
        let mut model = self.clone();
        model.axis.effect.remove(self.declared.effect.len() + found);
        model
    }

    /// Where the coordinates of a found effect stand among the slots of a scope.
    #[must_use]
    pub fn slots_of(&self, scope: &Scope, found: usize) -> std::ops::Range<usize> {
        let index = self.declared.effect.len() + found;
        let mut start = self.slots(scope).len();
        for effect in self.axis.effect[index..].iter().filter(|effect| scope.holds(effect)) {
            start -= effect.coordinates().len();
        }
        let width = self.axis.effect.get(index).map_or(0, |effect| effect.coordinates().len());
        start..start + width
    }

    /// Where the coordinates of the effect that was added last stand among the slots of a scope; none without one.
    #[must_use]
    pub fn last_slots(&self, scope: &Scope) -> std::ops::Range<usize> {
        let end = self.slots(scope).len();
        let last = self.found().iter().rev().find(|effect| scope.holds(effect));
        end - last.map_or(0, |effect| effect.coordinates().len())..end
    }

    /// The numbers that a fit of a scope may move: zeros, declared values, effects.
    #[must_use]
    pub fn slots(&self, scope: &Scope) -> Vec<Slot> {
        let free = |coordinate| Slot { coordinate, prior: None };
        let mut slots = Vec::new();
        for (stage, zero) in [(Stage::Table, self.table_zero_um), (Stage::Tool, self.tool_zero_um)] {
            if scope.stages.contains(&stage) {
                slots.push(free(Coordinate::signed(zero, 0.01, 1e6)));
            }
        }
        let trimmed = self.trimmed(scope).into_iter();
        slots.extend(trimmed.map(|(_, coordinate, spread)| Slot { coordinate, prior: Some((0.0, spread)) }));
        slots.extend(self.adjustable(scope).map(|(key, centre)| {
            let value = (key.get)(&self.axis.settings).unwrap_or(centre);
            let mut slot = self.tolerated(Coordinate::signed(value, 0.01 * centre, f64::INFINITY), centre);
            if let (Mechanics::MotorMass, Some(weighed)) = (scope.mechanics, self.weighed_kg) {
                let mechanics = &self.nominal.settings.mechanics;
                let masses = [mechanics.motor_mass_kg, mechanics.table_mass_kg];
                let trim = WEIGHING * masses.into_iter().flatten().sum::<f64>();
                let Coordinate { lower, upper, .. } = slot.coordinate;
                slot.coordinate.lower = lower.max(weighed - trim);
                slot.coordinate.upper = upper.min(weighed + trim);
            }
            slot
        }));
        for (i, effect) in self.effects_of(scope) {
            let declared = self.nominal.effect.get(i).map(Effect::coordinates);
            for (j, coordinate) in effect.coordinates_at(self.rates).into_iter().enumerate() {
                slots.push(match &declared {
                    None => free(coordinate),
                    Some(_) if self.trades(effect) => free(coordinate),
                    Some(declared) => self.tolerated(coordinate, declared[j].value),
                });
            }
        }
        slots
    }

    /// The model at other values of its [`AxisModel::slots`].
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
        for (i, effect) in self.effects_of(scope) {
            let moved: Vec<f64> = effect.coordinates().iter().map(|c| next(c.value)).collect();
            model.axis.effect[i] = effect.at(&moved);
        }
        model
    }

    /// What the simulation of the axis needs, with trimmed instants.
    #[must_use]
    pub fn parameters(&self) -> AxisParameters {
        self.trims.applied(AxisParameters::of(&self.axis), &self.axis.effect)
    }

    fn trimmed(&self, scope: &Scope) -> Vec<(Instant, Coordinate, f64)> {
        self.trims.coordinates(&scope.stages, &self.axis, self.rates)
    }

    fn tolerance(&self) -> f64 {
        0.01 * self.declared.settings.mechanics.plant_tolerance_percent.unwrap_or(0.0)
    }

    /// Declared keys that a scope fits, and their declared values. A rigid axis has its mass where the
    /// file puts it: the first mass that is not zero stands for both.
    fn adjustable(&self, scope: &Scope) -> impl Iterator<Item = (&'static Tolerated, f64)> {
        self.tolerated_keys().take(match scope.mechanics {
            Mechanics::All => TOLERATED.len(),
            Mechanics::MotorMass => 1,
            Mechanics::None => 0,
        })
    }

    /// Keys that may lie off their nominal values, and these; none without a tolerance.
    fn tolerated_keys(&self) -> impl Iterator<Item = (&'static Tolerated, f64)> {
        let tolerance = self.tolerance();
        TOLERATED
            .iter()
            .filter_map(move |key| (key.get)(&self.nominal.settings).filter(|&v| v > 0.0).map(|v| (key, v)))
            .filter(move |_| tolerance > 0.0)
    }

    /// A coordinate that may lie as far from its nominal value as the machine file tolerates.
    fn tolerated(&self, coordinate: Coordinate, declared: f64) -> Slot {
        let spread = self.tolerance() * declared.abs();
        let bounded = Coordinate {
            lower: coordinate.lower.max(declared - spread).min(declared),
            upper: coordinate.upper.min(declared + spread).max(declared),
            ..coordinate
        };
        Slot { coordinate: bounded, prior: (spread > 0.0).then_some((declared, spread)) }
    }

    /// Whether a declared effect is only known together with one that was found: a load that was identified
    /// with friction taken as symmetric holds the mean of what friction is more one way than the other.
    fn trades(&self, declared: &Effect) -> bool {
        let is_asymmetry = |found: &Effect| matches!(found, Effect::FrictionAsymmetry(_));
        matches!(declared, Effect::ConstantLoad(_)) && self.found().iter().any(is_asymmetry)
    }

    fn effects_of(&self, scope: &Scope) -> impl Iterator<Item = (usize, &Effect)> {
        self.axis.effect.iter().enumerate().filter(move |(_, effect)| scope.holds(effect))
    }
}
