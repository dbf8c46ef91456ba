//! A recording at the full tick rate in the RAM of the board.

use serde::{Deserialize, Serialize};

use super::Sample;
use super::codec::Encoder;

/// When a recording starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trigger {
    /// At the next position tick, or at the next tick while the drives are off.
    Now,
    /// When the path starts.
    Motion,
}

/// What a recording does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum CaptureState {
    /// There is none.
    #[default]
    Empty,
    /// It waits for its trigger.
    Armed,
    /// It records.
    Recording,
    /// It has the number of samples that was asked for, or the memory is full.
    Complete,
}

/// The recording, in a memory that the board provides.
#[derive(Debug)]
pub struct CaptureMemory<'m, const N: usize> {
    bytes: &'m mut [u8],
    encoder: Encoder<N>,
    state: CaptureState,
    trigger: Trigger,
    period: u32,
    samples: u32,
    max_samples: u32,
    /// Ticks before the first sample since the start of the board.
    start: u64,
}

impl<'m, const N: usize> CaptureMemory<'m, N> {
    /// No recording.
    #[must_use]
    pub const fn new(bytes: &'m mut [u8]) -> Self {
        Self {
            bytes,
            encoder: Encoder::new(1),
            state: CaptureState::Empty,
            trigger: Trigger::Now,
            period: 1,
            samples: 0,
            max_samples: 0,
            start: 0,
        }
    }

    /// Size of the memory, bytes.
    #[must_use]
    pub const fn capacity(&self) -> usize {
        self.bytes.len()
    }

    /// Prepares a recording of at most `max_samples`; a previous one is discarded. `period` is the number of ticks per position
    /// tick.
    pub const fn arm(&mut self, trigger: Trigger, max_samples: u32, period: u32) {
        self.encoder = Encoder::new(period);
        (self.state, self.trigger, self.period) = (CaptureState::Armed, trigger, period);
        (self.samples, self.max_samples, self.start) = (0, max_samples, 0);
    }

    /// Whether the present tick is to be recorded, from whether the path moves and whether the tick ran the position loops (or
    /// the drives are off).
    #[inline]
    pub const fn takes(&mut self, tick: u64, moving: bool, aligned: bool) -> bool {
        let triggered = match self.trigger {
            Trigger::Now => true,
            Trigger::Motion => moving,
        };
        if matches!(self.state, CaptureState::Armed) && triggered && aligned {
            (self.state, self.start) = (CaptureState::Recording, tick);
        }
        matches!(self.state, CaptureState::Recording)
    }

    /// Records the sample of a tick.
    #[inline]
    pub fn append(&mut self, sample: &Sample<N>) {
        if self.state != CaptureState::Recording {
            return;
        }
        if self.samples < self.max_samples && self.encoder.append(sample, self.bytes) {
            self.samples += 1;
        }
        // Known without the next sample, so that a recording that is long enough is complete.
        if self.samples >= self.max_samples || !self.encoder.has_room(self.bytes.len()) {
            self.state = CaptureState::Complete;
        }
    }

    /// Ends a recording that waits or records; what it has is kept.
    pub const fn end(&mut self) {
        self.state = match self.state {
            CaptureState::Recording => CaptureState::Complete,
            CaptureState::Armed => CaptureState::Empty,
            state => state,
        };
    }

    /// What the recording does.
    #[must_use]
    pub const fn state(&self) -> CaptureState {
        self.state
    }

    /// Number of samples.
    #[must_use]
    pub const fn samples(&self) -> u32 {
        self.samples
    }

    /// Samples per position tick.
    #[must_use]
    pub const fn period(&self) -> u32 {
        self.period
    }

    /// The tick of the first sample.
    #[must_use]
    pub const fn start(&self) -> u64 {
        self.start
    }

    /// The bytes of the samples.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.encoder.length()).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Decoder;
    use super::*;

    #[test]
    fn a_recording_starts_at_its_trigger_and_ends_at_its_length() {
        let mut bytes = [0; 4096];
        let mut memory = CaptureMemory::<1>::new(&mut bytes);
        assert_eq!(memory.capacity(), 4096);
        assert!(!memory.takes(0, true, true));
        memory.arm(Trigger::Motion, 3, 5);
        assert!(!memory.takes(1, false, true) && !memory.takes(2, true, false));
        assert_eq!(memory.state(), CaptureState::Armed);
        assert!(memory.takes(3, true, true));
        for k in 0..5 {
            memory.append(&[[k, k, k, k]]);
        }
        assert_eq!((memory.state(), memory.samples(), memory.start()), (CaptureState::Complete, 3, 3));
        let mut decoder = Decoder::<1>::new(memory.period(), memory.bytes());
        assert!((0..3).all(|k| decoder.next_sample() == Some([[k; 4]])));
    }

    #[test]
    fn a_full_memory_ends_the_recording_with_what_it_has() {
        let mut bytes = [0; 256];
        let mut memory = CaptureMemory::<1>::new(&mut bytes);
        memory.arm(Trigger::Now, u32::MAX, 1);
        assert!(memory.takes(9, false, true));
        let value = |k: i64| [[k * k * 1_000_003, -k * 77_777, (k % 7) << 40, k]];
        let mut given = 0;
        while memory.state() == CaptureState::Recording {
            memory.append(&value(given));
            given += 1;
        }
        assert!(memory.samples() > 5 && memory.bytes().len() <= 256);
        let mut decoder = Decoder::<1>::new(memory.period(), memory.bytes());
        assert!((0..i64::from(memory.samples())).all(|k| decoder.next_sample() == Some(value(k))));
    }

    #[test]
    fn an_ended_recording_keeps_its_samples() {
        let mut bytes = [0; 256];
        let mut memory = CaptureMemory::<1>::new(&mut bytes);
        memory.arm(Trigger::Now, 10, 1);
        memory.end();
        assert_eq!(memory.state(), CaptureState::Empty);
        memory.arm(Trigger::Now, 10, 1);
        assert!(memory.takes(0, false, true));
        memory.append(&[[1; 4]]);
        memory.end();
        assert_eq!((memory.state(), memory.samples()), (CaptureState::Complete, 1));
    }

    #[test]
    fn a_recording_of_no_samples_has_none() {
        let mut bytes = [0; 256];
        let mut memory = CaptureMemory::<1>::new(&mut bytes);
        memory.arm(Trigger::Now, 0, 1);
        assert!(memory.takes(0, false, true));
        memory.append(&[[1; 4]]);
        assert_eq!((memory.state(), memory.samples()), (CaptureState::Complete, 0));
        assert!(memory.bytes().is_empty());
    }
}
