//! What a board has to provide.

use super::amplifier::Duty;
use super::inputs::Inputs;
use crate::feedback::Reading;

/// Sensors, drives and switches of N axes, with drives that take a `Signal` ([`super::output`]).
pub trait Board<const N: usize, Signal = Duty> {
    /// The present readings of all axes.
    fn readings(&mut self) -> [Reading; N];

    /// The present inputs. A broken wire must read as the active state of a limit switch, a drive fault, an emergency stop and a probe.
    /// Called before [`Board::readings`] in each tick. A board without such inputs keeps the default.
    fn inputs(&mut self) -> Inputs<N> {
        Inputs::NONE
    }

    /// Whether the enable switch is closed. A broken wire must read as open.
    fn enable_switch_closed(&mut self) -> bool;

    /// Whether the hardware has disabled the power stages: emergency stop, or a fault of a stage. True as long as the cause
    /// persists.
    fn hardware_stop_active(&mut self) -> bool;

    /// Sets the input of every drive. Pulse and direction take effect in the same PWM period, the next one.
    fn set_signals(&mut self, signals: [Signal; N]);

    /// Enables or disables the power stages. They are enabled in every state with force, including a stop along the path
    /// ([`Power::is_on`](crate::safety::Power::is_on)).
    fn set_enabled(&mut self, enabled: bool);

    /// Opens or closes the holding brakes of all axes that have one. Called behind [`Board::set_enabled`] in each tick; without supply,
    /// and with a broken wire, a brake has to be closed. A board without an output for brakes keeps the default.
    fn set_brakes_open(&mut self, _open: bool) {}

    /// Sets the status light ([`StatusLight`](super::status_light::StatusLight)).
    fn set_light(&mut self, lit: bool);

    /// Whether the next tick is already due.
    fn next_tick_due(&mut self) -> bool;

    /// Count at the start of this tick of a counter that runs freely over all 32 bits ([`TickClock`](super::tick_watch::TickClock)).
    /// A board without one keeps the default: lost interrupts are then not noticed.
    fn started_at(&mut self) -> Option<u32> {
        None
    }
}
