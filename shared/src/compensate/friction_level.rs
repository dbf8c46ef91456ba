//! A friction level over the speed, g(v) = coulomb + excess·exp(−(v/vₛ)²).

use super::force_settings::Stribeck;
use super::names::StribeckNames;
use super::presliding::Presliding;
use crate::config::ConfigError;
use crate::config::check::{positive, ranged};

/// A friction level in SI: coulomb + excess·exp(−(v/vₛ)²).
#[derive(Clone, Copy)]
pub(super) struct Friction {
    coulomb_n: f64,
    excess_n: f64,
    /// vₛ in position units per position tick.
    width: f64,
}

impl Friction {
    /// Checks settings; `units_per_m_s` are position units per position tick.
    pub fn new(
        coulomb_n: f64,
        (stribeck, names): (Option<Stribeck>, StribeckNames),
        bound_n: f64,
        units_per_m_s: f64,
    ) -> Result<Self, ConfigError> {
        let Some(Stribeck { excess_n, velocity_m_per_s }) = stribeck else {
            return Ok(Self { coulomb_n, excess_n: 0.0, width: 1.0 });
        };
        let velocity = positive(names.velocity, velocity_m_per_s)?;
        let velocity = ranged(names.velocity, velocity, 1e-6, 10.0)?;
        // Friction is positive at standstill.
        let excess_n = ranged(names.excess, excess_n, -coulomb_n, bound_n)?;
        Ok(Self { coulomb_n, excess_n, width: velocity * units_per_m_s })
    }

    /// The greatest g, N.
    pub fn greatest_n(&self) -> f64 {
        self.coulomb_n + self.excess_n.max(0.0)
    }

    fn least_n(&self) -> f64 {
        self.coulomb_n + self.excess_n.min(0.0)
    }

    /// The greatest g over the least, at most 10⁴.
    pub fn greatest_over_least(&self) -> f64 {
        if self.least_n() > 0.0 { (self.greatest_n() / self.least_n()).min(1e4) } else { 1.0 }
    }

    /// vₛ in position units per position tick; `None`: g is constant.
    pub fn width(&self) -> Option<f64> {
        (self.excess_n != 0.0).then_some(self.width)
    }

    fn at_n(&self, speed: f64) -> f64 {
        self.coulomb_n + self.excess_n * libm::exp(-(speed / self.width) * (speed / self.width))
    }

    /// g over the greatest g at a speed in position units per position tick.
    pub fn over_greatest(&self, speed: f64) -> f64 {
        if self.greatest_n() > 0.0 { self.at_n(speed) / self.greatest_n() } else { 0.0 }
    }

    /// The least g over g at a speed.
    pub fn least_over_level(&self, speed: f64) -> f64 {
        self.least_n() / self.at_n(speed)
    }

    /// The bristles with this level.
    pub fn presliding(&self, stiffness_n_per_m: f64) -> Result<Presliding, ConfigError> {
        Presliding::new(stiffness_n_per_m, positive("force.friction.coulomb_n", self.least_n())?)
    }
}
