//! Limit switches: motion further onto an active switch is a fault, the way back is not.

use super::inputs::AxisInputs;
use crate::units::Position;

/// The commands of the last tick.
#[derive(Clone, Copy, Debug)]
pub struct LimitGuard<const N: usize> {
    last: [Position; N],
}

impl<const N: usize> LimitGuard<N> {
    /// With commands at zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { last: [Position(0); N] }
    }

    /// Continues after the command of an axis has been shifted.
    pub fn shift(&mut self, axis: usize, distance: i64) {
        if let Some(last) = self.last.get_mut(axis) {
            *last += distance;
        }
    }

    /// For each axis, whether its command has moved further onto an active switch since the last call, once per tick.
    pub fn moves_onto_switch(&mut self, inputs: &[AxisInputs; N], commands: &[Position; N]) -> [bool; N] {
        let mut onto = [false; N];
        for (((onto, last), input), command) in onto.iter_mut().zip(&mut self.last).zip(inputs).zip(commands)
        {
            let [negative, positive] = input.limits;
            let moved = *command - *last;
            *onto = negative && moved < 0 || positive && moved > 0;
            *last = *command;
        }
        onto
    }
}

impl<const N: usize> Default for LimitGuard<N> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_motion_further_onto_the_switch_counts() {
        let mut guard = LimitGuard::<1>::new();
        let mut onto = |limits, command| {
            let [onto] =
                guard.moves_onto_switch(&[AxisInputs { limits, ..AxisInputs::NONE }], &[Position(command)]);
            onto
        };
        let (negative, positive, none) = ([true, false], [false, true], [false, false]);
        assert!(!onto(none, 100) && onto(positive, 101));
        // At rest on the switch, and back.
        assert!(!onto(positive, 101) && !onto(positive, 90));
        assert!(onto(negative, 89) && !onto(negative, 89) && !onto(negative, 95));
        assert!(!onto(none, -5));
        // Both switches active, such as with a broken cable: no direction is open.
        assert!(onto([true, true], -4) && onto([true, true], -5) && !onto([true, true], -5));
    }

    /// An origin that is set while the axis stands on a switch is no motion.
    #[test]
    fn a_shifted_command_is_no_motion() {
        let mut guard = LimitGuard::<1>::new();
        let inputs = [AxisInputs { limits: [true, true], ..AxisInputs::NONE }];
        guard.shift(0, 1000);
        assert_eq!(guard.moves_onto_switch(&inputs, &[Position(1000)]), [false]);
        assert_eq!(guard.moves_onto_switch(&inputs, &[Position(0)]), [true]);
    }
}
