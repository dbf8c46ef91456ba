//! The terms of friction in addition to Coulomb and viscous friction.

use model::friction_law::{exponential_decay, gaussian_decay};

use super::map::{FrictionMap, Unit, distinct_speeds};

/// A term of a friction law: a size times a function of velocity v and, for nonlinear terms, of one shape parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Term {
    /// Constant load F against motion in + direction: friction is Coulomb + F in + direction and Coulomb − F in − direction.
    /// At constant speed, it cannot be distinguished from Coulomb friction that differs by 2F between the directions.
    ConstantLoad,
    /// h·|v|: viscous friction b + h in + direction, b − h in − direction.
    FrictionAsymmetry,
    /// sgn(v)·exp(−(v/vs)²), added to Coulomb friction.
    Stribeck,
    /// sgn(v)·exp(−|v|/vs) (Tustin), added to Coulomb friction.
    StribeckExponential,
    /// exp(−|v|/vs): increases friction towards standstill in + direction, decreases it in − direction.
    StribeckAsymmetry,
    /// v·|v|.
    Quadratic,
    /// sgn(v)·(|v|/top speed)^p with a fitted exponent p: below 1 for lubricant films, above 1 for churning losses.
    Power,
    /// tanh(v/vs).
    Saturating,
    /// sgn(v)·ln(1 + |v|/vs).
    Logarithmic,
}

/// All terms, those with fewer parameters first.
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

/// Search range of a shape parameter: a speed vs in [`Unit::speed`], or an exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeRange {
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
}

impl Term {
    /// Name in results. Both forms of Stribeck friction have the same name.
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

    /// Printed description.
    #[must_use]
    pub const fn description(self) -> &'static str {
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

    /// Whether the term differs by direction. Its size then may have either sign, and runs in both directions are needed. The
    /// size of the other terms is not negative.
    #[must_use]
    pub const fn is_directional(self) -> bool {
        matches!(self, Self::ConstantLoad | Self::FrictionAsymmetry | Self::StribeckAsymmetry)
    }

    /// Number of parameters that the term adds to a fit: 1 or 2.
    #[must_use]
    pub const fn parameter_count(self) -> usize {
        if self.is_linear() { 1 } else { 2 }
    }

    /// Whether the term has no shape parameter.
    const fn is_linear(self) -> bool {
        matches!(self, Self::ConstantLoad | Self::FrictionAsymmetry | Self::Quadratic)
    }

    /// Search range of the shape on a map; `None` if the term has no shape. A characteristic speed is searched from the
    /// second-lowest speed (at most a quarter of the top speed) to half the top speed.
    #[must_use]
    pub fn shape_range(self, map: &FrictionMap) -> Option<ShapeRange> {
        if self.is_linear() {
            return None;
        }
        if self == Self::Power {
            return Some(ShapeRange { min: 0.1, max: 4.0 });
        }
        let speeds = distinct_speeds(&map.runs);
        let top = speeds.last().copied().unwrap_or(1.0);
        let min = speeds.get(1).copied().unwrap_or(top).min(0.25 * top);
        Some(ShapeRange { min, max: 0.5 * top })
    }

    /// Force at a velocity for a size of 1.
    #[must_use]
    pub fn basis(self, velocity: f64, shape: f64, top_speed: f64) -> f64 {
        let speed = velocity.abs();
        let sign = velocity.signum();
        match self {
            Self::ConstantLoad => 1.0,
            Self::FrictionAsymmetry => speed,
            Self::Stribeck => sign * gaussian_decay(speed / shape),
            Self::StribeckExponential => sign * exponential_decay(speed / shape),
            Self::StribeckAsymmetry => exponential_decay(speed / shape),
            Self::Quadratic => velocity * speed,
            Self::Power => sign * libm::pow(speed / top_speed, shape),
            Self::Saturating => libm::tanh(velocity / shape),
            Self::Logarithmic => sign * libm::log1p(speed / shape),
        }
    }

    /// JSON key of the size, and the conversion factor from the map's units to the unit of the key.
    #[must_use]
    pub fn size_key(self, unit: Unit) -> (String, f64) {
        let force = unit.force_key();
        match self {
            Self::ConstantLoad if unit == Unit::Rotary => ("torque_mnm".to_owned(), 1.0),
            Self::ConstantLoad => ("force_n".to_owned(), 1.0),
            Self::FrictionAsymmetry => viscous_key("half_difference", unit),
            Self::Stribeck | Self::StribeckExponential => (format!("static_excess_{force}"), 1.0),
            Self::StribeckAsymmetry => (format!("half_difference_{force}"), 1.0),
            Self::Quadratic if unit == Unit::Rotary => ("mnm_per_rpm2".to_owned(), 1.0),
            Self::Quadratic => ("n_s2_per_m2".to_owned(), 1e6),
            Self::Power => (format!("at_top_speed_{force}"), 1.0),
            Self::Saturating | Self::Logarithmic => (format!("rise_{force}"), 1.0),
        }
    }

    /// JSON key of the shape; `None` if the term has none.
    #[must_use]
    pub fn shape_key(self, unit: Unit) -> Option<String> {
        match self {
            Self::Power => Some("exponent".to_owned()),
            _ if self.is_linear() => None,
            _ => Some(format!("velocity_{}", unit.speed_key())),
        }
    }
}

/// JSON key of a viscous coefficient, and the conversion factor from the map's force per speed; linear ones are per m/s.
#[must_use]
pub fn viscous_key(name: &str, unit: Unit) -> (String, f64) {
    match unit {
        Unit::Rotary => (format!("{name}_mnm_per_rpm"), 1.0),
        Unit::Linear => (format!("{name}_n_s_per_m"), 1e3),
    }
}
