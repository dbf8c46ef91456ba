//! Counts the instructions of a part over many inputs.

use core::hint::black_box;

use cortex_m_semihosting::hprintln;
use shared::session::Meter;

use super::motion::TICKS;
use crate::emulated::InstructionMeter;

/// The counts of one part, one a tick.
pub struct Counter {
    meter: InstructionMeter,
    counts: [u32; TICKS],
    /// Of a part that gives its input back: the opaque calls round a part cost a few themselves.
    overhead: u32,
}

impl Counter {
    /// Counts nothing once, to take that off everything else.
    #[must_use]
    pub fn new(meter: InstructionMeter) -> Self {
        let mut counter = Self { meter, counts: [0; TICKS], overhead: 0 };
        counter.overhead = counter.count(&[0u32; 16], |&input| input).median;
        counter
    }

    /// Prints the head of the table.
    pub fn head(&self) {
        hprintln!("{:<26} {:<6} {:>7} {:>7} {:>8}", "part", "format", "median", "worst", "worst/");
        hprintln!("{:<26} {:<6} {:>7} {:>7} {:>8}", "", "", "", "", "median");
    }

    /// Counts a part and prints its line.
    pub fn part<T, R>(&mut self, name: &str, format: &str, inputs: &[T], part: impl FnMut(&T) -> R) {
        let Count { median, worst } = self.count(inputs, part);
        let percent = (worst * 100).checked_div(median).unwrap_or(0);
        hprintln!("{name:<26} {format:<6} {median:>7} {worst:>7} {:>5}.{:02}", percent / 100, percent % 100);
    }

    /// The compiler may neither know an input, nor drop a result, nor move work past the clock: `black_box`
    /// stands between, in that order. It keeps a state behind a pointer in memory, as a tick does.
    #[inline(never)]
    fn count<T, R>(&mut self, inputs: &[T], mut part: impl FnMut(&T) -> R) -> Count {
        for (count, input) in self.counts.iter_mut().zip(inputs) {
            let input = black_box(input);
            self.meter.start();
            let result = part(black_box(input));
            black_box(&result);
            *count = self.meter.stop().saturating_sub(self.overhead);
        }
        let counted = inputs.len().min(TICKS);
        let counts = self.counts.get_mut(..counted).unwrap_or_default();
        counts.sort_unstable();
        let at = |i: usize| counts.get(i).copied().unwrap_or(0);
        Count { median: at(counted / 2), worst: at(counted.saturating_sub(1)) }
    }
}

/// Instructions of a part.
#[derive(Clone, Copy)]
struct Count {
    median: u32,
    worst: u32,
}
