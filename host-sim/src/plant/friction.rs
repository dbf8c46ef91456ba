//! Friction of the guideway: `LuGre` with Stribeck rise and direction dependence, or plain Coulomb.
//!
//! `LuGre` (Canudas de Wit et al., 1995): bristles of stiffness σ0 bend by z,
//! ż = v − σ0·|v|·z/g(v), friction = σ0·z + σ1·ż + viscous·v, with g the sliding level. The step is
//! implicit in z, so that it holds its level at any speed and step:
//! z′ = (z + v·Δt)/(1 + σ0·|v|·Δt/g).

use crate::effects::{FrictionAsymmetry, Stribeck};

/// Sharpness of the smoothed sign where there are no bristles, m/s.
const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// The parameters of friction, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Friction {
    /// Sliding level at speed.
    pub coulomb_n: f64,
    /// In proportion to velocity.
    pub viscous_n_s_per_m: f64,
    /// σ0; zero: no presliding.
    pub bristle_stiffness_n_per_m: f64,
    /// σ1.
    pub bristle_damping_n_s_per_m: f64,
    /// Rise towards standstill.
    pub stribeck: Stribeck,
    /// Difference between the directions.
    pub asymmetry: FrictionAsymmetry,
}

impl Friction {
    /// The sliding level at a velocity.
    #[must_use]
    pub fn level_n(&self, velocity: f64) -> f64 {
        self.coulomb_n + self.stribeck.rise_n(velocity)
    }

    /// Whether friction has a presliding state.
    #[must_use]
    pub fn has_bristles(&self) -> bool {
        self.bristle_stiffness_n_per_m > 0.0
    }

    /// The part of friction that only depends on velocity.
    #[must_use]
    pub fn viscous_n(&self, velocity: f64) -> f64 {
        self.viscous_n_s_per_m * velocity + self.asymmetry.force_n(velocity)
    }

    /// Bends the bristles (m) for a step and gives the whole friction force against the motion, N.
    pub fn step(&self, bristle: &mut f64, velocity: f64, step_s: f64) -> f64 {
        if !self.has_bristles() {
            return self.level_n(velocity) * (velocity / SIGN_WIDTH_M_PER_S).tanh()
                + self.viscous_n(velocity);
        }
        let level = self.level_n(velocity).max(1e-9);
        let relaxation = self.bristle_stiffness_n_per_m * velocity.abs() * step_s / level;
        let bent = (*bristle + velocity * step_s) / (1.0 + relaxation);
        let rate = (bent - *bristle) / step_s;
        *bristle = bent;
        self.bristle_stiffness_n_per_m * bent
            + self.bristle_damping_n_s_per_m * rate
            + self.viscous_n(velocity)
    }

    /// Velocity after a free step to `velocity`, with Coulomb friction as an impulse that can stop the
    /// mass but not push it: exact stick without bristles.
    #[must_use]
    pub fn stopped(&self, velocity: f64, mass_kg: f64, step_s: f64) -> f64 {
        let most = self.level_n(velocity) * step_s / mass_kg;
        if velocity.abs() <= most { 0.0 } else { velocity - most.copysign(velocity) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guide() -> Friction {
        Friction {
            coulomb_n: 200.0,
            viscous_n_s_per_m: 1000.0,
            bristle_stiffness_n_per_m: 4e7,
            bristle_damping_n_s_per_m: 2000.0,
            stribeck: Stribeck { static_excess_n: 100.0, velocity_mm_s: 5.0 },
            asymmetry: FrictionAsymmetry { half_difference_n_s_per_m: 200.0 },
        }
    }

    #[test]
    fn slides_at_its_level() {
        // 200 + 100·exp(−(v/5)²) + 1000·v ± 200·|v|, by hand for ±2.5 and ±50 mm/s.
        for (v, expected) in [(2.5e-3, 280.880), (-2.5e-3, -279.880), (0.05, 260.0), (-0.05, -240.0)] {
            let mut bristle = 0.0;
            let force = (0..100_000).map(|_| guide().step(&mut bristle, v, 25e-6)).last().unwrap();
            assert!((force - expected).abs() < 0.01, "{v}: {force}");
        }
    }

    #[test]
    fn is_a_spring_before_it_slides() {
        // 1 µm at 40 N/µm is 40 N; the bristle relaxes by σ0·x/g ≈ 13 % on the way.
        let mut bristle = 0.0;
        for _ in 0..1000 {
            guide().step(&mut bristle, 1e-6, 1e-3);
        }
        let force = 4e7 * bristle;
        assert!((34.0..40.0).contains(&force), "{force}");
    }

    #[test]
    fn coulomb_stops_but_does_not_push() {
        let dry = Friction { coulomb_n: 20.0, ..Friction::default() };
        assert!(dry.stopped(1e-5, 100.0, 1e-3).abs() < f64::EPSILON);
        // 20 N on 100 kg over 1 ms: 0.2 mm/s.
        assert!((dry.stopped(-1e-3, 100.0, 1e-3) + 0.8e-3).abs() < 1e-12);
    }
}
