//! Friction of the guideway: `LuGre` with Stribeck rise and direction dependence, or plain Coulomb.
//!
//! `LuGre` (Canudas de Wit et al., 1995): bristles of stiffness σ0 bend by z,
//! ż = v − σ0·|v|·z/g(v), friction = σ0·z + σ1·ż + viscous·v, with g the sliding level. The step is
//! implicit in z, so that it holds its level at any speed and step: z′ = (z + v·Δt)/(1 + σ0·|v|·Δt/g) where
//! the velocity is given, [`Bristles::over`] where it follows from the force.

use super::lane::Lane;
use model::effects::{
    FrictionAsymmetry, FrictionMemory, FrictionRipple, PreloadVariation, ShearThinning, Stribeck,
};
use model::friction_curve::Curve;

/// Sharpness of the smoothed sign where there are no bristles, m/s.
const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// Where it slides, and how fast it has been.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slide {
    /// Place of the table.
    pub place_m: f64,
    /// Speed that is remembered; see [`FrictionMemory`].
    pub lately_m_per_s: f64,
}

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
    /// Lack towards standstill.
    pub shear: ShearThinning,
    /// What it takes from the speed of before.
    pub memory: FrictionMemory,
    /// Along the travel.
    pub preload: PreloadVariation,
    /// Over a turn of the screw.
    pub ripple: Vec<FrictionRipple>,
    /// Difference between the directions.
    pub asymmetry: FrictionAsymmetry,
    /// A published curve instead of the sliding level.
    pub curve: Option<Curve>,
}

impl Friction {
    /// The sliding level at a velocity, wherever it depends on nothing else.
    #[must_use]
    #[inline]
    fn level_at_speed_n(&self, velocity: f64) -> f64 {
        let rise_n = self.stribeck.rise_n(velocity) - self.shear.lack_n(velocity);
        match &self.curve {
            None => self.coulomb_n + rise_n,
            Some(curve) => curve.level_n(velocity) + rise_n,
        }
    }

    /// The sliding level at a velocity.
    #[must_use]
    #[inline]
    pub fn level_n(&self, velocity: f64, slide: Slide) -> f64 {
        let level_n = self.level_at_speed_n(velocity);
        if self.is_plain() {
            return level_n;
        }
        let along_n = if self.preload.varies() { self.preload.rise_n(slide.place_m) } else { 0.0 };
        let ripple_n: f64 = self.ripple.iter().map(|ripple| ripple.rise_n(slide.place_m)).sum();
        (level_n + along_n + ripple_n + self.memory.rise_n(velocity, slide.lately_m_per_s)).max(0.0)
    }

    /// Whether the sliding level hangs on the velocity alone.
    #[must_use]
    #[inline]
    fn is_plain(&self) -> bool {
        !self.memory.remembers() && !self.preload.varies() && self.ripple.is_empty()
    }

    /// Friction at a velocity where it has a curve that leads through zero.
    #[must_use]
    #[inline]
    pub fn through_zero_n(&self, velocity: f64) -> Option<f64> {
        match &self.curve {
            Some(Curve::FallingRising(curve)) => Some(curve.force_n(velocity)),
            _ => None,
        }
    }

    /// Whether friction has a presliding state.
    #[must_use]
    #[inline]
    pub fn has_bristles(&self) -> bool {
        self.bristle_stiffness_n_per_m > 0.0
    }

    /// The part of friction that only depends on velocity.
    #[must_use]
    #[inline]
    pub fn viscous_n(&self, velocity: f64) -> f64 {
        self.viscous_n_s_per_m * velocity + self.asymmetry.force_n(velocity)
    }

    /// Bends the bristles (m) for a step and gives the whole friction force against the motion, N.
    pub fn step(&self, bristle: &mut f64, velocity: f64, slide: Slide, step_s: f64) -> f64 {
        if let Some(force_n) = self.through_zero_n(velocity) {
            return force_n + self.viscous_n(velocity);
        }
        if !self.has_bristles() {
            return self.level_n(velocity, slide) * (velocity / SIGN_WIDTH_M_PER_S).tanh()
                + self.viscous_n(velocity);
        }
        let level = self.level_n(velocity, slide).max(1e-9);
        let relaxation = self.bristle_stiffness_n_per_m * velocity.abs() * step_s / level;
        let bent = (*bristle + velocity * step_s) / (1.0 + relaxation);
        let rate = (bent - *bristle) / step_s;
        *bristle = bent;
        self.bristle_stiffness_n_per_m * bent
            + self.bristle_damping_n_s_per_m * rate
            + self.viscous_n(velocity)
    }

    /// Friction without a presliding state over a step, without the viscous part, where `holds_n` would stop the table
    /// within it: it can stop the table and hold it, but not push it.
    #[must_use]
    #[inline]
    pub fn dry_n(&self, about: f64, slide: Slide, holds_n: f64) -> f64 {
        self.through_zero_n(about).unwrap_or_else(|| {
            let level_n = self.level_n(about, slide);
            holds_n.clamp(-level_n, level_n)
        })
    }

    /// Its bristles.
    #[must_use]
    pub fn bristles(&self) -> Bristles<f64> {
        Bristles {
            stiffness_n_per_m: self.bristle_stiffness_n_per_m,
            damping_n_s_per_m: self.bristle_damping_n_s_per_m,
        }
    }

    /// The level where it is the same at every velocity.
    #[must_use]
    pub fn even_level_n(&self) -> Option<f64> {
        let is_even = self.is_plain() && self.stribeck.static_excess_n == 0.0 && self.shear.force_n == 0.0;
        (self.curve.is_none() && is_even).then_some(self.coulomb_n)
    }

    /// By how much bristles at a level relax for each metre that goes by, σ0/g: 1/m.
    #[must_use]
    #[inline]
    pub fn relaxes_per_m(&self, level_n: f64) -> f64 {
        self.bristle_stiffness_n_per_m / level_n.max(1e-9)
    }
}

/// What bends under the table before it slides: σ0 and σ1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristles<L> {
    /// N/m.
    pub stiffness_n_per_m: L,
    /// N·s/m.
    pub damping_n_s_per_m: L,
}

impl<L: Lane> Bristles<L> {
    /// The mean force over a step, without the viscous part, of what moves `mobility` (m/s) slower for each newton of
    /// it; they are expected to relax by `relaxation` ([`Friction::relaxes_per_m`] of the way).
    ///
    /// They do so exponentially; 1/(1 + r + r²/2) is that to the second order, and does not ring where a step
    /// relaxes them many times over. What depends on the velocity itself is left to [`Mean::force_n`]: nothing here
    /// waits for it.
    #[must_use]
    #[inline]
    pub fn over(&self, bristle_m: L, relaxation: L, mobility: L, step: StepTime) -> Mean<L> {
        let (stiffness, damping) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        let (one, half_one) = (L::all(1.0), L::all(0.5));
        let half = one + half_one * relaxation;
        let whole = one + relaxation * half;
        // Over the step the bend is on average half/whole of the old one, and its rise (1 + r)/2whole of the way.
        let rise_n_per_m = damping * (one - whole) * L::all(step.per_second);
        let offset_n = bristle_m * (stiffness * half + rise_n_per_m);
        let slope_n_s_per_m =
            half_one * stiffness * L::all(step.seconds) * (one + relaxation) + damping * half;
        let with_mobility = whole + mobility * slope_n_s_per_m;
        // 1/with_mobility and 1/whole by one division.
        let both = (with_mobility * whole).recip();
        let (share, per_whole) = (both * whole, both * with_mobility);
        Mean {
            offset_n: offset_n * share,
            slope_n_s_per_m: slope_n_s_per_m * share,
            keeps_m: bristle_m * per_whole,
            takes_s: half * L::all(step.seconds) * per_whole,
        }
    }
}

/// Length of a step, and its reciprocal: no division where time is short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// s.
    pub seconds: f64,
    /// 1/s.
    pub per_second: f64,
}

impl StepTime {
    /// Of a step.
    #[must_use]
    pub fn new(seconds: f64) -> Self {
        Self { seconds, per_second: seconds.recip() }
    }
}

/// Mean friction over a step as offset + slope·(velocity without it), and the bristles at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean<L> {
    offset_n: L,
    slope_n_s_per_m: L,
    keeps_m: L,
    takes_s: L,
}

impl<L: Lane> Mean<L> {
    /// Mean force, N, on what would move with the mean velocity `free` (m/s) without it.
    #[must_use]
    #[inline]
    pub fn force_n(&self, free: L) -> L {
        self.offset_n + self.slope_n_s_per_m * free
    }

    /// Bend of the bristles at the end, m, for the mean velocity that came of it.
    #[must_use]
    #[inline]
    pub fn bristle_m(&self, velocity: L) -> L {
        self.keeps_m + self.takes_s * velocity
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
            ..Friction::default()
        }
    }

    #[test]
    fn slides_at_its_level() {
        // 200 + 100·exp(−(v/5)²) + 1000·v ± 200·|v|, by hand for ±2.5 and ±50 mm/s.
        for (v, expected) in [(2.5e-3, 280.880), (-2.5e-3, -279.880), (0.05, 260.0), (-0.05, -240.0)] {
            let mut bristle = 0.0;
            let force =
                (0..100_000).map(|_| guide().step(&mut bristle, v, Slide::default(), 25e-6)).last().unwrap();
            assert!((force - expected).abs() < 0.01, "{v}: {force}");
        }
    }

    #[test]
    fn is_a_spring_before_it_slides() {
        // 1 µm at 40 N/µm is 40 N; the bristle relaxes by σ0·x/g ≈ 13 % on the way.
        let mut bristle = 0.0;
        for _ in 0..1000 {
            guide().step(&mut bristle, 1e-6, Slide::default(), 1e-3);
        }
        let force = 4e7 * bristle;
        assert!((34.0..40.0).contains(&force), "{force}");
    }

    /// Over a bend of 0.9 mm/s in 20 steps of 0.1 ms the mean forces are those of steps a thousand times finer.
    #[test]
    fn the_mean_of_a_step_is_of_second_order() {
        let travel = |step_s: f64, steps: u32| -> f64 {
            let mut bristle = 0.0;
            let mut momentum = 0.0;
            for i in 0..steps {
                let v = 0.9e-3 * (f64::from(i) + 0.5) / f64::from(steps);
                // Of a mass that no force moves.
                let relaxation = guide().relaxes_per_m(guide().level_n(v, Slide::default())) * v * step_s;
                let mean = guide().bristles().over(bristle, relaxation, 0.0, StepTime::new(step_s));
                momentum += step_s * mean.force_n(v);
                bristle = mean.bristle_m(v);
            }
            momentum
        };
        let [fine, half, coarse] = [(1e-7, 20_000), (5e-5, 40), (1e-4, 20)].map(|(h, n)| travel(h, n));
        let (error, smaller) = (coarse - fine, half - fine);
        // (r/2)²/3 with r = 0.02 a step where it slides: 0.1 %, and as much from the rise of the velocity.
        assert!((error / fine).abs() < 2e-3, "{error} of {fine}");
        // Half the step, a quarter of the error; the next order is a fifth of it here.
        assert!((3.2..4.8).contains(&(error / smaller)), "{error} {smaller}");
    }
}
