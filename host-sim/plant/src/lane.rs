//! The values of one axis, or of two axes at once in one SIMD register.
//!
//! The operations of a step depend on each other, so a single axis leaves most of the processor's floating-point units
//! idle; two axes do not depend on each other. The step is written once over [`Lane`]: with `f64` it moves one axis,
//! with `f64x2` two axes in about the same time. Both give the same bits, since every lane computes the same IEEE
//! operations in the same order.

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

use wide::f64x2;

/// A quantity of every axis of a register.
pub trait Lane:
    Copy + Debug + Default + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    /// Collects one value per axis; `value` gets the number of the axis in the register, from 0.
    fn of(value: impl FnMut(usize) -> f64) -> Self;

    /// The value of one axis, by its number in the register.
    fn lane(self, axis: usize) -> f64;

    /// Absolute value of each axis.
    #[must_use]
    fn abs(self) -> Self;

    /// Reciprocal of each axis, correctly rounded.
    #[must_use]
    fn recip(self) -> Self;

    /// One value for all axes.
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
        // A division: `f64x2::recip` may be an approximation, and the result must be that of `f64`.
        Self::ONE / self
    }
}
