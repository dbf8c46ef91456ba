//! What a model leaves open: values with their intervals, and rivals.

use model::axis::{KeyNames, TOLERATED, Tolerated};
use model::effects::Effect;
use model::machine::Machine;

/// Half widths of 95 % intervals are this many standard deviations.
pub const HALF_WIDTH: f64 = 1.96;

/// An effect in place of one of the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// Number of the axis.
    pub axis: usize,
    /// Number of the effect in the list of the axis.
    pub effect: usize,
    /// What may be there instead.
    pub rival: Effect,
}

/// A variable of the model.
#[derive(Clone, Copy)]
pub enum Variable {
    /// A coordinate of an effect: numbers of the effect and of the coordinate.
    Effect(usize, usize),
    /// A declared value with a tolerance.
    Declared(&'static Tolerated),
}

/// A variable of an axis.
#[derive(Clone, Copy)]
pub struct Unknown {
    /// Number of the axis.
    pub axis: usize,
    /// Which one.
    pub variable: Variable,
    /// By how much it is moved to see what depends on it, in its own unit.
    pub step: f64,
    /// Standard deviation that is known before, in steps; infinite: nothing is known.
    pub known_steps: f64,
}

/// What is open in a model.
#[derive(Clone)]
pub struct Unknowns {
    /// All variables.
    pub variables: Vec<Unknown>,
    /// All pairs of rivals.
    pub pairs: Vec<Pair>,
    /// Rivals that are no effects of the model, as a sentence each: no motion decides them.
    pub not_by_motion: Vec<String>,
}

impl Unknowns {
    /// What is open on the linear axes of a model.
    #[must_use]
    pub fn of(model: &Machine) -> Self {
        let mut found = Self { variables: Vec::new(), pairs: Vec::new(), not_by_motion: Vec::new() };
        for (index, (name, axis)) in model.axis.iter().enumerate() {
            if axis.settings.names == KeyNames::Rotary {
                continue;
            }
            for (effect, own) in axis.effect.iter().enumerate() {
                let coordinates = own.coordinates().into_iter().enumerate();
                found.variables.extend(coordinates.map(|(at, coordinate)| Unknown {
                    axis: index,
                    variable: Variable::Effect(effect, at),
                    step: coordinate.step,
                    known_steps: f64::INFINITY,
                }));
                let Some(evidence) = axis.evidence.get(effect).filter(|known| known.effect == own.name())
                else {
                    continue;
                };
                let pairs = evidence.alternatives.iter();
                found.pairs.extend(pairs.map(|rival| Pair { axis: index, effect, rival: rival.clone() }));
                let is_effect = |rival: &&String| {
                    evidence.alternatives.iter().any(|alternative| alternative.name() == rival.as_str())
                };
                let others = evidence.rivals.iter().filter(|rival| !is_effect(rival));
                found.not_by_motion.extend(others.map(|rival| {
                    format!(
                        "{name}: no motion is planned that tells {} from {}: the model does not say how large that would be.",
                        own.name().replace('_', " "),
                        rival.replace('_', " ")
                    )
                }));
            }
            let declared = TOLERATED.iter().filter_map(|value| {
                let relative = value.tolerance(&axis.settings);
                let own = (value.get)(&axis.settings).filter(|_| relative > 0.0)?;
                let deviation = relative * own.abs() / HALF_WIDTH;
                (deviation > 0.0).then_some(Unknown {
                    axis: index,
                    variable: Variable::Declared(value),
                    step: deviation,
                    known_steps: 1.0,
                })
            });
            found.variables.extend(declared);
        }
        found
    }
}

impl Unknown {
    /// The model with this variable moved by its step.
    #[must_use]
    pub fn moved(&self, model: &Machine) -> Machine {
        let mut moved = model.clone();
        let axis = &mut moved.axis[self.axis];
        match self.variable {
            Variable::Effect(effect, coordinate) => {
                let own = &axis.effect[effect];
                let mut x: Vec<f64> = own.coordinates().iter().map(|own| own.value).collect();
                x[coordinate] += self.step;
                axis.effect[effect] = own.at(&x);
            }
            Variable::Declared(value) => {
                let own = (value.get)(&axis.settings).unwrap_or(0.0);
                (value.set)(&mut axis.settings, own + self.step);
            }
        }
        moved
    }
}

impl Pair {
    /// The model with the rival in place of its effect.
    #[must_use]
    pub fn exchanged(&self, model: &Machine) -> Machine {
        let mut exchanged = model.clone();
        exchanged.axis[self.axis].effect[self.effect] = self.rival.clone();
        exchanged
    }

    /// The pair with each coordinate of its rival moved by its step.
    #[must_use]
    pub fn moved(&self) -> Vec<Self> {
        let coordinates = self.rival.coordinates();
        let moved = |index: usize| {
            let x: Vec<f64> = coordinates
                .iter()
                .enumerate()
                .map(|(at, own)| own.value + if at == index { own.step } else { 0.0 })
                .collect();
            Self { rival: self.rival.at(&x), ..self.clone() }
        };
        (0..coordinates.len()).map(moved).collect()
    }
}
