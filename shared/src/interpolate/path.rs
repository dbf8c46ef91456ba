//! The queue of planned blocks and the place that has been reached.

use heapless::Deque;

use super::PathError;
use super::block::Block;
use super::planned::Planned;
use super::trapezoid::Progress;
use crate::units::Position;

/// Blocks that wait, at the most.
pub const QUEUE: usize = 16;

/// A path of exact stops: each block ends at rest before the next one starts.
#[derive(Clone, Debug)]
pub struct Path<const N: usize> {
    waiting: Deque<Planned<N>, QUEUE>,
    current: Option<Planned<N>>,
    progress: Progress,
    command: [Position; N],
    /// Where the last planned block ends: the start of the next one.
    planned_to: [Position; N],
    rate_hz: f64,
}

impl<const N: usize> Path<N> {
    /// A path without blocks that stands at `start`, with a command every 1/`rate_hz`.
    #[must_use]
    pub fn new(start: [Position; N], rate_hz: f64) -> Self {
        Self {
            waiting: Deque::new(),
            current: None,
            progress: Progress::default(),
            command: start,
            planned_to: start,
            rate_hz,
        }
    }

    /// Plans a block and puts it at the end of the queue. Not part of a tick.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong; the path is unchanged.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        let planned = Planned::new(block, self.planned_to, self.rate_hz)?;
        self.waiting.push_back(planned).map_err(|_| PathError::QueueFull)?;
        self.planned_to = planned.end();
        Ok(())
    }

    /// Whether another block would find a place.
    #[must_use]
    pub fn has_room(&self) -> bool {
        !self.waiting.is_full()
    }

    /// Whether every block has been travelled.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.current.is_none() && self.waiting.is_empty()
    }

    /// The command that [`Path::advance`] gave last.
    #[must_use]
    pub const fn command(&self) -> [Position; N] {
        self.command
    }

    /// Forgets every block and stands at a place.
    pub fn stand_at(&mut self, place: [Position; N]) {
        *self = Self::new(place, self.rate_hz);
    }

    /// Goes one tick on.
    pub fn advance(&mut self) -> [Position; N] {
        if self.current.is_none() {
            self.current = self.waiting.pop_front();
            self.progress = Progress::default();
        }
        if let Some(block) = &self.current {
            let (command, ended) = block.advance(&mut self.progress);
            self.command = command;
            if ended {
                self.current = None;
            }
        }
        self.command
    }
}
