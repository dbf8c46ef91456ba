//! Positions and forces in whole steps.
//!
//! A division by the step would take longer than everything else of a recording. The distance from the last recorded value is
//! small, and is multiplied by the reciprocal of the step instead.

use super::{CHANNELS, COMMAND, FORCE, MOTOR, NO_READING, Sample, TABLE};
use crate::feedback::Reading;
use crate::scalar::Scalar;
use crate::units::{PER_M, PER_NM, Position};

/// Least step of a position, position units: 1/16 nm, the resolution of the control error.
pub const MIN_STEP: i64 = PER_NM / 16;

/// Greatest step of a position, position units: 1 mm.
const MAX_STEP: i64 = 1_000_000 * PER_NM;

/// Low bits of a distance that the fast way does not use.
const COARSE: u32 = 12;

/// Fraction bits of [`Scalar::distance`].
const FORCE_FRACTION: u32 = 30;

/// The steps of the recorded channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelSteps<const N: usize> {
    /// Step of the command, position units.
    pub command: i64,
    /// Step of each motor reading, position units: an encoder count.
    pub motor: [i64; N],
    /// Step of each linear scale, position units: a count of the scale.
    pub table: [i64; N],
    /// A step of the force is 2^−this, N; at most 14, the resolution of the fixed-point force.
    pub force_bits: u8,
}

impl<const N: usize> ChannelSteps<N> {
    /// 1/16 nm for the commands, counts in metres for motors and scales, and 2^−`force_bits` N for forces. Steps out of the
    /// range of 1/16 nm to 1 mm are set to its ends.
    #[must_use]
    pub fn of_counts(motor_m: [f64; N], table_m: [f64; N], force_bits: u8) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "saturates, and is clamped")]
        let steps = |metres: [f64; N]| {
            metres.map(|m| (libm::rint(libm::fabs(m) * PER_M) as i64).clamp(MIN_STEP, MAX_STEP))
        };
        Self {
            command: MIN_STEP,
            motor: steps(motor_m),
            table: steps(table_m),
            force_bits: force_bits.min(14),
        }
    }

    /// The values of a sample: positions in m (`None`: no reading), and the force in N.
    #[must_use]
    pub fn values(&self, axis: usize, sample: &[i64; CHANNELS]) -> ([Option<f64>; 3], f64) {
        let step = |steps: &[i64; N]| steps.get(axis).copied().unwrap_or(1);
        let metres = |channel: usize, step: i64| {
            let value = sample[channel];
            (value != NO_READING).then(|| Position(value.wrapping_mul(step)).to_m())
        };
        let positions = [
            metres(COMMAND, self.command),
            metres(MOTOR, step(&self.motor)),
            metres(TABLE, step(&self.table)),
        ];
        (positions, sample[FORCE] as f64 / f64::from(1u32 << self.force_bits))
    }
}

/// Converts the positions of one channel.
#[derive(Clone, Copy, Debug)]
struct Quantiser {
    step: i64,
    /// 2^(`shift` + [`COARSE`])/step, at most 2³⁰, for distances without their lowest bits.
    reciprocal: i64,
    shift: u32,
    /// Last value, and its position.
    value: i64,
    at: i64,
}

impl Quantiser {
    fn new(step: i64) -> Self {
        let step = step.clamp(MIN_STEP, MAX_STEP);
        // 2^(30 + log₂ step)/step is from 2²⁹ to 2³⁰: multiplied by 31 bits and a sign, it fits. From a step of 2³² on, the
        // dividend is the limit; the distances of the fast way are then below 2¹¹ steps, and need fewer bits.
        let bits = (30 + step.ilog2()).min(62);
        Self { step, reciprocal: (1i64 << bits) / step, shift: bits - COARSE, value: 0, at: 0 }
    }

    /// The nearest whole number of steps. The distance is short of its low bits, by at most 1/16 step, and the reciprocal is
    /// rounded down, by at most 1/8 step after a jump of 8 mm: a position within 5/16 step of a whole number gives that number.
    #[inline]
    fn value(&mut self, position: Position) -> i64 {
        let coarse = position.0.wrapping_sub(self.at) >> COARSE;
        let steps = match i32::try_from(coarse) {
            Ok(coarse) => (i64::from(coarse) * self.reciprocal + (1 << (self.shift - 1))) >> self.shift,
            Err(_) => self.far(position),
        };
        self.value = self.value.wrapping_add(steps);
        self.at = self.at.wrapping_add(steps.wrapping_mul(self.step));
        self.value
    }

    /// Steps to a position beyond the range of the fast way: 8 mm from the last one.
    #[cold]
    fn far(&self, position: Position) -> i64 {
        let distance = position.0.wrapping_sub(self.at);
        // The step is positive.
        distance.saturating_add(self.step / 2).checked_div_euclid(self.step).unwrap_or(0)
    }
}

/// Converts all channels of N axes.
#[derive(Clone, Copy, Debug)]
pub struct Quantisers<const N: usize> {
    command: [Quantiser; N],
    motor: [Quantiser; N],
    table: [Quantiser; N],
    force_shift: u32,
}

impl<const N: usize> Quantisers<N> {
    /// For these steps.
    #[must_use]
    pub fn new(steps: &ChannelSteps<N>) -> Self {
        Self {
            command: [Quantiser::new(steps.command); N],
            motor: steps.motor.map(Quantiser::new),
            table: steps.table.map(Quantiser::new),
            force_shift: FORCE_FRACTION - u32::from(steps.force_bits.min(14)),
        }
    }

    /// The sample of a tick.
    #[inline]
    pub fn sample<S: Scalar>(
        &mut self,
        commands: &[Position; N],
        readings: &[Reading; N],
        forces: &[S; N],
    ) -> Sample<N> {
        let mut sample = [[0; CHANNELS]; N];
        let inputs = commands.iter().zip(readings).zip(forces);
        let quantisers = self.command.iter_mut().zip(&mut self.motor).zip(&mut self.table);
        for ((values, ((command, reading), force)), ((commands, motors), tables)) in
            sample.iter_mut().zip(inputs).zip(quantisers)
        {
            values[COMMAND] = commands.value(*command);
            values[MOTOR] = motors.value(reading.motor);
            values[TABLE] = reading.table.map_or(NO_READING, |table| tables.value(table));
            let half = 1i64 << (self.force_shift - 1);
            values[FORCE] = force.distance().saturating_add(half) >> self.force_shift;
        }
        sample
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::scalar::Fixed;

    /// From 1/16 nm to 1 mm, each power of two equally often.
    fn steps_of_any_size() -> impl Strategy<Value = i64> {
        (MIN_STEP.ilog2()..=MAX_STEP.ilog2(), 0..i64::MAX)
            .prop_map(|(log2, fraction)| ((1 << log2) + fraction % (1i64 << log2)).clamp(MIN_STEP, MAX_STEP))
    }

    /// Steps at which the reciprocal changes its number of bits.
    #[test]
    fn counts_of_every_power_of_two_are_recorded_exactly() {
        for log2 in MIN_STEP.ilog2()..=MAX_STEP.ilog2() {
            for step in [(1i64 << log2) - 1, 1 << log2, (1 << log2) + 1] {
                let step = step.clamp(MIN_STEP, MAX_STEP);
                let mut quantiser = Quantiser::new(step);
                for count in [1, -1, 1024, 3, 2000, -100, 0] {
                    assert_eq!(quantiser.value(Position(count * step)), count, "step {step}");
                }
            }
        }
    }

    proptest! {
        /// A position that is a whole number of counts, but for the rounding of a unit, is recorded as that number, however far
        /// it has jumped; any other to the nearest count.
        #[test]
        fn counts_are_recorded_exactly(
            step in steps_of_any_size(), counts in proptest::collection::vec(-1_000_000i64..1_000_000, 1..20), off in -1i64..=1,
        ) {
            let mut quantiser = Quantiser::new(step);
            for count in counts {
                prop_assert_eq!(quantiser.value(Position(count * step + off)), count);
                let near = quantiser.value(Position(count * step + step / 2 - step / 64 - 5000 .min(step / 16)));
                prop_assert_eq!(near, count);
            }
        }
    }

    #[test]
    fn a_sample_has_all_channels_in_their_steps() {
        let steps = ChannelSteps::of_counts([0.25e-6], [50e-9], 5);
        let mut quantisers = Quantisers::new(&steps);
        let position = |m| Position::from_m(m).unwrap();
        let reading = Reading { motor: position(10e-6), table: Some(position(9.95e-6)) };
        let [sample] = quantisers.sample(&[position(10e-6)], &[reading], &[Fixed::signal(-1.5)]);
        assert_eq!(sample, [160_000, 40, 199, -48]);
        let ([command, motor, table], force) = steps.values(0, &sample);
        for (value, expected) in [(command, 10e-6), (motor, 10e-6), (table, 9.95e-6)] {
            assert!((value.unwrap() - expected).abs() < 1e-15);
        }
        assert!((force + 1.5).abs() < 1e-12);
        let lost =
            quantisers.sample(&[Position(0)], &[Reading { table: None, ..reading }], &[Fixed::signal(0.0)]);
        assert_eq!(lost, [[0, 40, NO_READING, 0]]);
        assert_eq!(steps.values(0, &lost[0]).0[2], None);
    }

    #[test]
    fn steps_out_of_range_are_set_to_its_ends() {
        let steps = ChannelSteps::of_counts([1e-15, -0.25e-6], [10.0, 1e-3], 40);
        assert_eq!(steps.motor, [MIN_STEP, 262_144_000]);
        assert_eq!((steps.table, steps.force_bits), ([MAX_STEP; 2], 14));
    }

    /// A force is recorded to the nearest step of 1/32 N, halves upwards.
    #[test]
    fn forces_are_recorded_to_the_nearest_step() {
        let mut quantisers = Quantisers::new(&ChannelSteps::of_counts([0.25e-6], [50e-9], 5));
        let reading = Reading { motor: Position(0), table: None };
        for (steps, expected) in
            [(0.0, 0), (0.4, 0), (0.5, 1), (0.6, 1), (1.4, 1), (-0.4, 0), (-0.6, -1), (-1.4, -1)]
        {
            let [sample] = quantisers.sample(&[Position(0)], &[reading], &[Fixed::signal(steps / 32.0)]);
            assert_eq!(sample[FORCE], expected, "{steps} steps");
        }
    }
}
