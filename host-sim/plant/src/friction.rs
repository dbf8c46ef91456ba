//! Friction of the guideway: Coulomb, viscous and Stribeck friction, its dependence on position, time and direction, and
//! optionally presliding ([`super::presliding`]).

use super::guide_temperature::GuideTemperature;
use super::presliding::Bristles;
use model::effects::{
    FrictionAsymmetry, FrictionMemory, FrictionRipple, FrictionTemperature, FrictionWarmUp, PreloadVariation,
    Presliding, QuadraticDrag, ShearThinning, Stribeck,
};
use model::friction_curve::Curve;
use model::position_curve::PositionCurve;

/// Velocity scale w of [`smoothed_sign`], m/s.
pub const SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// Direction in which Coulomb friction without presliding acts, −1 to 1: tanh(v/w), w = [`SIGN_WIDTH_M_PER_S`], for a
/// velocity v (m/s). Continuous through zero, so that the sign does not chatter at standstill.
#[must_use]
#[inline]
pub fn smoothed_sign(velocity: f64) -> f64 {
    libm::tanh(velocity / SIGN_WIDTH_M_PER_S)
}

/// What the sliding level depends on besides the velocity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlidingState {
    /// Position of the table, m.
    pub position_m: f64,
    /// Low-pass filtered speed, m/s, not negative; see [`FrictionMemory`].
    pub filtered_speed_m_per_s: f64,
    /// Time on the session clock, s.
    pub time_s: f64,
}

/// The parameters of friction, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Friction {
    /// Coulomb friction: sliding level without the effects below.
    pub coulomb_n: f64,
    /// Viscous friction.
    pub viscous_n_s_per_m: f64,
    /// σ0 of the bristles; zero: no presliding.
    pub bristle_stiffness_n_per_m: f64,
    /// σ1 of the bristles.
    pub bristle_damping_n_s_per_m: f64,
    /// Rise of the level towards standstill.
    pub stribeck: Stribeck,
    /// Drop of the level towards standstill.
    pub shear: ShearThinning,
    /// Dependence on the low-pass filtered speed.
    pub memory: FrictionMemory,
    /// Dependence on the position, over the travel.
    pub preload: PreloadVariation,
    /// Any other dependence on the position, N over m.
    pub map: PositionCurve,
    /// Dependence on the position, periodic with the screw.
    pub ripple: Vec<FrictionRipple>,
    /// Dependence on the time of the session.
    pub warm_up: FrictionWarmUp,
    /// Dependence on the temperature.
    pub temperature: FrictionTemperature,
    /// The temperature of the guide; `None`: the reference of [`Self::temperature`].
    pub guide_temperature: Option<GuideTemperature>,
    /// Difference between the directions of travel.
    pub asymmetry: FrictionAsymmetry,
    /// Force that grows with the square of the velocity.
    pub drag: QuadraticDrag,
    /// A published friction curve in the place of the Coulomb level.
    pub curve: Option<Curve>,
}

impl Friction {
    /// Makes the presliding that of an effect.
    pub fn set_bristles(&mut self, presliding: &Presliding) {
        self.bristle_stiffness_n_per_m = 1e6 * presliding.stiffness_n_per_um;
        self.bristle_damping_n_s_per_m = presliding.damping_n_s_per_m;
    }

    /// The part of the sliding level that depends on the velocity (m/s) alone, N.
    #[must_use]
    #[inline]
    fn level_at_speed_n(&self, velocity: f64) -> f64 {
        let rise_n = self.stribeck.rise_n(velocity) - self.shear.lack_n(velocity);
        match &self.curve {
            None => self.coulomb_n + rise_n,
            Some(curve) => curve.level_n(velocity) + rise_n,
        }
    }

    /// The sliding level at a velocity (m/s), N; not negative where it depends on more than the velocity.
    #[must_use]
    #[inline]
    pub fn level_n(&self, velocity: f64, sliding: SlidingState) -> f64 {
        let level_n = self.level_at_speed_n(velocity);
        if self.depends_on_velocity_only() {
            return level_n;
        }
        let preload_n = if self.preload.varies() { self.preload.rise_n(sliding.position_m) } else { 0.0 };
        let ripple_n: f64 = self.ripple.iter().map(|ripple| ripple.rise_n(sliding.position_m)).sum();
        let memory_n = self.memory.rise_n(velocity, sliding.filtered_speed_m_per_s);
        let warm_up_n = if self.warm_up.changes() { self.warm_up.rise_n(sliding.time_s) } else { 0.0 };
        let map_n = if self.map.is_empty() { 0.0 } else { self.map.value(sliding.position_m) };
        let by_temperature_n =
            self.temperature_c(sliding.time_s).map_or(0.0, |celsius| self.temperature.rise_n(celsius));
        (level_n + preload_n + ripple_n + memory_n + warm_up_n + by_temperature_n + map_n).max(0.0)
    }

    #[must_use]
    #[inline]
    fn depends_on_temperature(&self) -> bool {
        self.guide_temperature.is_some() && self.temperature.changes()
    }

    /// The temperature at a time on the session clock (s), °C, where friction depends on it.
    #[must_use]
    #[inline]
    fn temperature_c(&self, time_s: f64) -> Option<f64> {
        let curve = self.guide_temperature.as_ref().filter(|_| self.temperature.changes())?;
        Some(curve.at(time_s + self.temperature.sensor_late_s))
    }

    #[must_use]
    #[inline]
    fn depends_on_velocity_only(&self) -> bool {
        !self.memory.remembers()
            && !self.preload.varies()
            && !self.warm_up.changes()
            && !self.depends_on_temperature()
            && self.map.is_empty()
            && self.ripple.is_empty()
    }

    /// Friction at a velocity (m/s), N, where it is given by a curve that is continuous through zero.
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

    /// Viscous friction and [`Self::beyond_linear_n`] at a velocity (m/s) and a time on the session clock (s), N, against the motion.
    #[must_use]
    #[inline]
    pub fn viscous_n(&self, velocity: f64, time_s: f64) -> f64 {
        self.viscous_n_s_per_m * velocity + self.beyond_linear_n(velocity, time_s)
    }

    /// What is zero at standstill and is not the same linear function of the velocity (m/s) at all times (on the session clock, s), N, against
    /// motion in + direction.
    #[must_use]
    #[inline]
    pub fn beyond_linear_n(&self, velocity: f64, time_s: f64) -> f64 {
        let by_temperature_n = self.temperature_c(time_s).map_or(0.0, |celsius| {
            self.temperature.viscous_change(celsius) * self.viscous_n_s_per_m * velocity
        });
        self.asymmetry.force_n(velocity) + self.drag.resistance_n(velocity) + by_temperature_n
    }

    /// Whether [`Self::beyond_linear_n`] may be other than zero.
    #[must_use]
    pub fn is_beyond_linear(&self) -> bool {
        self.depends_on_temperature()
            || self.beyond_linear_n(1.0, 0.0) != 0.0
            || self.beyond_linear_n(-1.0, 0.0) != 0.0
    }

    /// Bends the bristles (m) over a step (s) of a known velocity (m/s) and gives the whole friction at its end, N,
    /// against the motion.
    pub fn step(&self, bristle_m: &mut f64, velocity: f64, sliding: SlidingState, step_s: f64) -> f64 {
        if let Some(force_n) = self.through_zero_n(velocity) {
            return force_n + self.viscous_n(velocity, sliding.time_s);
        }
        let level_n = self.level_n(velocity, sliding);
        if !self.has_bristles() {
            return level_n * smoothed_sign(velocity) + self.viscous_n(velocity, sliding.time_s);
        }
        self.bristles().implicit_step(bristle_m, velocity, level_n, step_s)
            + self.viscous_n(velocity, sliding.time_s)
    }

    /// Friction without presliding and without the viscous part over a step, N: at most the sliding level, and no more
    /// than `holding_n`, the force that would stop the table within the step. It can stop the table and hold it, but
    /// not push it. `about` is the velocity (m/s) of the level.
    #[must_use]
    #[inline]
    pub fn dry_n(&self, about: f64, sliding: SlidingState, holding_n: f64) -> f64 {
        self.through_zero_n(about).unwrap_or_else(|| {
            let level_n = self.level_n(about, sliding);
            // A negative level (shear thinning greater than all other friction) or NaN counts as zero.
            let level_n = level_n.max(0.0);
            holding_n.clamp(-level_n, level_n)
        })
    }

    /// The bristles.
    #[must_use]
    #[inline]
    pub fn bristles(&self) -> Bristles<f64> {
        Bristles {
            stiffness_n_per_m: self.bristle_stiffness_n_per_m,
            damping_n_s_per_m: self.bristle_damping_n_s_per_m,
        }
    }

    /// The sliding level where it is constant, N.
    #[must_use]
    pub fn constant_level_n(&self) -> Option<f64> {
        let is_constant = self.depends_on_velocity_only()
            && self.stribeck.static_excess_n == 0.0
            && self.shear.force_n == 0.0;
        (self.curve.is_none() && is_constant).then_some(self.coulomb_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presliding::StepTime;

    /// Shear thinning by more than the whole friction makes the level negative at standstill.
    #[test]
    fn a_negative_sliding_level_gives_no_friction() {
        let mut friction = Friction { coulomb_n: 1.0, ..Friction::default() };
        friction.shear.force_n = 50.0;
        friction.shear.velocity_mm_s = 10.0;
        let still = SlidingState::default();
        assert!(friction.level_n(0.0, still) < 0.0);
        assert_eq!(friction.dry_n(0.0, still, 5.0).abs().to_bits(), 0.0f64.to_bits());
    }

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
            let step = |_| guide().step(&mut bristle, v, SlidingState::default(), 25e-6);
            let force = (0..100_000).map(step).last().unwrap();
            assert!((force - expected).abs() < 0.01, "{v}: {force}");
        }
    }

    /// At 24 °C, 4 °C above the reference: 200 N − 4·2 N, and 1000 N·s/m·exp(−0.04·4); at the reference without a temperature. A reading that is
    /// 2 s late is that of 2 s later.
    #[test]
    fn friction_falls_with_the_temperature_of_the_guide() {
        let temperature = FrictionTemperature {
            level_n_per_c: -2.0,
            viscous_percent_per_c: -4.0,
            sensor_late_s: 2.0,
            ..FrictionTemperature::at_reference(20.0)
        };
        let cold = Friction { temperature, stribeck: Stribeck::default(), ..guide() };
        // 20 °C until 10 s, and 24 °C from 11 s on.
        let celsius = (0..20).map(|i| if i <= 10 { 20.0 } else { 24.0 }).collect();
        let warming =
            Friction { guide_temperature: GuideTemperature::new(0.0, 1.0, celsius), ..cold.clone() };
        let at = |friction: &Friction, time_s: f64| {
            let state = SlidingState { time_s, ..SlidingState::default() };
            [friction.level_n(0.1, state), friction.viscous_n(0.1, time_s)]
        };
        let asymmetry_n = 20.0;
        for (found, expected) in [
            (at(&cold, 15.0), [200.0, 100.0 + asymmetry_n]),
            (at(&warming, 7.9), [200.0, 100.0 + asymmetry_n]),
            (at(&warming, 9.1), [192.0, 100.0 * (-0.16f64).exp() + asymmetry_n]),
        ] {
            assert!(
                (found[0] - expected[0]).abs() < 1e-9 && (found[1] - expected[1]).abs() < 1e-9,
                "{found:?}"
            );
        }
        assert!(warming.is_beyond_linear() && warming.constant_level_n().is_none());
    }

    #[test]
    fn is_a_spring_before_it_slides() {
        // 1 µm at 40 N/µm is 40 N; the bristle relaxes by σ0·x/g ≈ 13 % over that travel.
        let mut bristle = 0.0;
        for _ in 0..1000 {
            guide().step(&mut bristle, 1e-6, SlidingState::default(), 1e-3);
        }
        let force = 4e7 * bristle;
        assert!((34.0..40.0).contains(&force), "{force}");
    }

    /// Acceleration to 0.9 mm/s in 20 steps of 0.1 ms: the mean forces are those of steps a thousand times finer.
    #[test]
    fn the_mean_of_a_step_is_of_second_order() {
        let momentum = |step_s: f64, steps: u32| -> f64 {
            let mut bristle = 0.0;
            let mut momentum = 0.0;
            for i in 0..steps {
                let v = 0.9e-3 * (f64::from(i) + 0.5) / f64::from(steps);
                let level_n = guide().level_n(v, SlidingState::default());
                let relaxation = guide().bristles().relaxation_per_m(level_n) * v * step_s;
                // An infinite mass: the friction does not change the velocity.
                let mean = guide().bristles().mean_over_step(bristle, relaxation, 0.0, StepTime::new(step_s));
                momentum += step_s * mean.force_n(v);
                bristle = mean.bristle_m(v);
            }
            momentum
        };
        let [fine, half, coarse] = [(1e-7, 20_000), (5e-5, 40), (1e-4, 20)].map(|(h, n)| momentum(h, n));
        let (error, smaller) = (coarse - fine, half - fine);
        // (r/2)²/3 with r = 0.02 per step where it slides: 0.1 %, and as much from the rise of the velocity.
        assert!((error / fine).abs() < 2e-3, "{error} of {fine}");
        // Half the step, a quarter of the error; the next order is a fifth of it here.
        assert!((3.2..4.8).contains(&(error / smaller)), "{error} {smaller}");
    }
}
