//! A stop along the path: it decelerates, at least as planned, and discards nothing until it stands.

use super::super::fraction::{FRACTION, whole};
use super::brake::Brake;
use super::{Course, Path, QUEUE};

impl<const N: usize> Path<N> {
    /// Starts a stop along the path with a deceleration (per tick² with 16 fraction bits), or that of the block at the present
    /// override if it is greater, so that the path never ends later than planned. Joints that are passed during the stop add at most the same
    /// acceleration again.
    pub fn brake(&mut self, deceleration: u64) {
        if self.is_braking() {
            return;
        }
        if self.follows() {
            self.followers.stop();
            self.course = Course::StoppingFollowers;
            return;
        }
        let moving = self.started.then_some((self.progress.distance(), self.progress.speed()));
        let (distance, speed) = moving.unwrap_or_default();
        let speed = self.feed_hold.scaled(speed);
        self.revision = self.revision.wrapping_add(1);
        let distance = i128::from(distance) << FRACTION;
        self.course = Course::Braking(Brake { deceleration, speed, distance });
    }

    /// Whether a stop was started, and the path has not been discarded since.
    #[must_use]
    pub const fn is_braking(&self) -> bool {
        matches!(self.course, Course::Braking(_) | Course::StoppingFollowers)
    }

    /// Whether a stop was started and the command is at rest.
    #[must_use]
    pub fn has_stopped(&self) -> bool {
        let stands = match self.course {
            Course::Planned | Course::Following => false,
            Course::Braking(brake) => brake.speed == 0,
            Course::StoppingFollowers => !self.do_followers_move(),
        };
        stands && self.is_settled()
    }

    /// Advances the position on the path by a tick of a stop. Whether it has changed.
    // Not inlined, as other cases that are rare: the usual one then has more registers.
    #[cold]
    #[inline(never)]
    pub(super) fn follow_braking(&mut self, brake: Brake) -> bool {
        let before = self.position;
        self.course = Course::Braking(self.braked(brake));
        self.position != before
    }

    /// A stop after another tick.
    fn braked(&mut self, mut brake: Brake) -> Brake {
        let Some(block) = self.blocks.front() else { return Brake { speed: 0, ..brake } };
        let planned = self.feed_hold.stop_acceleration(block.acceleration());
        brake.speed = brake.speed.saturating_sub(brake.deceleration.max(planned));
        brake.distance += i128::from(brake.speed) << (FRACTION - 16);
        // Every block of the queue may end within a tick.
        for _ in 0..QUEUE {
            let Some(block) = self.blocks.front() else { break };
            let beyond = brake.distance - (i128::from(block.length()) << FRACTION);
            if beyond < 0 {
                let _ = block.set_to(&mut self.position, whole(brake.distance));
                return brake;
            }
            self.position = block.end();
            self.revision = self.revision.wrapping_add(1);
            if block.exit == 0 {
                break;
            }
            brake.distance = beyond;
            let _ = self.blocks.pop_front();
        }
        Brake { speed: 0, ..brake }
    }
}
