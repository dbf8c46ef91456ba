//! Samples that a board sends while it runs.

use heapless::Deque;
use serde::{Deserialize, Serialize};

use crate::capture::{Encoder, Sample};

/// Samples that wait to be sent. At 20 kHz they last 3.2 ms.
const QUEUE: usize = 64;

/// Greatest number of bytes of samples in a packet.
pub const STREAM_BYTES: usize = 440;

/// Samples of a stream, complete in themselves: a packet that is lost leaves the others readable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StreamPacket {
    /// Number of the first sample since the stream was started; lost samples are counted.
    pub first: u32,
    /// The tick of the first sample of the stream.
    pub start: u64,
    /// Number of samples.
    pub samples: u16,
    /// Samples per position tick, which a decoder needs.
    pub period: u32,
    /// Samples that the board has lost since the stream was started.
    pub lost: u32,
    /// The samples.
    pub bytes: heapless::Vec<u8, STREAM_BYTES>,
}

/// The stream in the tick.
#[derive(Clone, Debug)]
pub struct StreamQueue<const N: usize> {
    samples: Deque<(u32, Sample<N>), QUEUE>,
    /// Ticks per sample; 0: no stream.
    decimation: u32,
    /// Ticks until the next sample, and whether the first one has been taken.
    wait: u32,
    started: bool,
    start: u64,
    next: u32,
    lost: u32,
}

impl<const N: usize> StreamQueue<N> {
    /// No stream.
    pub const OFF: Self =
        Self { samples: Deque::new(), decimation: 0, wait: 0, started: false, start: 0, next: 0, lost: 0 };

    /// Starts a stream of every `decimation`-th tick; 0 ends it.
    pub fn start(&mut self, decimation: u32) {
        self.samples.clear();
        (self.decimation, self.wait, self.started) = (decimation, 0, false);
        (self.next, self.lost) = (0, 0);
    }

    /// Whether the present tick is a sample. The first one is at a position tick, or at any tick with the drives off.
    #[inline]
    pub const fn takes(&mut self, tick: u64, aligned: bool) -> bool {
        if self.decimation == 0 {
            return false;
        }
        if !self.started {
            if !aligned {
                return false;
            }
            (self.started, self.start, self.wait) = (true, tick, 0);
        }
        if self.wait > 0 {
            self.wait -= 1;
            return false;
        }
        self.wait = self.decimation - 1;
        true
    }

    /// Queues a sample; it is lost if the queue is full.
    #[inline]
    pub fn append(&mut self, sample: &Sample<N>) {
        if self.samples.push_back((self.next, *sample)).is_err() {
            self.lost = self.lost.saturating_add(1);
        }
        self.next = self.next.wrapping_add(1);
    }

    /// Samples that were lost since the stream was started.
    #[must_use]
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    /// Number of samples that wait.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.samples.len()
    }

    /// Ticks per sample; 0: no stream.
    #[must_use]
    pub const fn decimation(&self) -> u32 {
        self.decimation
    }

    /// The tick of the first sample.
    #[must_use]
    pub const fn start_tick(&self) -> u64 {
        self.start
    }

    /// The oldest sample, if its number is `number` or that is `None`.
    pub fn pop(&mut self, number: Option<u32>) -> Option<(u32, Sample<N>)> {
        let (oldest, _) = self.samples.front()?;
        if number.is_some_and(|number| number != *oldest) {
            return None;
        }
        self.samples.pop_front()
    }
}

impl StreamPacket {
    /// A packet of the samples that `next` returns (for the number that is expected, `None` for the first one), as many as fit;
    /// `None` without a sample.
    pub fn fill<const N: usize>(
        period: u32,
        mut next: impl FnMut(Option<u32>) -> Option<(u32, Sample<N>)>,
    ) -> Option<Self> {
        let (first, mut sample) = next(None)?;
        let mut bytes = heapless::Vec::new();
        let _ = bytes.resize(STREAM_BYTES, 0);
        let mut encoder = Encoder::new(period);
        let mut samples: u16 = 0;
        while encoder.append(&sample, &mut bytes) {
            samples += 1;
            if !encoder.has_room(STREAM_BYTES) {
                break;
            }
            let Some((_, following)) = next(Some(first.wrapping_add(u32::from(samples)))) else { break };
            sample = following;
        }
        bytes.truncate(encoder.length());
        Some(Self { first, start: 0, samples, period, lost: 0, bytes })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::Decoder;

    const AXES: usize = 2;

    const fn sample(k: i64) -> Sample<AXES> {
        [[k; 4]; AXES]
    }

    /// The first sample is at a position tick; the others follow every third tick, wherever that is.
    #[test]
    fn a_stream_starts_at_a_position_tick() {
        let mut queue = StreamQueue::<AXES>::OFF;
        assert!(!queue.takes(0, true) && queue.decimation() == 0);
        queue.start(3);
        assert_eq!(queue.decimation(), 3);
        assert!(!queue.takes(1, false) && !queue.takes(2, false));
        let taken = [true, false, false, false, false, true, false].map({
            let mut tick = 2;
            let queue = &mut queue;
            move |aligned| {
                tick += 1;
                queue.takes(tick, aligned)
            }
        });
        assert_eq!((taken, queue.start_tick()), ([true, false, false, true, false, false, true], 3));
    }

    #[test]
    fn only_the_sample_of_the_expected_number_is_taken() {
        let mut queue = StreamQueue::<AXES>::OFF;
        queue.start(1);
        for k in 0..3 {
            queue.append(&sample(k));
        }
        assert_eq!(queue.pop(Some(1)), None);
        assert_eq!((queue.pop(Some(0)), queue.pop(None)), (Some((0, sample(0))), Some((1, sample(1)))));
        assert_eq!((queue.pop(Some(3)), queue.waiting()), (None, 1));
    }

    /// Samples that do not change take a group of four bits per channel, and a packet has them until the longest one would not fit
    /// the rest; it ends before a gap.
    #[test]
    fn a_packet_is_filled_until_it_is_full_or_there_is_a_gap() {
        let fill = |available: u32| {
            let mut number = 0..available;
            let next = |expected: Option<u32>| {
                let k = number.next()?;
                assert_eq!(expected, (k > 0).then_some(k + 100));
                Some((k + 100, sample(7)))
            };
            StreamPacket::fill(1, next).unwrap()
        };
        let full = fill(u32::MAX);
        // Four channels of 22 groups, two of them in a byte.
        let longest = AXES * 4 * 22 / 2;
        assert!((STREAM_BYTES - longest..=STREAM_BYTES).contains(&full.bytes.len()), "{}", full.bytes.len());
        for (packet, samples) in [(&fill(10), 10), (&full, full.samples)] {
            assert_eq!((packet.first, packet.samples), (100, samples));
            let mut decoder = Decoder::<AXES>::new(1, &packet.bytes);
            assert!((0..samples).all(|_| decoder.next_sample() == Some(sample(7))));
        }
        assert!(full.samples > 10);
    }
}
