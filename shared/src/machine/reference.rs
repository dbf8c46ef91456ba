//! Which axes know their absolute position, and what is held off on the others.
//!
//! | while an axis is not homed | |
//! |---|---|
//! | blocks of a program | refused ([`PathError::NotHomed`](crate::interpolate::PathError::NotHomed)) if the axis has soft limits; without soft limits, positions are relative to those at power-up |
//! | jogs and homing ([`Machine::jog`](super::Machine::jog)) | allowed |
//! | soft limits | not monitored: limit switches end the travel |
//! | compensations that depend on its position ([`Dependence`]) | held off, and applied at their limited rates when it is homed |
//! | backlash, reversal, drift, constant force model | applied |

use crate::compensate::{CompensationKind, Dependence};

/// Whether the positions of an axis are absolute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Reference {
    /// Relative to the position at power-up.
    Relative,
    /// From the origin of the machine.
    Homed,
}

/// References and switched compensations of all axes.
#[derive(Clone, Debug)]
pub(super) struct References<const N: usize> {
    axes: [Reference; N],
    dependence: [Dependence; N],
    /// One bit for each kind that is switched off by the user.
    off: [u16; N],
}

impl<const N: usize> References<N> {
    /// Every axis homed, no compensation.
    pub const NEW: Self =
        Self { axes: [Reference::Homed; N], dependence: [Dependence::NONE; N], off: [0; N] };

    pub fn of(&self, axis: usize) -> Option<Reference> {
        self.axes.get(axis).copied()
    }

    pub fn set(&mut self, axis: usize, reference: Reference) {
        if let Some(slot) = self.axes.get_mut(axis) {
            *slot = reference;
        }
    }

    pub fn set_dependence(&mut self, axis: usize, dependence: Dependence) {
        if let Some(slot) = self.dependence.get_mut(axis) {
            *slot = dependence;
        }
    }

    /// The switch of the user.
    pub fn switch(&mut self, axis: usize, kind: CompensationKind, on: bool) {
        if let Some(off) = self.off.get_mut(axis) {
            let bit = 1 << kind as u16;
            *off = if on { *off & !bit } else { *off | bit };
        }
    }

    /// Whether an axis that a compensation depends on is not homed.
    pub fn is_held(&self, axis: usize, kind: CompensationKind) -> bool {
        let needed = self.dependence.get(axis).map_or(0, |dependence| dependence.on(kind));
        (0..N).any(|axis| needed & 1 << axis != 0 && self.of(axis) == Some(Reference::Relative))
    }

    /// Whether a compensation is applied.
    pub fn is_applied(&self, axis: usize, kind: CompensationKind) -> bool {
        let off = self.off.get(axis).is_some_and(|off| off & 1 << kind as u16 != 0);
        !off && !self.is_held(axis, kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compensate::CompensationSettings;

    /// The squareness of axis 2 depends on the position of axis 1 alone.
    #[test]
    fn a_compensation_waits_for_the_axis_that_it_depends_on() {
        let settings =
            CompensationSettings { squareness: Some((1, 1e-5)), ..CompensationSettings::default() };
        let mut references = References::<3>::NEW;
        references.set_dependence(2, Dependence::of(2, &settings));
        for (axis, is_held) in [(0, false), (1, true), (2, false)] {
            references.set(axis, Reference::Relative);
            assert_eq!(references.is_held(2, CompensationKind::Squareness), is_held, "{axis}");
            assert_eq!(references.is_applied(2, CompensationKind::Squareness), !is_held, "{axis}");
            assert!(!references.is_held(1, CompensationKind::Squareness));
            references.set(axis, Reference::Homed);
        }
    }
}
