//! The enable switch: opening acts immediately, closing only as a new, debounced edge.
//!
//! A switch that is closed at power-up or when a fault occurs does not enable the drives: it must be read as open and then as
//! closed, each for the settling time. So a contact that bounces while it opens cannot acknowledge a fault and enable the
//! drives again.
//!
//! # Example
//!
//! ```
//! use shared::drive::{EnableSwitch, SwitchEvent};
//!
//! let mut switch = EnableSwitch::new(2);
//! let events = [false, false, true, true, true, false].map(|closed| switch.update(closed));
//! let (enable, disable) = (Some(SwitchEvent::Enable), Some(SwitchEvent::Disable));
//! assert_eq!(events, [None, None, None, None, enable, disable]);
//! ```

/// An operation of the switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchEvent {
    /// Enable the drives.
    Enable,
    /// Disable the drives, or acknowledge a fault.
    Disable,
}

/// The switch, sampled once per tick.
#[derive(Clone, Copy, Debug)]
pub struct EnableSwitch {
    settling_ticks: u32,
    /// Last sample; `None` before the first, so that a switch that is open at power-up is no operation.
    closed: Option<bool>,
    /// Ticks since the last change.
    steady_ticks: u32,
    /// Whether the switch has been open for the settling time since it last enabled.
    armed: bool,
}

impl EnableSwitch {
    /// A switch with a settling time in ticks, not armed.
    #[must_use]
    pub const fn new(settling_ticks: u32) -> Self {
        Self { settling_ticks, closed: None, steady_ticks: 0, armed: false }
    }

    /// Samples the switch, once per tick.
    pub fn update(&mut self, closed: bool) -> Option<SwitchEvent> {
        let changed = self.closed.replace(closed).is_some_and(|before| before != closed);
        self.steady_ticks = if changed { 0 } else { self.steady_ticks.saturating_add(1) };
        let settled = self.steady_ticks >= self.settling_ticks;
        if !closed {
            self.armed |= settled;
            return changed.then_some(SwitchEvent::Disable);
        }
        (settled && core::mem::take(&mut self.armed)).then_some(SwitchEvent::Enable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of enable and disable events in a sequence of (closed, ticks).
    fn events(switch: &mut EnableSwitch, sequence: &[(bool, u32)]) -> (u32, u32) {
        let mut count = (0, 0);
        for &(closed, ticks) in sequence {
            for _ in 0..ticks {
                match switch.update(closed) {
                    Some(SwitchEvent::Enable) => count.0 += 1,
                    Some(SwitchEvent::Disable) => count.1 += 1,
                    None => {}
                }
            }
        }
        count
    }

    #[test]
    fn a_switch_closed_at_power_up_enables_nothing() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(events(&mut switch, &[(true, 1000)]), (0, 0));
        assert_eq!(events(&mut switch, &[(false, 20), (true, 1000)]), (1, 1));
    }

    /// A fault of the previous run is acknowledged by an operation, not by a switch that was open all the time.
    #[test]
    fn a_switch_open_at_power_up_acknowledges_nothing() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(events(&mut switch, &[(false, 1000)]), (0, 0));
        assert_eq!(events(&mut switch, &[(true, 1000), (false, 1)]), (1, 1));
    }

    #[test]
    fn opens_at_once_and_closes_when_settled() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(events(&mut switch, &[(false, 11), (true, 10)]), (0, 0));
        assert_eq!(switch.update(true), Some(SwitchEvent::Enable));
        assert_eq!(switch.update(true), None);
        assert_eq!(switch.update(false), Some(SwitchEvent::Disable));
    }

    #[test]
    fn a_bounce_while_opening_does_not_enable() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(events(&mut switch, &[(false, 20), (true, 20)]), (1, 0));
        let bounce = [(false, 3), (true, 5), (false, 2), (true, 9), (false, 30)];
        assert_eq!(events(&mut switch, &bounce), (0, 3));
    }

    #[test]
    fn a_spike_on_an_open_line_does_not_enable() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(events(&mut switch, &[(false, 50), (true, 9), (false, 50)]).0, 0);
    }

    /// A change has settled when `settling` more samples agree with its first one. An opening that is one sample shorter does
    /// not arm the switch, however long it is closed afterwards; nor do several such openings.
    #[test]
    fn open_for_less_than_the_settling_time_does_not_arm() {
        for settling in [1, 2, 10, 400] {
            let mut switch = EnableSwitch::new(settling);
            let short = [(true, 3), (false, settling), (true, 3 * settling)];
            for times in 1..4 {
                assert_eq!(events(&mut switch, &short).0, 0, "{settling}, opening {times}");
            }
            assert_eq!(events(&mut switch, &[(false, settling + 1), (true, settling)]), (0, 1));
            assert_eq!(switch.update(true), Some(SwitchEvent::Enable));
        }
    }
}
