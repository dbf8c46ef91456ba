//! The queue of planned blocks, how fast they pass into each other, and the place that has been reached.

use heapless::Deque;

use super::block::Block;
use super::error::PathError;
use super::fraction::{FRACTION, whole};
use super::joint::Joint;
use super::planned::{Planned, Progress};
use super::profile::Step;
use super::ramp::TICK;
use super::smooth::{self, Filters, Smoothing};
use crate::units::Position;

/// Blocks that the queue holds, the one that is being travelled among them.
pub const QUEUE: usize = 16;

/// A path through N axes, and the filter of each axis behind it.
#[derive(Clone, Debug)]
pub struct Path<const N: usize> {
    blocks: Deque<Planned<N>, QUEUE>,
    /// How far the first block has come, once it has been started.
    progress: Progress,
    started: bool,
    braking: Option<Brake>,
    /// The place on the path, and where the filters have brought the command behind it.
    place: [Position; N],
    command: [Position; N],
    filters: Filters<N>,
    behind: [smooth::State; N],
    /// Where the last planned block ends: the start of the next one.
    planned_to: [Position; N],
    rate_hz: f64,
    /// Least and greatest command of each axis.
    travel: [[Position; 2]; N],
}

/// A stop along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Brake {
    /// Per tick² with 16 fraction bits.
    deceleration: u64,
    /// Per tick with 16 fraction bits.
    speed: u64,
    /// Along the first block, position units with 64 fraction bits.
    distance: i128,
}

impl<const N: usize> Path<N> {
    /// A path without blocks or a rate that stands at zero: what a static holds until [`Path::reset`].
    pub const AT_ZERO: Self = Self {
        blocks: Deque::new(),
        progress: Progress::NONE,
        started: false,
        braking: None,
        place: [Position(0); N],
        command: [Position(0); N],
        filters: Filters::PASS,
        behind: [const { smooth::State::at(Position(0)) }; N],
        planned_to: [Position(0); N],
        rate_hz: 0.0,
        travel: [[Position(i64::MIN), Position(i64::MAX)]; N],
    };

    /// A path without blocks that stands at `start`, with a command every 1/`rate_hz`.
    #[must_use]
    pub fn new(start: [Position; N], rate_hz: f64) -> Self {
        let mut path = Self::AT_ZERO;
        path.reset(&start, rate_hz, Filters::PASS);
        path
    }

    /// Puts filters behind the path; to be done while it has no blocks.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong with one; the path is unchanged.
    pub fn smooth(&mut self, smoothing: &[Smoothing; N]) -> Result<(), PathError> {
        self.filters = Filters::new(smoothing, self.rate_hz)?;
        Ok(())
    }

    /// Makes it the path of another machine, without blocks, in place: a path is large.
    pub fn reset(&mut self, start: &[Position; N], rate_hz: f64, filters: Filters<N>) {
        self.stand_at(start);
        (self.rate_hz, self.filters, self.travel) = (rate_hz, filters, Self::AT_ZERO.travel);
    }

    /// Blocks pushed from now on must not lead out of this travel (least and greatest command of each axis), nor
    /// further out than where they start.
    pub const fn keep_within(&mut self, travel: [[Position; 2]; N]) {
        self.travel = travel;
    }

    /// Plans a block, puts it at the end of the queue and lets those before it pass into it. Not part of a
    /// tick. A block that is being travelled already stops at its end if it was to do so.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong; the path is unchanged.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        let mut planned = Planned::new(block, self.planned_to, self.rate_hz, &self.filters.rounding)?;
        self.stays_within_travel(&planned)?;
        if self.blocks.is_full() {
            return Err(PathError::QueueFull);
        }
        let started = usize::from(self.started);
        let waits = self.blocks.len() > started;
        if let Some(last) = self.blocks.back_mut().filter(|_| waits) {
            planned.enters = last.joint_with(&planned, &self.filters.rounding);
            last.leaves = planned.enters;
        }
        self.planned_to = planned.end();
        let _ = self.blocks.push_back(planned);
        if !self.look_ahead() {
            self.stop_before_last();
            let _ = self.look_ahead();
        }
        Ok(())
    }

    fn stays_within_travel(&self, block: &Planned<N>) -> Result<(), PathError> {
        let axes = block.extent().into_iter().zip(self.travel).zip(self.planned_to);
        for (axis, (([least, greatest], [lower, upper]), start)) in (0..).zip(axes) {
            if least < lower.min(start) || greatest > upper.max(start) {
                return Err(PathError::BeyondTravel { axis });
            }
        }
        Ok(())
    }

    /// Finds the speeds at the joints: backwards, so that each block can slow down to the next, then forwards,
    /// so that each can speed up from the one before.
    ///
    /// False, with nothing changed, where the block that is entered next cannot be: what the last joint takes of
    /// its acceleration would leave too little.
    fn look_ahead(&mut self) -> bool {
        let started = usize::from(self.started);
        let mut entries = [0; QUEUE + 1];
        let mut exit = 0;
        for (entry, block) in entries.iter_mut().zip(&self.blocks).skip(started).rev() {
            *entry = block.reachable(exit, block.enters.speed);
            exit = *entry;
        }
        let mut entry = self.blocks.front().filter(|_| started > 0).map_or(0, |block| block.exit);
        if exit < entry {
            return false;
        }
        for (most, block) in entries[1..].iter().skip(started).zip(self.blocks.iter_mut().skip(started)) {
            let exit = block.reachable(entry, *most);
            block.pass(entry, exit);
            entry = exit;
        }
        true
    }

    /// Takes the last joint back.
    fn stop_before_last(&mut self) {
        let mut last = self.blocks.iter_mut().rev();
        if let Some(block) = last.next() {
            block.enters = Joint::default();
        }
        if let Some(block) = last.next() {
            block.leaves = Joint::default();
        }
    }

    /// Whether another block would find a place.
    #[must_use]
    pub fn has_room(&self) -> bool {
        !self.blocks.is_full()
    }

    /// Whether every block has been travelled, and the command stands on the end of the last.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.blocks.is_empty() && self.is_settled()
    }

    fn is_settled(&self) -> bool {
        !self.filters.smooth
            || self.behind.iter().zip(&self.filters.axes).all(|(behind, filter)| behind.is_settled(filter))
    }

    /// The command that [`Path::advance`] gave last.
    #[must_use]
    pub const fn command(&self) -> [Position; N] {
        self.command
    }

    /// Forgets every block and stands at a place.
    pub fn stand_at(&mut self, place: &[Position; N]) {
        self.blocks.clear();
        self.started = false;
        self.braking = None;
        (self.place, self.command, self.planned_to) = (*place, *place, *place);
        for (behind, place) in self.behind.iter_mut().zip(place) {
            behind.stand_at(*place);
        }
    }

    /// Starts a stop along the path with a deceleration, per tick² with 16 fraction bits, or with that of
    /// the block where that is more: so that the path ends no later than planned. What joints on the way take comes
    /// on top of it, at most as much again.
    pub fn brake(&mut self, deceleration: u64) {
        if self.braking.is_some() {
            return;
        }
        let moving = self.started.then_some((self.progress.distance(), self.progress.speed()));
        let (distance, speed) = moving.unwrap_or_default();
        self.braking = Some(Brake { deceleration, speed, distance: i128::from(distance) << FRACTION });
    }

    /// Whether a stop has been asked for and the command stands.
    #[must_use]
    pub fn has_stopped(&self) -> bool {
        self.braking.is_some_and(|brake| brake.speed == 0) && self.is_settled()
    }

    /// Goes one tick on.
    pub fn advance(&mut self) -> [Position; N] {
        match self.braking {
            None => self.along(),
            Some(brake) => self.braking = Some(self.along_braking(brake)),
        }
        if self.filters.smooth {
            for (((command, behind), filter), place) in
                self.command.iter_mut().zip(&mut self.behind).zip(&self.filters.axes).zip(self.place)
            {
                *command = behind.step(filter, place);
            }
        } else {
            self.command = self.place;
        }
        self.command
    }

    /// The place on the path a tick further on.
    fn along(&mut self) {
        let Some(block) = self.blocks.front() else { return };
        if !self.started {
            if block.entry == 0 && !self.is_settled() {
                return;
            }
            block.start(&mut self.progress);
            self.started = true;
        }
        match block.advance(&mut self.progress, TICK) {
            Step::Within(distance) => self.place = block.at(distance),
            Step::Beyond(rest) => self.over_joint(rest),
        }
    }

    /// The same where a block has ended within the tick: the next one gets the rest of it, unless the path stops
    /// there.
    #[cold]
    fn over_joint(&mut self, mut rest: u64) {
        self.started = false;
        for _ in 0..QUEUE {
            let Some(ended) = self.blocks.front() else { return };
            self.place = ended.end();
            let stops = ended.exit == 0;
            let _ = self.blocks.pop_front();
            let Some(block) = self.blocks.front().filter(|_| !stops) else { return };
            block.start(&mut self.progress);
            self.started = true;
            match block.advance(&mut self.progress, rest) {
                Step::Within(distance) => {
                    self.place = block.at(distance);
                    return;
                }
                Step::Beyond(left) => rest = left,
            }
            self.started = false;
        }
    }

    /// The same with a speed that falls to nothing.
    fn along_braking(&mut self, mut brake: Brake) -> Brake {
        let Some(block) = self.blocks.front() else { return Brake { speed: 0, ..brake } };
        brake.speed = brake.speed.saturating_sub(brake.deceleration.max(block.acceleration()));
        brake.distance += i128::from(brake.speed) << (FRACTION - 16);
        // As many blocks as the queue holds may end within a tick.
        for _ in 0..QUEUE {
            let Some(block) = self.blocks.front() else { break };
            let beyond = brake.distance - (i128::from(block.length()) << FRACTION);
            if beyond < 0 {
                self.place = block.at(whole(brake.distance));
                return brake;
            }
            self.place = block.end();
            if block.exit == 0 {
                break;
            }
            brake.distance = beyond;
            let _ = self.blocks.pop_front();
        }
        Brake { speed: 0, ..brake }
    }
}
