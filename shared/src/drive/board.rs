//! What a board has to provide.

use super::amplifier::Duty;
use crate::axis::Reading;

/// The world outside the controller, as a board sees it.
pub trait Board<const N: usize> {
    /// The sensors of every axis, now.
    fn readings(&mut self) -> [Reading; N];

    /// Whether the enable switch is closed. A broken wire must read as open.
    fn enable_switch_closed(&mut self) -> bool;

    /// Whether the hardware has cut the power stages by itself: emergency stop, or a fault of a stage. It stays true
    /// while the cause is there.
    fn hardware_stop_active(&mut self) -> bool;

    /// Sets PWM and direction of every axis for the next period of the PWM, both in the same one.
    fn set_duties(&mut self, duties: [Duty; N]);

    /// Enables the power stages or cuts them: on in every state in which there may be force, a stop along the path
    /// among them ([`Power::is_on`](crate::safety::Power::is_on)).
    fn set_enabled(&mut self, enabled: bool);

    /// Switches the light that shows faults and warnings ([`Light`]).
    fn set_light(&mut self, lit: bool);

    /// Whether the next tick is due already.
    fn next_tick_due(&mut self) -> bool;
}
