//! Counts the instructions of a part over many inputs.

use core::hint::black_box;

use cortex_m_semihosting::hprintln;
use shared::lockstep::session::Meter;

use super::motion::TICKS;
use crate::emulated::InstructionMeter;

/// Counts the instructions of one part at a time.
pub struct Counter {
    meter: InstructionMeter,
    counts: [u32; TICKS],
    /// Count of a part that returns its input: that of the calls around a part.
    overhead: u32,
}

impl Counter {
    /// Measures the overhead, which is subtracted from every count.
    #[must_use]
    pub fn new(meter: InstructionMeter) -> Self {
        let mut counter = Self { meter, counts: [0; TICKS], overhead: 0 };
        counter.overhead = counter.count(&[0u32; 16], |&input| input).median;
        counter
    }

    /// Prints the header of the table.
    pub fn print_header(&self) {
        hprintln!("{:<26} {:<6} {:>7} {:>7} {:>8}", "part", "format", "median", "worst", "worst/");
        hprintln!("{:<26} {:<6} {:>7} {:>7} {:>8}", "", "", "", "", "median");
    }

    /// Counts a part over its inputs and prints its row.
    pub fn part<T, R>(&mut self, name: &str, format: &str, inputs: &[T], part: impl FnMut(&T) -> R) {
        self.count(inputs, part).print(name, format);
    }

    /// Counts a part over the last of each `stride` inputs, and prints its row. The part gets the others, too.
    pub fn last_of_each<T, R>(
        &mut self,
        (name, format): (&str, &str),
        (inputs, stride): (&[T], usize),
        mut part: impl FnMut(&T) -> R,
    ) {
        let mut counted = 0;
        for (count, inputs) in self.counts.iter_mut().zip(inputs.chunks_exact(stride)) {
            let Some((last, others)) = inputs.split_last() else { return };
            for input in others {
                black_box(part(black_box(input)));
            }
            self.meter.start();
            let result = part(black_box(last));
            black_box(&result);
            *count = self.meter.stop().saturating_sub(self.overhead);
            counted += 1;
        }
        self.counted(counted).print(name, format);
    }

    /// `black_box` keeps the compiler from knowing an input, dropping a result or moving work across the measurement. It also
    /// keeps the state in memory behind a pointer, as in a tick.
    #[inline(never)]
    fn count<T, R>(&mut self, inputs: &[T], mut part: impl FnMut(&T) -> R) -> Count {
        for (count, input) in self.counts.iter_mut().zip(inputs) {
            let input = black_box(input);
            self.meter.start();
            let result = part(black_box(input));
            black_box(&result);
            *count = self.meter.stop().saturating_sub(self.overhead);
        }
        self.counted(inputs.len().min(TICKS))
    }

    /// Of the first counts.
    fn counted(&mut self, counted: usize) -> Count {
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

impl Count {
    /// Prints a row.
    fn print(self, name: &str, format: &str) {
        let Self { median, worst } = self;
        let percent = (worst * 100).checked_div(median).unwrap_or(0);
        hprintln!("{name:<26} {format:<6} {median:>7} {worst:>7} {:>5}.{:02}", percent / 100, percent % 100);
    }
}
