//! Friction at reversal: a force pulse against the static friction that causes quadrant glitches.
//!
//! F = sign(v)·F₀·e^(−t/τ)·max(0, 1 − |v|/v₀), with t from the commanded reversal. A pulse whose height and decay are set for
//! the machine is what machine-tool controls offer as quadrant-glitch compensation or backlash acceleration. The
//! velocity factor makes it shorter at high feeds, as acceleration-dependent pulses are (Erkorkmaz and Altintas, *High speed
//! CNC system design, part II*, 2001).

use super::motion::CommandMotion;
use super::settings;
use crate::config::ConfigError;
use crate::config::check::{gain, positive, ranged};
use crate::scalar::Scalar;
use crate::units::INCREMENT_M;

/// Constants of the pulse.
#[derive(Clone, Copy, Debug)]
pub struct Reversal<S: Scalar> {
    force: S,
    /// Fraction that decays per position tick.
    decay: S::Gain,
    /// 1/v₀, per increment unit.
    fade: S::Gain,
    /// The signal 1.
    one: S,
    /// v₀, increment units: there is no force above this speed.
    zero_above: S,
}

impl<S: Scalar> Reversal<S> {
    /// From settings, for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// [`ConfigError`] with `reversal_force_n`, `reversal_decay_s` or `reversal_fade_m_per_s`.
    pub fn new(settings: &settings::Reversal, rate_hz: f64, bound_n: f64) -> Result<Self, ConfigError> {
        let decay = positive("reversal.decay_s", settings.decay_s)?;
        let fade = positive("reversal.fade_m_per_s", settings.fade_m_per_s)?;
        Ok(Self {
            force: S::signal(ranged("reversal.force_n", settings.force_n, -bound_n, bound_n)?),
            decay: gain::<S>("reversal.decay_s", -libm::expm1(-1.0 / (decay * rate_hz)), 1.0)?,
            fade: gain::<S>("reversal.fade_m_per_s", rate_hz / fade, INCREMENT_M)?,
            one: S::signal(1.0),
            zero_above: S::signal(fade / rate_hz / INCREMENT_M),
        })
    }

    /// The force to add in a position tick; `pulse` is sign(v)·F₀·e^(−t/τ).
    pub fn force(&self, pulse: &mut S, own: &CommandMotion<S>) -> S {
        if own.reversed {
            *pulse = if own.forward { self.force } else { -self.force };
        } else {
            *pulse = *pulse - S::round(*pulse * self.decay);
        }
        if own.increment.exceeds(self.zero_above) {
            return S::ZERO;
        }
        let speed = if own.increment < S::ZERO { -own.increment } else { own.increment };
        // Not above 1 but for rounding.
        let speed_ratio = S::round(speed * self.fade);
        pulse.product(self.one - speed_ratio)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;
    use crate::units::Position;

    /// At 1 kHz the command advances by 10 µm per tick, 10 mm/s, and reverses: the pulse starts in the tick of the
    /// reversal, decays with 5 ms, and has half its height because v₀ = 20 mm/s.
    fn worst<S: Scalar>() -> f64 {
        let settings = settings::Reversal { force_n: 100.0, decay_s: 5e-3, fade_m_per_s: 0.02 };
        let reversal = Reversal::<S>::new(&settings, 1000.0, 200.0).unwrap();
        let mut motion = CommandMotion::at(Position(0));
        let (mut pulse, mut worst) = (S::default(), 0.0f64);
        for k in 1..60 {
            let at = if k <= 20 { f64::from(k) } else { 40.0 - f64::from(k) };
            motion.step(Position::from_m(at * 1e-5).unwrap());
            let force = reversal.force(&mut pulse, &motion).value();
            let expected = if k <= 20 { 0.0 } else { -50.0 * (-f64::from(k - 21) / 5.0).exp() };
            worst = worst.max((force - expected).abs());
        }
        worst
    }

    /// From 0.02 m/s on there is no pulse, at half of it half of the pulse, and at rest all of it. The force is at most the bound.
    #[test]
    fn a_fast_reversal_has_no_pulse() {
        let settings = settings::Reversal { force_n: 100.0, decay_s: 5e-3, fade_m_per_s: 0.02 };
        let reversal = Reversal::<f64>::new(&settings, 1000.0, 100.0).unwrap();
        for (m_per_s, expected) in [(0.03, 0.0), (0.0201, 0.0), (0.019, 5.0), (0.01, 50.0), (0.001, 95.0)] {
            let mut motion = CommandMotion::at(Position(0));
            motion.step(Position::from_m(-m_per_s / 1000.0).unwrap());
            let force = reversal.force(&mut 0.0, &motion);
            assert!((force + expected).abs() < 1e-9, "{m_per_s}: {force}");
        }
        for force_n in [100.1, -100.1] {
            let error =
                Reversal::<f64>::new(&settings::Reversal { force_n, ..settings }, 1000.0, 100.0).err();
            let name = "reversal.force_n";
            assert_eq!(error, Some(ConfigError::OutOfRange { name, min: -100.0, max: 100.0 }));
        }
    }

    #[test]
    fn the_pulse_matches_its_equation() {
        // Rounding per tick is 2⁻¹⁵, that of the decay 2⁻²⁵.
        assert!(worst::<Fixed>() < 1e-3, "{}", worst::<Fixed>());
        assert!(worst::<f32>() < 1e-4, "{}", worst::<f32>());
        assert!(worst::<f64>() < 1e-9, "{}", worst::<f64>());
    }
}
