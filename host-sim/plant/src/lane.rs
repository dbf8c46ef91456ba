//! One axis in a register, or two axes beside each other in one.
//!
//! What an axis does in a step waits for itself nearly all the time, and no axis waits for another. The same step,
//! written once over [`Lane`], moves one axis as `f64` and two at the price of one as `f64x2`, with the same bits.

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

use wide::f64x2;

/// A value of as many axes as a register holds.
pub trait Lane:
    Copy + Debug + Default + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// The value of each axis, by its number in the register.
    fn of(value: impl FnMut(usize) -> f64) -> Self;

    /// The value of one axis.
    fn lane(self, axis: usize) -> f64;

    /// Without the sign.
    #[must_use]
    fn abs(self) -> Self;

    /// One over it.
    #[must_use]
    fn recip(self) -> Self;

    /// The same for all axes.
    #[must_use]
    #[inline]
    fn all(value: f64) -> Self {
        Self::of(|_| value)
    }
}

impl Lane for f64 {
    #[inline]
    fn of(mut value: impl FnMut(usize) -> f64) -> Self {
        value(0)
    }

    #[inline]
    fn lane(self, _axis: usize) -> f64 {
        self
    }

    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline]
    fn recip(self) -> Self {
        self.recip()
    }
}

impl Lane for f64x2 {
    #[inline]
    fn of(mut value: impl FnMut(usize) -> f64) -> Self {
        Self::new([value(0), value(1)])
    }

    #[inline]
    fn lane(self, axis: usize) -> f64 {
        self.to_array()[axis]
    }

    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline]
    fn recip(self) -> Self {
        // A division, so that it is the same as that of one axis.
        Self::ONE / self
    }
}
