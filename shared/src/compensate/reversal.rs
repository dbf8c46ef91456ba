//! Friction at reversal: a force pulse against the presliding stick that makes quadrant glitches.
//!
//! F = sign(v)·F₀·e^(−t/τ)·max(0, 1 − |v|/v₀), t from the commanded reversal: shaped in time, for the stick is
//! overcome once, and in velocity, for what slides needs no help. A pulse in time whose size and decay are set for
//! the machine is what controls of machine tools offer as quadrant or backlash acceleration; the
//! velocity factor keeps it short at high feeds, as acceleration-dependent pulses are (Erkorkmaz and Altintas,
//! *High speed CNC system design, part II*, 2001).

use super::motion::Motion;
use super::settings;
use crate::config::ConfigError;
use crate::config::check::{gain, positive, ranged};
use crate::scalar::Scalar;
use crate::units::INCREMENT_M;

/// The pulse.
#[derive(Clone, Copy, Debug)]
pub struct Reversal<S: Scalar> {
    force: S,
    /// Share that decays in a position tick.
    decays: S::Gain,
    /// Of one, per increment unit.
    fades: S::Gain,
}

impl<S: Scalar> Reversal<S> {
    /// From settings, for a command every 1/`rate_hz`.
    ///
    /// # Errors
    /// Names `reversal_force_n`, `reversal_decay_s` or `reversal_fade_m_per_s`.
    pub fn new(settings: &settings::Reversal, rate_hz: f64, bound_n: f64) -> Result<Self, ConfigError> {
        let decay = positive("reversal_decay_s", settings.decay_s)?;
        let fade = positive("reversal_fade_m_per_s", settings.fade_m_per_s)?;
        Ok(Self {
            force: S::signal(ranged("reversal_force_n", settings.force_n, -bound_n, bound_n)?),
            decays: gain::<S>("reversal_decay_s", -libm::expm1(-1.0 / (decay * rate_hz)), 1.0)?,
            fades: gain::<S>("reversal_fade_m_per_s", rate_hz / fade, INCREMENT_M)?,
        })
    }

    /// One position tick: what is left of the pulse, and the force to add.
    pub fn force(&self, pulse: &mut S, own: &Motion<S>) -> S {
        if own.reversed {
            *pulse = if own.forward { self.force } else { -self.force };
        } else {
            *pulse = *pulse - S::round(*pulse * self.decays);
        }
        let one = S::signal(1.0);
        let faded = S::round(own.increment * self.fades).clamp_magnitude(one);
        let left = if faded < S::default() { one + faded } else { one - faded };
        S::round(*pulse * left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Fixed;
    use crate::units::Position;

    /// At 1 kHz a command goes up by 10 µm a tick, 10 mm/s, and back: the pulse begins with the tick that turns,
    /// decays in 5 ms, and is half as high for v₀ = 20 mm/s.
    fn worst<S: Scalar>() -> f64 {
        let settings = settings::Reversal { force_n: 100.0, decay_s: 5e-3, fade_m_per_s: 0.02 };
        let reversal = Reversal::<S>::new(&settings, 1000.0, 200.0).unwrap();
        let mut motion = Motion::at(Position(0));
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

    #[test]
    fn is_the_pulse_of_its_equation() {
        // Each tick rounds to 2⁻¹⁵, the decay to 2⁻²⁵.
        assert!(worst::<Fixed>() < 1e-3, "{}", worst::<Fixed>());
        assert!(worst::<f32>() < 1e-4, "{}", worst::<f32>());
        assert!(worst::<f64>() < 1e-9, "{}", worst::<f64>());
    }
}
