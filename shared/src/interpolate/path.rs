//! The path: the queue of planned blocks, look-ahead over their joints, and the position that has been reached.

mod brake;
mod feed;
mod followers;
mod following;
mod queue_copy;
mod second_motors;
mod stop;

use heapless::Deque;

use brake::Brake;
use followers::Followers;
use second_motors::SecondMotors;

use super::block::Block;
use super::error::PathError;
use super::feed_hold::FeedHold;
use super::joint::JointLimits;
use super::planned::{PlannedBlock, Progress};
use super::profile::Step;
use super::ramp::TICK;
use super::smooth::state::State as FilterState;
use super::smooth::{Filters, Smoothing};
use crate::units::Position;

/// Capacity of the queue in blocks, including the one that is running.
pub const QUEUE: usize = 16;

/// A path through N axes, with a filter per axis behind it.
// In this order: an instruction reaches the first 1 KiB.
#[repr(C)]
#[derive(Clone, Debug)]
pub struct Path<const N: usize> {
    started: bool,
    feed_hold: FeedHold,
    course: Course,
    /// Progress of the first block, if `started`.
    progress: Progress,
    /// Position on the path, before the filters.
    position: [Position; N],
    /// Changes with every change of the queue, so that a copy of it is known to be out of date.
    revision: u32,
    /// End of the last block in the queue.
    planned_end: [Position; N],
    rate_hz: f64,
    /// Least and greatest command of each axis.
    travel: [[Position; 2]; N],
    /// Whether a limit switch blocks motion in the negative and in the positive direction.
    blocked: [[bool; 2]; N],
    filters: Filters<N>,
    filter_state: FilterState<N>,
    blocks: Deque<PlannedBlock<N>, QUEUE>,
    /// The axes that follow counters, in the courses of that name.
    followers: Followers<N>,
    second_motors: SecondMotors<N>,
}

/// What the next command is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    /// The blocks of the queue, or rest.
    Planned,
    /// A stop along the blocks.
    Braking(Brake),
    /// Axes follow counters, or decelerate from that.
    Following,
    /// Axes that followed counters stop, and the path is discarded then.
    StoppingFollowers,
}

impl<const N: usize> Path<N> {
    /// An empty path at zero without a rate, for a static that is initialised by [`Path::reset`].
    pub const AT_ZERO: Self = Self {
        blocks: Deque::new(),
        progress: Progress::NONE,
        started: false,
        course: Course::Planned,
        feed_hold: FeedHold::RUNNING,
        revision: 0,
        position: [Position(0); N],
        filters: Filters::PASS,
        filter_state: FilterState::AT_ZERO,
        planned_end: [Position(0); N],
        rate_hz: 0.0,
        travel: [[Position(i64::MIN), Position(i64::MAX)]; N],
        blocked: [[false; 2]; N],
        followers: Followers::NONE,
        second_motors: SecondMotors::NONE,
    };

    /// An empty path at `start` with a command every 1/`rate_hz`.
    #[must_use]
    pub fn new(start: [Position; N], rate_hz: f64) -> Self {
        let mut path = Self::AT_ZERO;
        path.reset(&start, rate_hz, Filters::PASS);
        path
    }

    /// Sets the axis filters. To be called while the path is empty.
    ///
    /// # Errors
    /// [`PathError`] with [`Field::Smoothing`](super::Field::Smoothing); the path is unchanged.
    pub fn smooth(&mut self, smoothing: &[Smoothing; N]) -> Result<(), PathError> {
        self.filters = Filters::new(smoothing, self.rate_hz)?;
        Ok(())
    }

    /// Resets to an empty path at `start`, in place: a path is large.
    pub fn reset(&mut self, start: &[Position; N], rate_hz: f64, filters: Filters<N>) {
        self.feed_hold = FeedHold::RUNNING;
        self.rest_at(start);
        (self.rate_hz, self.filters, self.travel) = (rate_hz, filters, Self::AT_ZERO.travel);
        self.blocked = [[false; 2]; N];
        self.second_motors = SecondMotors::NONE;
    }

    /// Sets the first motor of each axis that is the second motor of a gantry.
    pub const fn set_second_motors(&mut self, firsts: [Option<usize>; N]) {
        self.second_motors = SecondMotors { firsts };
    }

    /// Sets which limit switches are active: blocks that move an axis further onto one are rejected.
    pub const fn set_blocked(&mut self, blocked: [[bool; 2]; N]) {
        self.blocked = blocked;
    }

    /// Sets the travel (least and greatest command of each axis). Blocks that leave it from now on are rejected; a block that
    /// starts outside must not lead further out.
    pub const fn set_travel(&mut self, travel: [[Position; 2]; N]) {
        self.travel = travel;
    }

    /// Plans a block, appends it to the queue and plans the joints before it. Not part of a tick. A running block whose
    /// planned end is a stop keeps it.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong; the path is unchanged.
    pub fn push(&mut self, block: &Block<N>) -> Result<(), PathError> {
        self.push_holding(block, &[false; N])
    }

    /// [`Path::push`] of a block that must not move the axes in `not_homed`.
    ///
    /// # Errors
    /// [`PathError`], for such an axis [`PathError::NotHomed`]; the path is unchanged.
    pub fn push_holding(&mut self, block: &Block<N>, not_homed: &[bool; N]) -> Result<(), PathError> {
        let from = self.planned_end;
        let block = &self.second_motors.without(block, from);
        let mut planned = PlannedBlock::new(block, from, self.rate_hz, &self.filters.rounding)?;
        self.check_planned(&planned, from, not_homed)?;
        if self.blocks.is_full() {
            return Err(PathError::QueueFull);
        }
        self.revision = self.revision.wrapping_add(1);
        let started = usize::from(self.started);
        let waits = self.blocks.len() > started;
        if let Some(last) = self.blocks.back_mut().filter(|_| waits) {
            planned.entry_joint = last.joint_with(&planned, &self.filters.rounding);
            last.exit_joint = planned.entry_joint;
        }
        self.planned_end = planned.end();
        let _ = self.blocks.push_back(planned);
        if !self.look_ahead() {
            self.stop_before_last();
            let _ = self.look_ahead();
        }
        Ok(())
    }

    /// Checks a block as [`Path::push_holding`] does, for a start of its own, and that it moves no second motor of a gantry. Returns its end.
    ///
    /// # Errors
    /// The [`PathError`] that names what is wrong.
    pub fn check(
        &self,
        block: &Block<N>,
        start: [Position; N],
        not_homed: &[bool; N],
    ) -> Result<[Position; N], PathError> {
        self.second_motors.check(block, start)?;
        let block = &self.second_motors.without(block, start);
        let planned = PlannedBlock::new(block, start, self.rate_hz, &self.filters.rounding)?;
        self.check_planned(&planned, start, not_homed)?;
        Ok(planned.end())
    }

    fn check_planned(
        &self,
        block: &PlannedBlock<N>,
        from: [Position; N],
        not_homed: &[bool; N],
    ) -> Result<(), PathError> {
        for (axis, ([min, max], not_homed)) in (0..).zip(block.bounds().into_iter().zip(not_homed)) {
            if *not_homed && min != max {
                return Err(PathError::NotHomed { axis });
            }
        }
        self.check_travel(block, from)
    }

    fn check_travel(&self, block: &PlannedBlock<N>, from: [Position; N]) -> Result<(), PathError> {
        let blocked = self.second_motors.blocked(self.blocked);
        let axes = block.bounds().into_iter().zip(self.travel).zip(from).zip(blocked);
        for (axis, ((([min, max], [lower, upper]), start), [below, above])) in (0..).zip(axes) {
            if min < lower.min(start) || max > upper.max(start) {
                return Err(PathError::BeyondTravel { axis });
            }
            if below && min < start || above && max > start {
                return Err(PathError::LimitSwitch { axis });
            }
        }
        Ok(())
    }

    /// Look-ahead. Finds the speeds at the joints by a backward pass, in which each block can slow down to the next, and a
    /// forward pass, in which each can speed up from the previous one.
    ///
    /// False, with nothing changed, if the next block cannot be entered at the speed at which the running one leaves: the
    /// last joint would leave too little of its acceleration.
    fn look_ahead(&mut self) -> bool {
        let started = usize::from(self.started);
        let mut entries = [0; QUEUE + 1];
        let mut exit = 0;
        for (entry, block) in entries.iter_mut().zip(&self.blocks).skip(started).rev() {
            *entry = block.reachable(exit, block.entry_joint.speed);
            exit = *entry;
        }
        let mut entry = self.blocks.front().filter(|_| started > 0).map_or(0, |block| block.exit);
        if exit < entry {
            return false;
        }
        for (max, block) in entries[1..].iter().skip(started).zip(self.blocks.iter_mut().skip(started)) {
            let exit = block.reachable(entry, *max);
            block.set_end_speeds(entry, exit);
            entry = exit;
        }
        true
    }

    /// Makes the last joint a stop.
    fn stop_before_last(&mut self) {
        let mut last = self.blocks.iter_mut().rev();
        if let Some(block) = last.next() {
            block.entry_joint = JointLimits::default();
        }
        if let Some(block) = last.next() {
            block.exit_joint = JointLimits::default();
        }
    }

    /// Whether the queue has room for another block.
    #[must_use]
    pub fn has_room(&self) -> bool {
        !self.blocks.is_full()
    }

    /// Whether every block has ended and the command is at rest at the end of the last one.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.blocks.is_empty() && self.is_settled() && !self.do_followers_move()
    }

    fn is_settled(&self) -> bool {
        !self.filters.active || self.filter_state.is_settled(&self.filters, &self.position)
    }

    /// The last command.
    #[must_use]
    pub const fn command(&self) -> [Position; N] {
        *self.filter_state.outputs()
    }

    /// Discards every block and rests at a position. The override remains.
    pub fn rest_at(&mut self, position: &[Position; N]) {
        self.clear_queue();
        self.course = Course::Planned;
        self.feed_hold.rest();
        (self.position, self.planned_end) = (*position, *position);
        self.filter_state.rest_at(position);
    }

    fn clear_queue(&mut self) {
        self.blocks.clear();
        self.end_followers();
        self.started = false;
        self.revision = self.revision.wrapping_add(1);
    }

    /// The command of the next tick.
    #[inline]
    pub fn advance(&mut self) -> [Position; N] {
        self.step();
        self.command()
    }

    /// Whether a command since the last call was at the end of a segment of a speed ramp, which takes longer than others: the time
    /// for work that can wait.
    #[inline]
    pub const fn take_segment_end(&mut self) -> bool {
        self.progress.take_segment_end()
    }

    /// Advances by a tick.
    #[inline(never)]
    fn step(&mut self) {
        let moves = match self.course {
            Course::Planned => self.follow(),
            Course::Braking(brake) => self.follow_braking(brake),
            Course::Following | Course::StoppingFollowers => self.follow_counters(),
        };
        self.filter_state.step(&self.filters, &self.position, moves);
    }

    /// Advances the position on the path by a tick. Whether it may have changed.
    fn follow(&mut self) -> bool {
        if self.feed_hold.is_as_planned() { self.follow_by(TICK) } else { self.follow_at_rate() }
    }

    /// Advances by the time of a tick at the present rate. Curves are advanced by up to a tick at a time: an override above 100 % does so
    /// twice.
    #[cold]
    #[inline(never)]
    fn follow_at_rate(&mut self) -> bool {
        let mut time = self.feed_hold.advance();
        if time == 0 {
            if self.feed_hold.is_to_be_discarded() {
                self.discard_rest();
            }
            return false;
        }
        let mut moves = false;
        while time > 0 {
            let part = time.min(TICK);
            moves |= self.follow_by(part);
            time -= part;
        }
        moves
    }

    /// Advances by a time up to a tick, 32 fraction bits.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a call in every tick")]
    fn follow_by(&mut self, time: u64) -> bool {
        let Some(block) = self.blocks.front() else { return false };
        if !self.started {
            if block.entry == 0 && !self.is_settled() {
                return false;
            }
            block.start(&mut self.progress);
            self.started = true;
            self.revision = self.revision.wrapping_add(1);
        }
        match block.advance(&mut self.progress, time) {
            Step::Within(length) => block.set_to(&mut self.position, length),
            Step::Beyond(remaining) => {
                let before = self.position;
                self.cross_joint(remaining);
                self.position != before
            }
        }
    }

    /// Continues after a block has ended within the tick: the next block gets the remaining time, unless the path stops.
    #[cold]
    #[inline(never)]
    fn cross_joint(&mut self, mut remaining: u64) {
        self.started = false;
        self.revision = self.revision.wrapping_add(1);
        for _ in 0..QUEUE {
            let Some(ended) = self.blocks.front() else { return };
            self.position = ended.end();
            let stops = ended.exit == 0;
            let _ = self.blocks.pop_front();
            let Some(block) = self.blocks.front().filter(|_| !stops) else { return };
            block.start(&mut self.progress);
            self.started = true;
            match block.advance(&mut self.progress, remaining) {
                Step::Within(length) => {
                    let _ = block.set_to(&mut self.position, length);
                    return;
                }
                Step::Beyond(time) => remaining = time,
            }
            self.started = false;
        }
    }
}
