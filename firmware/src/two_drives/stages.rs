//! The signals of both power stages.
//!
//! The pulse is at the end of the period, and a direction pin is set in the first microsecond of the period in which its duty takes
//! effect: direction and pulse match for any duty.

use shared::drive::{DriveSignal, Duty};

use super::Registers;
use crate::setup::AXES;

/// Both power stages.
pub struct Stages {
    full_counts: u16,
    enabled: bool,
    /// Directions of the duties that take effect in the next period.
    reverse: [bool; AXES],
}

impl Stages {
    /// Stages that are off, with `full_counts` PWM counts of full duty.
    pub const fn new(full_counts: u16) -> Self {
        Self { full_counts, enabled: false, reverse: [false; AXES] }
    }

    /// Sets the directions that belong to the duties of this period. To be called at its start.
    pub fn begin_period(&self, registers: &mut impl Registers) {
        registers.set_directions(self.reverse);
    }

    /// Sets the inputs of the drives. Pulses and directions are those of the next period, because the compare registers are
    /// buffered; an analogue output changes at once.
    pub fn set(&mut self, registers: &mut impl Registers, signals: [DriveSignal; AXES]) {
        for (axis, (signal, next)) in signals.into_iter().zip(&mut self.reverse).enumerate() {
            let Duty { reverse, counts } = match signal {
                DriveSignal::Pwm(pulse) | DriveSignal::Steps { pulse, .. } => pulse,
                DriveSignal::Analog(counts) => {
                    registers.set_analog(axis, counts);
                    Duty::default()
                }
            };
            *next = reverse;
            registers.set_compare(axis, self.full_counts.saturating_sub(counts));
        }
    }

    /// Enables or disables the stages immediately.
    pub fn set_enabled(&mut self, registers: &mut impl Registers, enabled: bool) {
        if enabled != self.enabled {
            registers.set_outputs(enabled);
            self.enabled = enabled;
        }
    }
}
