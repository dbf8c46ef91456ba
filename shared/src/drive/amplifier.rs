//! From a force to the input of a power stage: a direction and a PWM duty.
//!
//! counts = |force|·full counts/full-scale force, rounded. The ratio is scaled by a power of two to 32 … 64, where a
//! fixed-point gain has a relative error of 2⁻³⁰, so that a tick takes one multiplication and a shift.
//!
//! # Example
//!
//! ```
//! use shared::drive::{Amplifier, Duty};
//!
//! let amplifier = Amplifier::<f64>::new(400.0, 8400).unwrap();
//! assert_eq!(amplifier.duty(-100.0), Duty { reverse: true, counts: 2100 });
//! assert_eq!(amplifier.duty(500.0), Duty { reverse: false, counts: 8400 });
//! ```

use crate::scalar::Scalar;

/// Greatest full-scale force, N: with a gain below 64 the product stays in range.
const MAX_N: f64 = 131_000.0;

/// Fraction bits of [`Scalar::to_distance`] plus log₂ of the greatest gain, 64.
const EXPONENT: i32 = 30 + 6;

/// Why the data of a power stage were rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveError {
    /// The force at full duty is not from 1 mN to 131 kN.
    FullScale,
    /// The PWM has no counts.
    NoPwm,
    /// The counts of an analogue output are not in the range of its converter.
    Counts,
    /// A step is not from 0.1 nm to 1 mm, or a tick has none.
    Step,
}

impl core::fmt::Display for DriveError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::FullScale => write!(f, "force at full duty: expected 1e-3 to 131000 N"),
            Self::NoPwm => write!(f, "PWM: expected at least one count"),
            Self::Counts => write!(f, "analogue output: expected a span above 0, and a zero in the range"),
            Self::Step => write!(f, "step: expected 1e-10 to 1e-3 m, and at least one in a tick"),
        }
    }
}

impl core::error::Error for DriveError {}

/// The input of a power stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Duty {
    /// Whether the force is negative.
    pub reverse: bool,
    /// PWM counts that are on, 0 to the full counts of [`Amplifier::new`].
    pub counts: u16,
}

/// A power stage whose force is proportional to its duty.
#[derive(Clone, Copy, Debug)]
pub struct Amplifier<S: Scalar> {
    gain: S::Gain,
    shift: u32,
    max_counts: u16,
    /// Whether a positive duty produces a negative force.
    inverted: bool,
}

impl<S: Scalar> Amplifier<S> {
    /// A power stage that produces `full_scale_n` at `full_counts`, which is never exceeded. The force is negative if a
    /// positive duty produces a negative force.
    ///
    /// # Errors
    /// [`DriveError::FullScale`] unless the magnitude of the force is 1 mN to 131 kN, [`DriveError::NoPwm`] for 0 counts.
    pub fn new(full_scale_n: f64, full_counts: u16) -> Result<Self, DriveError> {
        let magnitude_n = libm::fabs(full_scale_n);
        if !(1e-3..=MAX_N).contains(&magnitude_n) {
            return Err(DriveError::FullScale);
        }
        if full_counts == 0 {
            return Err(DriveError::NoPwm);
        }
        // mantissa·2^exponent, mantissa from ½ to 1.
        let (mantissa, exponent) = libm::frexp(f64::from(full_counts) / magnitude_n);
        Ok(Self {
            gain: S::gain(mantissa * 64.0),
            // The ratio is from 2⁻¹⁷ to 2²⁶: a shift of 10 to 52.
            shift: (EXPONENT - exponent).clamp(1, 62).cast_unsigned(),
            max_counts: full_counts,
            inverted: full_scale_n < 0.0,
        })
    }

    /// The duty for a force; 0 for a NaN.
    #[must_use]
    pub fn duty(&self, force: S) -> Duty {
        // `to_distance` saturates and returns 0 for a NaN.
        let scaled = S::to_distance(force * self.gain);
        let rounded = (scaled.unsigned_abs() >> (self.shift - 1)).wrapping_add(1) >> 1;
        let counts = u16::try_from(rounded).unwrap_or(self.max_counts).min(self.max_counts);
        Duty { reverse: counts > 0 && (scaled < 0) != self.inverted, counts }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    /// Greatest error in counts over 1.5 times the range.
    fn worst<S: Scalar>(full_scale_n: f64, full_counts: u16) -> f64 {
        let amplifier = Amplifier::<S>::new(full_scale_n, full_counts).unwrap();
        let full = f64::from(full_counts);
        (-1500i32..=1500)
            .step_by(if cfg!(miri) { 100 } else { 1 })
            .map(|step| {
                let force = S::signal(f64::from(step) / 1000.0 * full_scale_n);
                let Duty { reverse, counts } = amplifier.duty(force);
                let signed = if reverse { -f64::from(counts) } else { f64::from(counts) };
                (signed - (Scalar::value(force) / full_scale_n * full).clamp(-full, full)).abs()
            })
            .fold(0.0, f64::max)
    }

    proptest! {
        /// Half a count of rounding, and the error of the gain: 2⁻³⁰ of 65,535 counts in fixed point, 2⁻²² of them in f32.
        #[test]
        fn the_duty_is_the_nearest_count(scale in 1e-3..80_000.0f64, counts in 1u16..) {
            prop_assert!(worst::<Fixed>(scale, counts) < 0.501);
            prop_assert!(worst::<f32>(scale, counts) < 0.53);
            prop_assert!(worst::<f64>(scale, counts) < 0.500_001);
        }
    }

    /// Reversed wiring gives the same duty in the other direction, and no direction without a duty.
    #[test]
    fn a_negative_full_scale_reverses_the_direction() {
        let [straight, inverted] = [1000.0, -1000.0].map(|n| Amplifier::<Fixed>::new(n, 8400).unwrap());
        for force in [-1500.0, -3.0, 0.0, 1e-4, 250.0] {
            let [duty, other] = [&straight, &inverted].map(|stage| stage.duty(Fixed::signal(force)));
            assert_eq!(duty.counts, other.counts);
            assert_eq!(other.reverse, duty.counts > 0 && !duty.reverse, "{force}");
        }
    }

    #[test]
    fn a_nan_force_gives_no_duty() {
        assert_eq!(Amplifier::<f32>::new(100.0, 8400).unwrap().duty(f32::NAN), Duty::default());
        assert_eq!(Amplifier::<f64>::new(100.0, 8400).unwrap().duty(f64::NAN), Duty::default());
    }

    #[test]
    fn the_duty_saturates_at_full_scale() {
        let full = |reverse| Duty { reverse, counts: 8400 };
        let fixed = Amplifier::<Fixed>::new(1e-3, 8400).unwrap();
        assert_eq!((fixed.duty(Fixed::MAX), fixed.duty(Fixed::MIN)), (full(false), full(true)));
        let float = Amplifier::<f32>::new(1e-3, 8400).unwrap();
        assert_eq!((float.duty(f32::INFINITY), float.duty(f32::MIN)), (full(false), full(true)));
    }

    #[test]
    fn invalid_power_stages_are_rejected() {
        for force in [0.0, 0.9e-3, -0.9e-3, f64::NAN, f64::INFINITY, 2e5, -2e5] {
            assert_eq!(Amplifier::<Fixed>::new(force, 8400).unwrap_err(), DriveError::FullScale);
        }
        assert_eq!(Amplifier::<Fixed>::new(1.0, 0).unwrap_err(), DriveError::NoPwm);
    }

    /// Less than half a count rounds to 0, half a count to 1, for both signs.
    #[test]
    fn a_duty_of_zero_has_no_direction() {
        fn rounds<S: Scalar>() {
            // A count is 2⁻⁴ N: exact in every format.
            let amplifier = Amplifier::<S>::new(512.0, 8192).unwrap();
            let duty = |counts: f64| amplifier.duty(S::signal(counts / 16.0));
            for below_half in [0.0, 0.499, -0.499, -0.01] {
                assert_eq!(duty(below_half), Duty::default(), "{} {below_half}", S::NAME);
            }
            for (counts, expected) in [(0.5, 1), (0.501, 1), (1.499, 1), (1.501, 2), (8191.0, 8191)] {
                assert_eq!(duty(counts), Duty { reverse: false, counts: expected }, "{}", S::NAME);
                assert_eq!(duty(-counts), Duty { reverse: true, counts: expected }, "{}", S::NAME);
            }
        }
        rounds::<Fixed>();
        rounds::<f32>();
        rounds::<f64>();
    }
}
