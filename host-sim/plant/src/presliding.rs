//! Presliding friction: bristles that bend before the guide slides (`LuGre`), and their integration over a step.
//!
//! Canudas de Wit, Olsson, Åström and Lischinsky, "A new model for control of systems with friction", IEEE Trans.
//! Autom. Control 40(3), 1995: with the deflection z of the bristles, their stiffness σ0 and damping σ1,
//!
//! ```text
//! z' = v − σ0·|v|/g(v)·z,    F = σ0·z + σ1·z' (+ viscous·v, which is not part of this module)
//! ```
//!
//! where g(v) is the sliding level, N. The equation is stiff: σ0·|v|/g reaches 10⁵ 1/s. Each caller needs another
//! integration of the same law:
//!
//! - [`Bristles::force_n`]: the law itself, at one instant;
//! - [`Bristles::implicit_step`]: backward Euler, for a given velocity and any step;
//! - [`Bristles::exact_step`]: exact for a constant velocity, affine in the velocity;
//! - [`Bristles::mean_over_step`]: of second order and affine in the velocity, for velocities that depend on the
//!   friction.

use super::lane::Lane;

/// Smallest sliding level used as a divisor, N: the bristles of a guide without friction relax at once.
const MIN_LEVEL_N: f64 = 1e-9;

/// Bristles of the guides of a register.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bristles<L> {
    /// σ0, N/m.
    pub stiffness_n_per_m: L,
    /// σ1, N·s/m.
    pub damping_n_s_per_m: L,
}

impl Bristles<f64> {
    /// Relaxation of the bristles per metre of travel at a sliding level (N), σ0/g: 1/m.
    #[must_use]
    #[inline]
    pub fn relaxation_per_m(&self, level_n: f64) -> f64 {
        self.stiffness_n_per_m / level_n.max(MIN_LEVEL_N)
    }

    /// Friction at an instant, N: σ0·z + σ1·z', for a deflection (m), a velocity (m/s) and a sliding level (N).
    #[must_use]
    #[inline]
    pub fn force_n(&self, bristle_m: f64, velocity: f64, level_n: f64) -> f64 {
        let relaxation_per_s = self.relaxation_per_m(level_n) * velocity.abs();
        self.stiffness_n_per_m * bristle_m
            + self.damping_n_s_per_m * (velocity - relaxation_per_s * bristle_m)
    }

    /// Bends the bristles (m) over a step by backward Euler, z₁ = (z₀ + v·h)/(1 + σ0·|v|·h/g), and gives the friction
    /// at its end, N. Stable and at its sliding level for any velocity (m/s) and step (s).
    #[inline]
    pub fn implicit_step(&self, bristle_m: &mut f64, velocity: f64, level_n: f64, step_s: f64) -> f64 {
        let level_n = level_n.max(MIN_LEVEL_N);
        let relaxation = self.stiffness_n_per_m * velocity.abs() * step_s / level_n;
        let end_m = (*bristle_m + velocity * step_s) / (1.0 + relaxation);
        let rate = (end_m - *bristle_m) / step_s;
        *bristle_m = end_m;
        self.stiffness_n_per_m * end_m + self.damping_n_s_per_m * rate
    }

    /// A step that is exact for a constant velocity: z₁ = z₀·e⁻ʳ + v·h·(1 − e⁻ʳ)/r with r = σ0·|v|·h/g.
    ///
    /// `about` is the velocity (m/s) at which r is computed. A reversal takes few steps, and a first-order rule would
    /// show an error there that looks like a Stribeck effect.
    #[must_use]
    #[inline]
    pub fn exact_step(&self, bristle_m: f64, about: f64, level_n: f64, step: StepTime) -> ExactStep {
        let (stiffness, damping) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        let relaxation = self.relaxation_per_m(level_n) * about.abs() * step.seconds;
        let decay = libm::exp(-relaxation);
        // For r below 1e-6 it is 1 within 5e-7, and the difference would cancel.
        let mean_decay = if relaxation > 1e-6 { (1.0 - decay) / relaxation } else { 1.0 };
        ExactStep {
            offset_n: bristle_m * (stiffness * decay + damping * (decay - 1.0) * step.per_second),
            slope_n_s_per_m: (stiffness * step.seconds + damping) * mean_decay,
            decay,
            mean_decay,
        }
    }
}

/// A step of [`Bristles::exact_step`]: friction as offset + slope·v, with the mean velocity v of the step (m/s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactStep {
    /// Friction at the end of a step without motion, N.
    pub offset_n: f64,
    /// Friction per velocity, N·s/m.
    pub slope_n_s_per_m: f64,
    /// e⁻ʳ.
    decay: f64,
    /// (1 − e⁻ʳ)/r.
    mean_decay: f64,
}

impl ExactStep {
    /// Deflection at the end of the step, m, from that at its beginning (m), the mean velocity (m/s) and the step (s).
    #[must_use]
    #[inline]
    pub fn bristle_m(&self, bristle_m: f64, velocity: f64, step_s: f64) -> f64 {
        bristle_m * self.decay + velocity * step_s * self.mean_decay
    }
}

impl<L: Lane> Bristles<L> {
    /// Mean friction over a step of a body whose mean velocity depends on it.
    ///
    /// `relaxation` is r = σ0·|v|·h/g, from [`Bristles::relaxation_per_m`] times the travel; `mobility` is the change
    /// of the mean velocity per newton of friction, m/s/N. The exponential e⁻ʳ is replaced by 1/(1 + r + r²/2): of
    /// second order for small r, and monotonic to zero where a step relaxes the bristles many times over. What depends
    /// on the velocity itself is left to [`MeanFriction::force_n`], so that this function does not have to wait for it.
    #[must_use]
    #[inline]
    pub fn mean_over_step(
        &self,
        bristle_m: L,
        relaxation: L,
        mobility: L,
        step: StepTime,
    ) -> MeanFriction<L> {
        let (stiffness, damping) = (self.stiffness_n_per_m, self.damping_n_s_per_m);
        let (one, half_one) = (L::all(1.0), L::all(0.5));
        // 1 + r/2, and 1 + r + r²/2 for eʳ.
        let mean_growth = one + half_one * relaxation;
        let growth = one + relaxation * mean_growth;
        // Means over the step: mean_growth/growth of the old deflection, plus (1 + r)/(2·growth) of the travel.
        let rate_n_per_m = damping * (one - growth) * L::all(step.per_second);
        let offset_n = bristle_m * (stiffness * mean_growth + rate_n_per_m);
        let slope_n_s_per_m =
            half_one * stiffness * L::all(step.seconds) * (one + relaxation) + damping * mean_growth;
        let with_mobility = growth + mobility * slope_n_s_per_m;
        // 1/with_mobility and 1/growth by one division.
        let both = (with_mobility * growth).recip();
        let (per_mobility, per_growth) = (both * growth, both * with_mobility);
        MeanFriction {
            offset_n: offset_n * per_mobility,
            slope_n_s_per_m: slope_n_s_per_m * per_mobility,
            end_offset_m: bristle_m * per_growth,
            end_slope_s: mean_growth * L::all(step.seconds) * per_growth,
        }
    }
}

/// Length of a step and its reciprocal: the step itself then needs no division.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// s.
    pub seconds: f64,
    /// 1/s.
    pub per_second: f64,
}

impl StepTime {
    /// A step of a length (s) above 0.
    #[must_use]
    pub fn new(seconds: f64) -> Self {
        Self { seconds, per_second: seconds.recip() }
    }
}

/// Mean friction over a step as offset + slope·(mean velocity without friction), and the deflection at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanFriction<L> {
    offset_n: L,
    slope_n_s_per_m: L,
    end_offset_m: L,
    end_slope_s: L,
}

impl<L: Lane> MeanFriction<L> {
    /// Mean force, N, on a body that would move with the mean velocity `frictionless` (m/s) without it.
    #[must_use]
    #[inline]
    pub fn force_n(&self, frictionless: L) -> L {
        self.offset_n + self.slope_n_s_per_m * frictionless
    }

    /// Deflection of the bristles at the end, m, for the actual mean velocity (m/s).
    #[must_use]
    #[inline]
    pub fn bristle_m(&self, velocity: L) -> L {
        self.end_offset_m + self.end_slope_s * velocity
    }
}
