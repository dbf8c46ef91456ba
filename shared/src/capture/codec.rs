//! Samples in bytes.

use super::nibbles::{LONGEST, Reader, Writer};
use super::prediction::Prediction;
use super::{CHANNELS, Sample};

/// Groups of four bits of the longest sample of an axis.
pub const LONGEST_SAMPLE_NIBBLES: usize = CHANNELS * LONGEST;

/// Appends samples to a buffer.
#[derive(Clone, Copy, Debug)]
pub struct Encoder<const N: usize> {
    prediction: Prediction<N>,
    writer: Writer,
}

impl<const N: usize> Encoder<N> {
    /// At the start of a buffer, with a number of samples per position tick.
    #[must_use]
    pub const fn new(period: u32) -> Self {
        Self { prediction: Prediction::new(period), writer: Writer { groups: 0 } }
    }

    /// Appends a sample. False, with the sample not counted, if the longest one would not fit.
    #[inline]
    pub fn append(&mut self, sample: &Sample<N>, bytes: &mut [u8]) -> bool {
        if !self.has_room(bytes.len()) {
            return false;
        }
        let writer = &mut self.writer;
        let written = self.prediction.step(|axis, channel, predicted| {
            let value = *sample.get(axis)?.get(channel)?;
            writer.push(value.wrapping_sub(predicted), bytes).then_some(value)
        });
        written.is_some()
    }

    /// Whether the longest sample fits a buffer of this many bytes.
    #[must_use]
    pub const fn has_room(&self, bytes: usize) -> bool {
        self.writer.groups + N * LONGEST_SAMPLE_NIBBLES <= 2 * bytes
    }

    /// Bytes that have been written.
    #[must_use]
    pub const fn length(&self) -> usize {
        self.writer.bytes()
    }
}

/// Reads samples.
#[derive(Clone, Debug)]
pub struct Decoder<'a, const N: usize> {
    prediction: Prediction<N>,
    reader: Reader<'a>,
}

impl<'a, const N: usize> Decoder<'a, N> {
    /// From the start of the bytes of an [`Encoder`] with the same period.
    #[must_use]
    pub const fn new(period: u32, bytes: &'a [u8]) -> Self {
        Self { prediction: Prediction::new(period), reader: Reader::new(bytes) }
    }

    /// The next sample; `None` if the bytes end before. The number of samples is not part of the bytes: the last half byte may
    /// be empty.
    pub fn next_sample(&mut self) -> Option<Sample<N>> {
        let reader = &mut self.reader;
        self.prediction.step(|_, _, predicted| Some(predicted.wrapping_add(reader.pull()?)))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every sequence of samples, of any size and with any period, is read as it was written.
        #[test]
        fn samples_are_read_as_written(
            samples in proptest::collection::vec(any::<([[i64; 4]; 2], u32)>(), 1..60), period in 0u32..40,
        ) {
            let shifted = |(sample, shift): ([[i64; 4]; 2], u32)| {
                sample.map(|axis| axis.map(|value| value >> (shift % 64)))
            };
            let samples: std::vec::Vec<_> = samples.into_iter().map(shifted).collect();
            let mut bytes = std::vec![0xaa; 61 * LONGEST_SAMPLE_NIBBLES];
            let mut encoder = Encoder::<2>::new(period);
            for sample in &samples {
                prop_assert!(encoder.append(sample, &mut bytes));
            }
            let mut decoder = Decoder::<2>::new(period, &bytes[..encoder.length()]);
            for sample in &samples {
                prop_assert_eq!(decoder.next_sample(), Some(*sample));
            }
        }
    }

    /// A command that steps every fifth sample, and readings that move evenly, take one group per channel once the prediction
    /// has seen one period and two changes.
    #[test]
    fn even_motion_takes_one_group_per_channel() {
        let mut bytes = [0; 4096];
        let mut encoder = Encoder::<1>::new(5);
        let mut at_start = 0;
        for k in 0..500i64 {
            assert!(encoder.append(&[[k / 5 * 100_000, 13 * k, 14 * k, 500]], &mut bytes));
            if k == 9 {
                at_start = encoder.writer.groups;
            }
        }
        assert_eq!(encoder.writer.groups - at_start, 4 * 490);
    }

    #[test]
    fn a_sample_that_may_not_fit_is_refused_and_nothing_is_overwritten() {
        let mut bytes = [0; LONGEST_SAMPLE_NIBBLES / 2 + 2];
        let mut encoder = Encoder::<1>::new(1);
        let mut kept = 0;
        while encoder.append(&[[kept, 0, 0, 0]], &mut bytes) {
            kept += 1;
        }
        assert!(kept >= 2, "{kept}");
        let mut decoder = Decoder::<1>::new(1, &bytes[..encoder.length()]);
        for k in 0..kept {
            assert_eq!(decoder.next_sample(), Some([[k, 0, 0, 0]]));
        }
    }
}
