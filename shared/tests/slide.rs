//! The plant of tests that need a motion, and nothing else of a machine: a slide with friction, moved by a force.

/// A slide with friction.
#[derive(Clone, Copy)]
pub struct Slide {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Viscous friction, N per m/s.
    pub viscous_n_s_per_m: f64,
    /// Dry friction, N: a force below it does not move the mass from rest.
    pub coulomb_n: f64,
}

impl Slide {
    /// One tick of position (m) and velocity (m/s) under a force: first the velocity changes, then the position.
    pub fn step(&self, position_m: &mut f64, velocity: &mut f64, force_n: f64, tick_s: f64) {
        let per_n = tick_s / self.mass_kg;
        let sliding = *velocity + (force_n - self.viscous_n_s_per_m * *velocity) * per_n;
        let dry = self.coulomb_n * per_n;
        *velocity = sliding - sliding.clamp(-dry, dry);
        *position_m += *velocity * tick_s;
    }
}
