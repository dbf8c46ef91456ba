//! Friction against speed: Coulomb and viscous friction, and what may come on top.

use super::{FrictionMap, Unit};

/// What friction may do beside Coulomb and viscous friction. The force of a term is its size times a
/// function of the velocity and, for some, of one shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Opposes motion in + direction whichever way it goes. At constant speed a Coulomb friction that differs
    /// by direction is the same thing.
    ConstantLoad,
    /// Viscous friction b + h one way, b − h the other.
    FrictionAsymmetry,
    /// Friction above Coulomb that falls as exp(−(v/vs)²).
    Stribeck,
    /// The same, falling as exp(−|v|/vs) (Tustin).
    StribeckExponential,
    /// Friction above Coulomb, exp(−|v|/vs), higher by the size one way and lower by it the other.
    StribeckAsymmetry,
    /// Grows with the square of speed.
    Quadratic,
    /// Grows with a power of speed that is fitted: below 1 as lubricant films do, above 1 as churning does.
    Power,
    /// Rises as tanh(|v|/vs) and saturates.
    Saturating,
    /// Rises as ln(1 + |v|/vs).
    Logarithmic,
}

/// All of them, the simplest first.
pub const TERMS: [Term; 9] = [
    Term::ConstantLoad,
    Term::FrictionAsymmetry,
    Term::Quadratic,
    Term::Stribeck,
    Term::StribeckExponential,
    Term::StribeckAsymmetry,
    Term::Saturating,
    Term::Logarithmic,
    Term::Power,
];

/// The number that shapes a term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Least value that the map can tell.
    pub lower: f64,
    /// Greatest.
    pub upper: f64,
}

impl Term {
    /// The name in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ConstantLoad => "constant_load",
            Self::FrictionAsymmetry => "friction_asymmetry",
            Self::Stribeck | Self::StribeckExponential => "stribeck",
            Self::StribeckAsymmetry => "stribeck_asymmetry",
            Self::Quadratic => "quadratic_friction",
            Self::Power => "power_law_friction",
            Self::Saturating => "saturating_friction",
            Self::Logarithmic => "logarithmic_friction",
        }
    }

    /// What it says of the friction, in a few words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::ConstantLoad => "a constant load, or Coulomb friction that differs by direction",
            Self::FrictionAsymmetry => "viscous friction that differs by direction",
            Self::Stribeck => "Stribeck friction, exp(−(v/vs)²)",
            Self::StribeckExponential => "Stribeck friction, exp(−|v|/vs)",
            Self::StribeckAsymmetry => "Stribeck friction that differs by direction",
            Self::Quadratic => "friction with the square of speed",
            Self::Power => "friction with a power of speed",
            Self::Saturating => "friction that saturates, tanh(v/vs)",
            Self::Logarithmic => "friction with the logarithm of speed",
        }
    }

    /// Whether it differs by direction: such a term takes either sign, and shows where there are runs both
    /// ways. Of the others only more friction is friction.
    #[must_use]
    pub const fn is_one_way(self) -> bool {
        matches!(self, Self::ConstantLoad | Self::FrictionAsymmetry | Self::StribeckAsymmetry)
    }

    /// Numbers that it adds to a fit.
    #[must_use]
    pub const fn width(self) -> usize {
        if self.is_straight() { 1 } else { 2 }
    }

    const fn is_straight(self) -> bool {
        matches!(self, Self::ConstantLoad | Self::FrictionAsymmetry | Self::Quadratic)
    }

    /// The range of its shape on a map, `None` where it has none: a speed that at least two different speeds
    /// lie below and that the fastest run is well beyond, or an exponent.
    #[must_use]
    pub fn shape(self, map: &FrictionMap) -> Option<Shape> {
        if self.is_straight() {
            return None;
        }
        if self == Self::Power {
            return Some(Shape { lower: 0.1, upper: 4.0 });
        }
        let mut speeds: Vec<f64> = map.runs.iter().map(|run| run.velocity.abs()).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|next, last| *next < 1.01 * *last);
        let top = speeds.last().copied().unwrap_or(1.0);
        let lower = speeds.get(1).copied().unwrap_or(top).min(0.25 * top);
        Some(Shape { lower, upper: 0.5 * top })
    }

    /// Force at a velocity for a size of 1; `top` is the fastest speed of the map.
    #[must_use]
    pub fn basis(self, velocity: f64, shape: f64, top: f64) -> f64 {
        let speed = velocity.abs();
        let sign = velocity.signum();
        match self {
            Self::ConstantLoad => 1.0,
            Self::FrictionAsymmetry => speed,
            Self::Stribeck => sign * (-(speed / shape).powi(2)).exp(),
            Self::StribeckExponential => sign * (-speed / shape).exp(),
            Self::StribeckAsymmetry => (-speed / shape).exp(),
            Self::Quadratic => velocity * speed,
            Self::Power => sign * (speed / top).powf(shape),
            Self::Saturating => (velocity / shape).tanh(),
            Self::Logarithmic => sign * (speed / shape).ln_1p(),
        }
    }

    /// Key and factor of the size, then key of the shape.
    #[must_use]
    pub fn keys(self, unit: Unit) -> ((String, f64), Option<String>) {
        let (force, speed) = (unit.force_key(), unit.speed_key());
        let size = match self {
            Self::ConstantLoad if unit == Unit::Rotary => ("torque_mnm".to_owned(), 1.0),
            Self::ConstantLoad => ("force_n".to_owned(), 1.0),
            Self::FrictionAsymmetry => viscous_key("half_difference", unit),
            Self::Stribeck | Self::StribeckExponential => (format!("static_excess_{force}"), 1.0),
            Self::StribeckAsymmetry => (format!("half_difference_{force}"), 1.0),
            Self::Quadratic if unit == Unit::Rotary => ("mnm_per_rpm2".to_owned(), 1.0),
            Self::Quadratic => ("n_s2_per_m2".to_owned(), 1e6),
            Self::Power => (format!("at_top_speed_{force}"), 1.0),
            Self::Saturating | Self::Logarithmic => (format!("rise_{force}"), 1.0),
        };
        let shape = match self {
            Self::Power => Some("exponent".to_owned()),
            _ if self.is_straight() => None,
            _ => Some(format!("velocity_{speed}")),
        };
        (size, shape)
    }
}

/// Key of a viscous coefficient and its factor from force per speed of the map: linear ones are per m/s.
#[must_use]
pub fn viscous_key(what: &str, unit: Unit) -> (String, f64) {
    match unit {
        Unit::Rotary => (format!("{what}_mnm_per_rpm"), 1.0),
        Unit::Linear => (format!("{what}_n_s_per_m"), 1e3),
    }
}
