//! The second motors of gantries: a path has no coordinate for them.
//!
//! Their commands are added behind the path. In a block they have to stay where they are, and the limit switches at their end of the beam
//! are those of its first motor, too.

use crate::interpolate::block::{Block, Shape};
use crate::interpolate::error::PathError;
use crate::units::Position;

/// Distance by which the coordinate of a second motor in a block may differ from where it is, m: 1 nm, what rounding makes of it.
const ROUNDING_M: f64 = 1e-9;

/// The first motor of each axis that is a second one.
#[derive(Clone, Copy, Debug)]
pub(super) struct SecondMotors<const N: usize> {
    pub firsts: [Option<usize>; N],
}

impl<const N: usize> SecondMotors<N> {
    /// None.
    pub const NONE: Self = Self { firsts: [None; N] };

    /// The block with every second motor at its start.
    pub fn without(&self, block: &Block<N>, start: [Position; N]) -> Block<N> {
        let mut block = *block;
        if let Shape::Line { to_m } = &mut block.shape {
            for ((to_m, start), _) in self.seconds(to_m.iter_mut().zip(start)) {
                *to_m = start.to_m();
            }
        }
        block
    }

    /// Checks that a block from a start moves no second motor.
    ///
    /// # Errors
    /// [`PathError::SecondMotor`].
    pub fn check(&self, block: &Block<N>, start: [Position; N]) -> Result<(), PathError> {
        let moved = match block.shape {
            Shape::Dwell { .. } => None,
            Shape::Line { to_m } => self
                .seconds(to_m.into_iter().zip(start))
                .find(|((to_m, start), _)| {
                    let distance_m = libm::fabs(to_m - start.to_m());
                    distance_m.is_nan() || distance_m > ROUNDING_M
                })
                .map(|(_, axis)| axis),
            Shape::Arc { plane, .. } | Shape::ArcTo { plane, .. } => plane
                .into_iter()
                .find(|axis| self.firsts.get(usize::from(*axis)).is_some_and(Option::is_some)),
        };
        moved.map_or(Ok(()), |axis| Err(PathError::SecondMotor { axis }))
    }

    /// What belongs to the second motors, with their axes.
    fn seconds<T>(&self, of_axes: impl Iterator<Item = T>) -> impl Iterator<Item = (T, u8)> {
        of_axes.zip(0..).zip(self.firsts).filter_map(|(of_axis, first)| first.map(|_| of_axis))
    }

    /// Limit switches, with those of each second motor at its first.
    pub fn blocked(&self, mut blocked: [[bool; 2]; N]) -> [[bool; 2]; N] {
        for (second, first) in self.firsts.iter().enumerate() {
            let [below, above] = blocked.get(second).copied().unwrap_or_default();
            if let Some([first_below, first_above]) = first.and_then(|first| blocked.get_mut(first)) {
                (*first_below, *first_above) = (*first_below | below, *first_above | above);
            }
        }
        blocked
    }
}
