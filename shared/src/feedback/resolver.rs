//! A resolver or sine encoder read by a converter: offset, phase, position, and the health of its signals.
//!
//! ```text
//! s = sine − offset_s        c = (cosine − offset_c)·ratio
//! phase = atan2(s, c)        amplitude² = s² + c²
//! ```
//!
//! The amplitude of good signals is constant. Below its limits a wire is broken, a magnet too far or a lamp too dark; above
//! them a converter saturates, or a short circuit adds to a signal. The check is made in every tick, in integers, on the square:
//! no root is taken. [`Sample::signals`] has what a display needs ([`EncoderSignals::figures`]), outside of the tick.
//!
//! A single bad sample makes a wrong position, because the next phase is taken to be within half a cycle: so it is a fault
//! at once ([`EncoderSignal`](crate::safety::FaultKind::EncoderSignal)). The position holds while the signals are bad.
//!
//! # Example
//!
//! A resolver with one pole pair on a screw of 5 mm, with 12-bit samples around 2048.
//!
//! ```
//! use shared::feedback::resolver::{Resolver, ResolverSettings};
//!
//! let settings = ResolverSettings { distance_m: 0.005, cycles: 1, ..ResolverSettings::TWELVE_BIT };
//! let mut resolver = Resolver::new(&settings, [2048, 2048 + 1500]).unwrap();
//! let sample = resolver.read([2048 + 1500, 2048]);
//! assert!(sample.is_good && (sample.position.to_m() - 0.005 / 4.0).abs() < 1e-9);
//! assert!(!resolver.read([2048 + 300, 2048]).is_good);
//! ```

use super::phase::Phase;
use super::transducer::Transducer;
use crate::figures::EncoderSignals;
use crate::units::Position;

/// Fraction bits of the ratio of the gains.
const RATIO_BITS: u32 = 14;

/// The signals of a resolver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResolverSettings {
    /// Distance of the table in `cycles` cycles, m; negative if the phase decreases in the positive direction.
    pub distance_m: f64,
    /// Cycles in that distance.
    pub cycles: u32,
    /// Counts of the converter at zero signal, of sine and cosine.
    pub offset_counts: [i16; 2],
    /// Amplitude of the sine over that of the cosine, ½ to 2.
    pub gain_ratio: f64,
    /// Least and greatest amplitude of good signals, counts.
    pub amplitude_counts: [u16; 2],
}

impl ResolverSettings {
    /// For a 12-bit converter, with an amplitude of 1500 counts ± 30 % and no error of offset or gain.
    pub const TWELVE_BIT: Self = Self {
        distance_m: 0.005,
        cycles: 1,
        offset_counts: [2048; 2],
        gain_ratio: 1.0,
        amplitude_counts: [1050, 1950],
    };
}

/// A resolver.
#[derive(Clone, Copy, Debug)]
pub struct Resolver {
    transducer: Transducer,
    offsets: [i32; 2],
    ratio: i32,
    /// Least and greatest amplitude, counts.
    limits: [u16; 2],
    /// Least and greatest amplitude².
    squared_limits: [u32; 2],
    position: Position,
}

/// A reading of a resolver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Position; that of the last good signals while they are bad.
    pub position: Position,
    /// Whether the amplitude is within its limits.
    pub is_good: bool,
    /// Amplitude², counts².
    pub amplitude_squared: u32,
    /// The signals without their errors, with the limits of their amplitude.
    pub signals: EncoderSignals,
}

impl Resolver {
    /// A resolver that is at position zero at these first samples of sine and cosine.
    ///
    /// `None` for a ratio outside of ½ to 2, limits that are not in increasing order above 0, a zero distance or one that
    /// [`Transducer::new`] rejects.
    #[must_use]
    pub fn new(settings: &ResolverSettings, first: [u16; 2]) -> Option<Self> {
        let [min, max] = settings.amplitude_counts.map(u32::from);
        let ratio = settings.gain_ratio;
        if !(0.5..=2.0).contains(&ratio) || min == 0 || min >= max {
            return None;
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most 2¹⁵")]
        let ratio = libm::rint(ratio * f64::from(1 << RATIO_BITS)) as i32;
        let mut resolver = Self {
            transducer: Transducer::new(settings.distance_m, settings.cycles, Phase(0))?,
            offsets: settings.offset_counts.map(i32::from),
            ratio,
            limits: settings.amplitude_counts,
            squared_limits: [min * min, max * max],
            position: Position(0),
        };
        let [sine, cosine] = resolver.corrected(first);
        let start = Phase::from_samples(sine, cosine, 1).unwrap_or_default();
        resolver.transducer = Transducer::new(settings.distance_m, settings.cycles, start)?;
        Some(resolver)
    }

    /// Sine and cosine without their errors of offset and gain, counts.
    fn corrected(&self, samples: [u16; 2]) -> [i32; 2] {
        let [sine, cosine] = samples.map(i32::from);
        let [sine_offset, cosine_offset] = self.offsets;
        // At most 98,303 counts: the product is below 2³².
        let cosine = i64::from(cosine.wrapping_sub(cosine_offset)) * i64::from(self.ratio);
        #[expect(clippy::cast_possible_truncation, reason = "at most 2·98,303")]
        let cosine = ((cosine + (1 << (RATIO_BITS - 1))) >> RATIO_BITS) as i32;
        [sine.wrapping_sub(sine_offset), cosine]
    }

    /// The reading for samples of sine and cosine, once per tick.
    pub fn read(&mut self, samples: [u16; 2]) -> Sample {
        let [sine, cosine] = self.corrected(samples);
        let square = |value: i32| u64::from(value.unsigned_abs()) * u64::from(value.unsigned_abs());
        let amplitude_squared = u32::try_from(square(sine).wrapping_add(square(cosine))).unwrap_or(u32::MAX);
        let [min, max] = self.squared_limits;
        let is_good = (min..=max).contains(&amplitude_squared);
        if let Some(phase) = Phase::from_samples(sine, cosine, 1).filter(|_| is_good) {
            self.position = self.transducer.read(phase);
        }
        let signals = EncoderSignals { sine, cosine, limits: self.limits };
        Sample { position: self.position, is_good, amplitude_squared, signals }
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    /// Samples of a 12-bit converter at a position, with offsets and a ratio of the gains.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "limited to 0 to 4095")]
    fn samples(turns: f64, amplitude: f64, settings: &ResolverSettings) -> [u16; 2] {
        let (sine, cosine) = (TAU * turns).sin_cos();
        let [sine_offset, cosine_offset] = settings.offset_counts.map(f64::from);
        [amplitude * sine + sine_offset, amplitude / settings.gain_ratio * cosine + cosine_offset]
            .map(|counts| counts.round().clamp(0.0, 4095.0) as u16)
    }

    proptest! {
        /// Through several turns in both directions: half a count in both samples is an error of 0.71/amplitude rad, doubled for
        /// the ratio of the gains, at the start and now; 2⁻¹⁵ of the ratio is another 3·10⁻⁵ rad.
        #[test]
        fn the_position_follows_the_turns(
            speed in -0.3..0.3f64, offset in 1900i16..2200, gain_ratio in 0.7..1.4f64, start in 0.0..1.0f64,
        ) {
            let settings = ResolverSettings {
                offset_counts: [offset, 4096 - offset], gain_ratio, amplitude_counts: [900, 1700],
                ..ResolverSettings::TWELVE_BIT
            };
            let amplitude = 1300.0;
            let mut resolver = Resolver::new(&settings, samples(start, amplitude, &settings)).unwrap();
            for tick in 0..100 {
                let turns = f64::from(tick) * speed;
                let sample = resolver.read(samples(start + turns, amplitude, &settings));
                prop_assert!(sample.is_good);
                let error_rad = (sample.position.to_m() / 0.005 - turns) * TAU;
                prop_assert!(error_rad.abs() < 2.0 * (2.0 * 0.71 / amplitude + 3.1e-5), "{error_rad}");
                let figures = sample.signals.figures();
                prop_assert!((f64::from(figures.amplitude_counts) - amplitude).abs() < 2.0);
                prop_assert_eq!(sample.signals.limits, [900, 1700]);
            }
        }

        /// Whatever the samples: no panic, and a position that is held while they are bad.
        #[test]
        fn any_samples(samples: [u16; 2], then: [u16; 2]) {
            let mut resolver = Resolver::new(&ResolverSettings::TWELVE_BIT, samples).unwrap();
            let before = resolver.position;
            let sample = resolver.read(then);
            prop_assert!(sample.is_good || sample.position == before);
        }
    }

    /// The limits are exact: an amplitude of 1050 and of 1950 counts is good, a count less or more is not, in any direction.
    #[test]
    fn signals_outside_of_their_amplitude_are_bad() {
        let settings = ResolverSettings::TWELVE_BIT;
        let mut resolver = Resolver::new(&settings, [2048, 2048 + 1500]).unwrap();
        let mut good = |sine: i32, cosine: i32| {
            let counts = [sine, cosine].map(|signal| u16::try_from(2048 + signal).unwrap());
            resolver.read(counts).is_good
        };
        assert!(good(1050, 0) && good(0, -1950) && !good(1049, 0) && !good(0, 1951) && !good(0, 0));
        // A broken wire of the cosine: bad unless the sine is near its extreme. A saturated pair is bad everywhere.
        let sine = |degree: i32| i32::from(samples(f64::from(degree) / 360.0, 1500.0, &settings)[0]) - 2048;
        let broken = (0..360).filter(|degree| good(sine(*degree), 0));
        assert!((170..190).contains(&broken.count()));
        assert!(!good(2047, 2047) && !good(-2048, 2047));
    }

    /// The ratio of the gains is applied to the nearest count: with ½, 1 to 4 counts are 1 (½ is rounded up), 1, 2 (of 1½) and 2, and the
    /// same below the offset, where −½ is 0 and −1½ is −1.
    #[test]
    fn the_ratio_is_rounded_to_the_nearest_count() {
        let settings = ResolverSettings { gain_ratio: 0.5, ..ResolverSettings::TWELVE_BIT };
        let mut resolver = Resolver::new(&settings, [2048 + 1500, 2048]).unwrap();
        for (counts, rounded) in [(0, 0), (1, 1), (2, 1), (3, 2), (4, 2), (-1, 0), (-2, -1), (-3, -1)] {
            let cosine = 2048u16.wrapping_add_signed(counts);
            let squares = resolver.read([2048 + 1500, cosine]).amplitude_squared;
            assert_eq!(squares, 1500 * 1500 + u32::try_from(rounded * rounded).unwrap(), "{counts}");
        }
    }

    #[test]
    fn invalid_settings_are_rejected() {
        let new = |change: fn(&mut ResolverSettings)| {
            let mut settings = ResolverSettings::TWELVE_BIT;
            change(&mut settings);
            Resolver::new(&settings, [2048, 3500]).is_some()
        };
        assert!(new(|_| {}));
        assert!(
            !new(|s| s.gain_ratio = 0.49)
                && !new(|s| s.gain_ratio = f64::NAN)
                && !new(|s| s.gain_ratio = 2.01)
        );
        assert!(!new(|s| s.amplitude_counts = [0, 100]) && !new(|s| s.amplitude_counts = [100, 100]));
        assert!(!new(|s| s.distance_m = 0.0) && !new(|s| s.cycles = 0));
    }
}
