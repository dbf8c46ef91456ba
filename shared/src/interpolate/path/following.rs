//! Axes that follow counters: see [`following`](crate::interpolate::following).

use super::followers::Followers;
use super::{Course, Path};
use crate::interpolate::PathError;
use crate::interpolate::following::follower::Follower;
use crate::interpolate::following::{Ending, FollowError, FollowSettings};

impl<const N: usize> Path<N> {
    /// Lets an axis follow the counter of an input, which is at a count. `deceleration` is that of a stop, per tick² with 16 fraction bits. The
    /// other axes stand, or follow as well. No block is accepted until every axis has stopped to follow.
    ///
    /// # Errors
    /// [`FollowError`]; the path is unchanged.
    pub fn engage(
        &mut self,
        axis: usize,
        count: u32,
        settings: &FollowSettings,
        deceleration: u64,
    ) -> Result<(), FollowError> {
        let at_rest = self.course == Course::Planned && self.is_done();
        if !at_rest && self.course != Course::Following {
            return Err(FollowError::Moving);
        }
        let (Some(slot), Some(command), Some([least, greatest])) =
            (self.followers.axes.get_mut(axis), self.position.get(axis), self.travel.get(axis))
        else {
            return Err(FollowError::NoSuchAxis);
        };
        if slot.is_some() {
            return Err(FollowError::Engaged);
        }
        let counter = self.followers.counts.get_mut(usize::from(settings.input));
        let counter = counter.ok_or(FollowError::NoCounter)?;
        if command < least || command > greatest {
            let axis = u8::try_from(axis).unwrap_or(u8::MAX);
            return Err(PathError::BeyondTravel { axis }.into());
        }
        *slot = Some(Follower::new(settings, count, *command, self.rate_hz, deceleration)?);
        *counter = count;
        self.course = Course::Following;
        self.revision = self.revision.wrapping_add(1);
        Ok(())
    }

    /// Sets the present counts of the inputs. An input without a counter keeps its last one.
    pub fn set_counters(&mut self, counts: [Option<u32>; N]) {
        for (slot, count) in self.followers.counts.iter_mut().zip(counts) {
            *slot = count.unwrap_or(*slot);
        }
    }

    /// Whether axes follow counters, or decelerate from that.
    #[inline]
    #[must_use]
    pub const fn follows(&self) -> bool {
        matches!(self.course, Course::Following | Course::StoppingFollowers)
    }

    /// Whether the next command is that of the blocks, or of rest: neither a stop along the blocks nor axes that follow counters.
    #[inline]
    #[must_use]
    pub const fn is_planned(&self) -> bool {
        matches!(self.course, Course::Planned)
    }

    /// How far an axis that follows a counter is from its setpoint, position units; `None`: it does not follow.
    #[must_use]
    pub fn following_lag(&self, axis: usize) -> Option<i64> {
        let follower = self.followers.axes.get(axis)?.as_ref()?;
        self.position.get(axis).map(|command| follower.lag(*command))
    }

    /// The axis that has ended its following by itself since the last call, and why.
    pub const fn take_ended(&mut self) -> Option<(usize, Ending)> {
        self.followers.ended.take()
    }

    /// Whether an axis that follows, or decelerates from that, may move.
    pub(super) fn do_followers_move(&self) -> bool {
        self.follows() && self.followers.axes.iter().any(Option::is_some)
    }

    /// Advances the axes that follow by a tick. Whether one may have moved.
    // Not inlined, as a stop: the usual case then has more registers.
    #[cold]
    #[inline(never)]
    pub(super) fn follow_counters(&mut self) -> bool {
        let Followers { axes, counts, ended } = &mut self.followers;
        let places = self.position.iter_mut().zip(self.travel);
        for ((index, slot), (position, travel)) in axes.iter_mut().enumerate().zip(places) {
            let Some(follower) = slot else { continue };
            let count = counts.get(usize::from(follower.input())).copied().unwrap_or_default();
            if let Some(ending) = follower.step(count, position, travel) {
                *ended = ended.or(Some((index, ending)));
            }
            if follower.has_stopped() {
                *slot = None;
            }
        }
        if self.course == Course::Following && axes.iter().all(Option::is_none) {
            self.course = Course::Planned;
        }
        self.planned_end = self.position;
        true
    }

    /// Ends every following.
    pub(super) const fn end_followers(&mut self) {
        self.followers = Followers::NONE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpolate::Block;
    use crate::units::Position;

    const SETTINGS: FollowSettings = FollowSettings {
        input: 0,
        distance_m: 5e-3,
        counts: 4000,
        speed_m_per_s: 0.05,
        acceleration_m_per_s2: 2.0,
        lag_m: 10e-3,
    };

    fn path() -> Path<2> {
        Path::new([Position(0); 2], 4000.0)
    }

    /// From rest only, and while others follow; within the travel, its ends included.
    #[test]
    fn an_axis_engages_at_rest_within_its_travel() {
        let mut moving = path();
        moving.push(&Block::line([0.01, 0.0], 0.1, 1.0)).unwrap();
        assert_eq!(moving.engage(0, 7, &SETTINGS, 1 << 20), Err(FollowError::Moving));
        let mut second = path();
        assert!(
            second.is_planned() && second.engage(0, 7, &SETTINGS, 1 << 20).is_ok() && !second.is_planned()
        );
        assert_eq!(second.engage(0, 7, &SETTINGS, 1 << 20), Err(FollowError::Engaged));
        assert!(second.engage(1, 7, &SETTINGS, 1 << 20).is_ok());
        second.brake(1 << 20);
        assert_eq!(second.engage(1, 7, &SETTINGS, 1 << 20), Err(FollowError::Moving));
        for ([least, greatest], is_within) in
            [([0, 100], true), ([-100, 0], true), ([1, 100], false), ([-100, -1], false)]
        {
            let mut path = path();
            path.set_travel([[Position(least), Position(greatest)]; 2]);
            let error = FollowError::from(PathError::BeyondTravel { axis: 1 });
            let expected = if is_within { Ok(()) } else { Err(error) };
            assert_eq!(path.engage(1, 7, &SETTINGS, 1 << 20), expected, "{least} {greatest}");
        }
    }
}
