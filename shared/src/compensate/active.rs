//! Which compensations of an axis are computed in a tick: those that it has and that are switched on.
//!
//! The list is made when a compensation is set or switched, so that a tick tests one bit for a compensation of several
//! operations. One that is a single product has no test: its factor is zero while it is off.

use super::kind::CompensationKind;
use crate::scalar::Scalar;

/// The active compensations of an axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active<S: Scalar> {
    /// One bit per kind, and [`MODEL`].
    bits: u32,
    /// Half the width of the backlash, error units.
    pub half_backlash: S,
    /// Deflection of the drive, error units per N.
    pub stretch: S::Gain,
    /// −k of the squareness: see [`super::geometry::Squareness`].
    pub squareness: S::Gain,
}

/// The axis has a force model. It is computed while the feed-forward is switched off too, for the stretch.
const MODEL: u32 = 1 << 31;

const fn bit(kind: CompensationKind) -> u32 {
    1 << kind as u32
}

impl<S: Scalar> Active<S> {
    /// No compensation.
    pub const NONE: Self =
        Self { bits: 0, half_backlash: S::ZERO, stretch: S::ZERO_GAIN, squareness: S::ZERO_GAIN };

    /// Lists kinds, one bit for each; the factors are zero.
    pub const fn listed(has_model: bool, kinds: u32) -> Self {
        let model = if has_model { MODEL } else { 0 };
        Self { bits: kinds | model, ..Self::NONE }
    }

    /// Whether a kind is computed.
    #[inline]
    pub const fn has(&self, kind: CompensationKind) -> bool {
        self.bits & bit(kind) != 0
    }

    /// Whether a correction is computed that few machines need: one test for all of them.
    #[inline]
    pub const fn has_rare(&self) -> bool {
        self.bits & (bit(CompensationKind::Screw) | bit(CompensationKind::Products)) != 0
    }

    /// Whether the force model is computed.
    #[inline]
    pub const fn has_model(&self) -> bool {
        self.bits & MODEL != 0
    }
}
