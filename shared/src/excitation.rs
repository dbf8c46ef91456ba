//! A periodic force of a few tones, by which the frequency response of an axis is measured.
//!
//! The force of tick n is A·Σ sin(2π·(h·n/P + φ)) with the period P in ticks and the whole harmonics h: each tone has a whole number of
//! periods in P ticks, so that a discrete Fourier transform over one period separates the tones without a window. n counts from the start
//! of the board: whoever knows the ticks of a recording knows the phases of the force in it.
//!
//! P is a power of two up to [`LONGEST_PERIOD_TICKS`], and every angle one of the tabulated ones of [`sine_q14`]: a tick takes one look into
//! the table for each tone, and its angles are exact. The phases of the tones are those of Schroeder, φ = −k·(k − 1)/(2K) turns for tone k of
//! K, rounded to an angle of the table. They keep the peak of a sum of neighbouring harmonics low (M. R. Schroeder, *Synthesis of low-peak-factor
//! signals and binary sequences with low autocorrelation*, IEEE Transactions on Information Theory 16, 1970, equation 11). Nothing relies on
//! that: what is limited is the sum of the amplitudes, which no tick exceeds with any phases.
//!
//! # Example
//!
//! ```
//! use shared::excitation::{Excitation, ExcitationSettings};
//!
//! let harmonics = heapless::Vec::from_slice(&[1, 3]).unwrap();
//! let settings = ExcitationSettings { axis: 0, force_n: 50.0, period_ticks: 4096, harmonics };
//! let excitation = Excitation::<f64>::new(&settings).unwrap();
//! assert!((0..4096).all(|tick| excitation.force(tick).abs() <= 50.0));
//! assert_eq!(excitation.force(7), excitation.force(7 + 4096));
//! ```

use serde::{Deserialize, Serialize};

use crate::interpolate::sincos::{SINE_STEPS, sine_q14};
use crate::scalar::{Fixed, Scalar};

/// Greatest number of tones at once.
pub const TONES: usize = 8;

/// Least period, ticks.
pub const SHORTEST_PERIOD_TICKS: u16 = 256;

/// Greatest period, ticks: the angles of the table of the sine.
pub const LONGEST_PERIOD_TICKS: u16 = SINE_STEPS;

/// A force of a few tones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExcitationSettings {
    /// Axis, counted from 0.
    pub axis: u8,
    /// Sum of the amplitudes of the tones, N, above 0; they are equal.
    pub force_n: f64,
    /// Period, ticks: a power of two from [`SHORTEST_PERIOD_TICKS`] to [`LONGEST_PERIOD_TICKS`].
    pub period_ticks: u16,
    /// Periods of each tone in a period: ascending, from 1 to below half of `period_ticks`.
    pub harmonics: heapless::Vec<u16, TONES>,
}

/// Why a force was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ExcitationProblem {
    /// The force is not above 0, or greater than the force limit of the axis.
    Force,
    /// The period is no power of two in its range.
    Period,
    /// There is no tone, or the harmonics do not ascend from 1 to below half of the period.
    Tones,
    /// A drive with step and direction inputs has no force.
    StepDrive,
}

/// A tone in angles of the table of the sine.
#[derive(Clone, Copy, Debug)]
struct Tone {
    /// Angle per tick.
    step: u16,
    /// Angle at tick 0.
    phase: u16,
}

/// A periodic force on an axis.
#[derive(Clone, Copy, Debug)]
pub struct Excitation<S> {
    axis: u8,
    count: u8,
    /// Amplitude of a tone.
    amplitude: S,
    tones: [Tone; TONES],
}

impl<S: Scalar> Excitation<S> {
    /// The force for its settings. The force limit of the axis is checked by the caller.
    ///
    /// # Errors
    /// [`ExcitationProblem`].
    pub fn new(settings: &ExcitationSettings) -> Result<Self, ExcitationProblem> {
        let ExcitationSettings { axis, force_n, period_ticks, ref harmonics } = *settings;
        if !(force_n > 0.0 && force_n <= S::SIGNAL_LIMIT) {
            return Err(ExcitationProblem::Force);
        }
        let is_in_range = (SHORTEST_PERIOD_TICKS..=LONGEST_PERIOD_TICKS).contains(&period_ticks);
        if !(is_in_range && period_ticks.is_power_of_two()) {
            return Err(ExcitationProblem::Period);
        }
        let ascend = harmonics.is_sorted_by(|one, next| one < next);
        let (Some(&first), Some(&last)) = (harmonics.first(), harmonics.last()) else {
            return Err(ExcitationProblem::Tones);
        };
        if !ascend || first == 0 || last >= period_ticks / 2 {
            return Err(ExcitationProblem::Tones);
        }
        // At most 8.
        let count = u8::try_from(harmonics.len()).unwrap_or(u8::MAX);
        let mut tones = [Tone { step: 0, phase: 0 }; TONES];
        for ((tone, harmonic), number) in tones.iter_mut().zip(harmonics).zip(1..) {
            // Below the number of angles, as the harmonic is below the period.
            let step = harmonic * (LONGEST_PERIOD_TICKS / period_ticks);
            *tone = Tone { step, phase: schroeder(number, u16::from(count)) };
        }
        Ok(Self { axis, count, amplitude: S::signal(force_n / f64::from(count)), tones })
    }

    /// The axis.
    #[must_use]
    pub fn axis(&self) -> usize {
        usize::from(self.axis)
    }

    /// The force of a tick, N; its magnitude is at most the sum of the amplitudes.
    #[must_use]
    pub fn force(&self, tick: u64) -> S {
        // Whole turns are multiples of 2¹³: of the product 16 bits suffice.
        #[expect(clippy::cast_possible_truncation, reason = "see above")]
        let tick = tick as u16;
        let mut sum = 0;
        for tone in self.tones.iter().take(usize::from(self.count)) {
            sum += sine_q14(tone.step.wrapping_mul(tick).wrapping_add(tone.phase));
        }
        // At most 8, with 14 fraction bits.
        self.amplitude.product(S::from_fixed(Fixed::from_bits(sum)))
    }
}

/// The phase of tone k of K: −k·(k − 1)/(2K) turns, in angles of the table, rounded towards 0.
fn schroeder(k: u16, of: u16) -> u16 {
    // At most 56·2¹² over at least 1.
    let angle = u32::from(k) * u32::from(k - 1) * u32::from(SINE_STEPS / 2) / u32::from(of);
    #[expect(clippy::cast_possible_truncation, reason = "modulo whole turns")]
    let angle = angle as u16;
    angle.wrapping_neg() % SINE_STEPS
}

#[cfg(test)]
mod tests {
    extern crate std;

    use core::f64::consts::TAU;
    use std::vec::Vec;

    use super::*;

    fn settings(force_n: f64, period_ticks: u16, harmonics: &[u16]) -> ExcitationSettings {
        let harmonics = heapless::Vec::from_slice(harmonics).unwrap();
        ExcitationSettings { axis: 1, force_n, period_ticks, harmonics }
    }

    /// Amplitude of a harmonic of a period, by the definition of the Fourier coefficient.
    fn amplitude(force: &[f64], harmonic: usize) -> f64 {
        let period = force.len();
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (tick, force) in force.iter().enumerate() {
            let angle = TAU * (harmonic * tick % period) as f64 / period as f64;
            real += force * libm::cos(angle);
            imaginary += force * libm::sin(angle);
        }
        2.0 / period as f64 * libm::hypot(real, imaginary)
    }

    /// Each tone has its part of the force and every other line of the spectrum none, to the rounding of the sine to 2⁻¹⁵ and of the product
    /// to 2⁻¹⁴ N.
    #[test]
    fn the_spectrum_has_the_tones_and_nothing_else() {
        for (period, harmonics) in
            [(256, &[1u16, 5, 127][..]), (512, &[255]), (8192, &[1, 2, 3, 70, 71, 900, 3000, 4095])]
        {
            let force_n = 80.0;
            let excitation = Excitation::<Fixed>::new(&settings(force_n, period, harmonics)).unwrap();
            let force: Vec<f64> = (0..u64::from(period)).map(|tick| excitation.force(tick).value()).collect();
            let expected = force_n / harmonics.len() as f64;
            let lines = if cfg!(miri) { 1..2 } else { 1..period / 2 };
            for line in lines.filter(|line| *line < 200 || line % 97 == 0 || harmonics.contains(line)) {
                let found = amplitude(&force, usize::from(line));
                let expected = if harmonics.contains(&line) { expected } else { 0.0 };
                assert!(
                    (found - expected).abs() < 80.0 / f64::from(1 << 14),
                    "{line} of {period}: {found} N"
                );
            }
        }
    }

    /// In every format, in any tick, and also where 16 bits of the tick wrap.
    #[test]
    fn the_force_is_periodic_and_within_its_limit() {
        fn check<S: Scalar>() {
            let excitation =
                Excitation::<S>::new(&settings(100.0, 2048, &[1, 2, 4, 9, 20, 45, 100, 1023])).unwrap();
            assert_eq!(excitation.axis(), 1);
            let mut greatest = 0f64;
            for tick in 0..2048u64 {
                let force = excitation.force(tick);
                greatest = greatest.max(force.value().abs());
                for later in [2048, 65_536, (1 << 40) * 2048] {
                    assert_eq!(force.bits(), excitation.force(tick + later).bits(), "{} {tick}", S::NAME);
                }
            }
            assert!(greatest <= 100.0 && greatest > 30.0, "{}: {greatest} N", S::NAME);
        }
        check::<Fixed>();
        check::<f32>();
        check::<f64>();
    }

    /// Of neighbouring harmonics. All in phase, the peak would be the sum of the amplitudes.
    #[test]
    fn the_phases_of_schroeder_keep_the_peak_low() {
        let excitation = Excitation::<f64>::new(&settings(8.0, 1024, &[3, 4, 5, 6, 7, 8, 9, 10])).unwrap();
        let peak = (0..1024).map(|tick| excitation.force(tick).abs()).fold(0.0, f64::max);
        // A crest factor below 2 of an effective value of 2 N.
        assert!(peak < 4.0, "{peak} N of 8 N");
        let phases: Vec<u16> = (1..=4).map(|k| schroeder(k, 4)).collect();
        // 0, −1/4, −3/4, −6/4 turns.
        assert_eq!(phases, [0, 6144, 2048, 4096]);
    }

    #[test]
    fn what_is_no_force_is_refused() {
        use ExcitationProblem::{Force, Period, Tones};

        let problem = |force_n, period, harmonics: &[u16]| {
            Excitation::<Fixed>::new(&settings(force_n, period, harmonics)).err()
        };
        assert_eq!(problem(1.0, 256, &[1, 127]), None);
        for force_n in [0.0, -1.0, f64::NAN, f64::INFINITY, 2e5] {
            assert_eq!(problem(force_n, 256, &[1]), Some(Force), "{force_n}");
        }
        for period in [0, 1, 128, 255, 257, 3000, 16_384, 32_768] {
            assert_eq!(problem(1.0, period, &[1]), Some(Period), "{period}");
        }
        for harmonics in [&[][..], &[0], &[128], &[5, 5], &[5, 4], &[1, 2, 200]] {
            assert_eq!(problem(1.0, 256, harmonics), Some(Tones), "{harmonics:?}");
        }
    }

    /// A tone begins at zero, and upwards.
    #[test]
    fn a_tone_is_positive_in_its_first_half() {
        let excitation = Excitation::<f64>::new(&settings(100.0, 8192, &[1])).unwrap();
        for (tick, sine) in [(0, 0.0), (1024, 0.5f64.sqrt()), (2048, 1.0), (4096, 0.0), (6144, -1.0)] {
            // The sine is rounded to 2⁻¹⁵ and the product to 2⁻¹⁴ N.
            assert!((excitation.force(tick) - 100.0 * sine).abs() < 100.0 / f64::from(1 << 14), "{tick}");
        }
    }
}
