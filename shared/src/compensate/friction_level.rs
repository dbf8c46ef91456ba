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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::names::stribeck_names;

    const NAMES: StribeckNames = stribeck_names!("friction");

    fn friction(coulomb_n: f64, excess_n: f64) -> Result<Friction, ConfigError> {
        let stribeck = Some(Stribeck { excess_n, velocity_m_per_s: 5e-3 });
        Friction::new(coulomb_n, (stribeck, NAMES), 1000.0, 2e12)
    }

    /// g(v) = 80 N + excess·exp(−(v/vₛ)²) with vₛ = 10¹⁰ position units per tick, for friction that falls and that rises with the speed.
    #[test]
    fn the_level_is_that_of_its_equation() {
        for (excess_n, least_n, greatest_n) in [(40.0, 80.0, 120.0), (-30.0, 50.0, 80.0)] {
            let friction = friction(80.0, excess_n).unwrap();
            assert_eq!((friction.greatest_n(), friction.width()), (greatest_n, Some(1e10)));
            assert!((friction.greatest_over_least() - greatest_n / least_n).abs() < 1e-12);
            for over_width in [0.0f64, 0.5, 1.0, 3.0] {
                let exact_n = 80.0 + excess_n * (-over_width * over_width).exp();
                let speed = 1e10 * over_width;
                assert!((friction.over_greatest(speed) - exact_n / greatest_n).abs() < 1e-12);
                assert!((friction.least_over_level(speed) - least_n / exact_n).abs() < 1e-12);
            }
            // Bristles of 50 N/µm, whose greatest distance is 8 mm of the least level.
            let error = friction.presliding(1.0).unwrap_err();
            let name = "force.friction.presliding_stiffness_n_per_m";
            assert_eq!(error, ConfigError::OutOfRange { name, min: least_n / 8e-3, max: least_n / 8e-9 });
        }
    }

    /// Without friction at standstill there is no ratio, and at most 10⁴ otherwise; without an excess the level is constant.
    #[test]
    fn levels_of_zero_have_no_ratio() {
        let over_least = |coulomb, excess| friction(coulomb, excess).unwrap().greatest_over_least();
        assert_eq!((over_least(80.0, -80.0), over_least(0.0, 0.0), over_least(1e-3, 100.0)), (1.0, 1.0, 1e4));
        let none = friction(0.0, 0.0).unwrap();
        assert_eq!((none.over_greatest(0.0), none.width()), (0.0, None));
        let constant = Friction::new(80.0, (None, NAMES), 1000.0, 2e12).unwrap();
        assert_eq!((constant.over_greatest(1e9), constant.width()), (1.0, None));
    }

    #[test]
    fn excess_and_velocity_have_their_ranges() {
        assert!(friction(80.0, 1000.0).is_ok());
        let error = ConfigError::OutOfRange { name: "friction.excess_n", min: -80.0, max: 1000.0 };
        for excess_n in [-80.1, 1000.1] {
            assert_eq!(friction(80.0, excess_n).err(), Some(error));
        }
    }
}
