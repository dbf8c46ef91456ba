//! What the previous samples predict for the next one.
//!
//! | channel | predicted |
//! |---|---|
//! | command | the last value, plus its change one period of the position loop ago: between position ticks the command stands |
//! | motor, table | the last value, plus its last change |
//! | force | the last value |

use super::{CHANNELS, COMMAND, MOTOR, Sample, TABLE};

/// Greatest number of samples per position tick that the prediction follows.
pub const MAX_PERIOD: usize = 20;

/// The state of the prediction, the same when samples are written and when they are read.
#[derive(Clone, Copy, Debug)]
pub struct Prediction<const N: usize> {
    last: Sample<N>,
    /// Last changes of motor and table reading.
    changes: [[i64; 2]; N],
    /// Last changes of the command, a ring of `period`.
    command_changes: [[i64; MAX_PERIOD]; N],
    period: usize,
    next: usize,
}

impl<const N: usize> Prediction<N> {
    /// Before the first sample, with a number of samples per position tick. A period that is too long to follow counts as 1.
    #[must_use]
    pub const fn new(period: u32) -> Self {
        let period = if period as usize > MAX_PERIOD || period == 0 { 1 } else { period as usize };
        Self {
            last: [[0; CHANNELS]; N],
            changes: [[0; 2]; N],
            command_changes: [[0; MAX_PERIOD]; N],
            period,
            next: 0,
        }
    }

    /// Passes the prediction of each channel (with axis and channel) to `value`, which returns the value of the sample. `None`
    /// as soon as that returns `None`; the state is then of no further use. Sums wrap, so that every value can be predicted.
    #[inline]
    pub fn step(&mut self, mut value: impl FnMut(usize, usize, i64) -> Option<i64>) -> Option<Sample<N>> {
        let axes = self.last.iter_mut().zip(&mut self.changes).zip(&mut self.command_changes);
        for (axis, ((last, changes), command_changes)) in axes.enumerate() {
            for (channel, last) in last.iter_mut().enumerate() {
                let change = match channel {
                    COMMAND => command_changes.get_mut(self.next),
                    MOTOR => changes.first_mut(),
                    TABLE => changes.last_mut(),
                    _ => None,
                };
                let predicted = last.wrapping_add(change.as_deref().copied().unwrap_or(0));
                let found = value(axis, channel, predicted)?;
                if let Some(change) = change {
                    *change = found.wrapping_sub(*last);
                }
                *last = found;
            }
        }
        self.next += 1;
        if self.next >= self.period {
            self.next = 0;
        }
        Some(self.last)
    }
}
