//! The axes of a path that follow counters.

use crate::interpolate::following::Ending;
use crate::interpolate::following::follower::Follower;

/// The axes that follow counters.
#[derive(Clone, Debug)]
pub(super) struct Followers<const N: usize> {
    pub axes: [Option<Follower>; N],
    /// The counters of the inputs.
    pub counts: [u32; N],
    /// The first axis that has ended its following by itself, until it is taken.
    pub ended: Option<(usize, Ending)>,
}

impl<const N: usize> Followers<N> {
    pub const NONE: Self = Self { axes: [None; N], counts: [0; N], ended: None };

    /// Each decelerates.
    pub fn stop(&mut self) {
        self.axes.iter_mut().flatten().for_each(Follower::stop);
    }
}
