//! The enable switch: opening it acts at once, closing it only as a fresh, settled edge.
//!
//! A switch that is closed at power-up, or that a fault finds closed, enables nothing: it has to be seen
//! open and then closed, each for the settling time. So a contact that bounces while it opens
//! cannot acknowledge a fault and enable again.

/// What the operator has done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchEvent {
    /// Asked for the drives.
    Enable,
    /// Asked for them to be off; acknowledges a fault.
    Disable,
}

/// The switch, looked at once a tick.
#[derive(Clone, Copy, Debug)]
pub struct EnableSwitch {
    settling_ticks: u32,
    /// `None`: not looked at yet. An open switch that is found open has not been opened.
    closed: Option<bool>,
    /// Ticks for which the switch has stood as it stands.
    steady_ticks: u32,
    /// Whether it was open for the settling time since it last enabled.
    armed: bool,
}

impl EnableSwitch {
    /// A switch that has not been seen open yet, with a settling time in ticks.
    #[must_use]
    pub const fn new(settling_ticks: u32) -> Self {
        Self { settling_ticks, closed: None, steady_ticks: 0, armed: false }
    }

    /// Takes what the switch shows in this tick.
    pub fn look(&mut self, closed: bool) -> Option<SwitchEvent> {
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

    /// What a sequence of (closed, ticks) gives in the end and how often each turn came.
    fn turns(switch: &mut EnableSwitch, sequence: &[(bool, u32)]) -> (u32, u32) {
        let mut count = (0, 0);
        for &(closed, ticks) in sequence {
            for _ in 0..ticks {
                match switch.look(closed) {
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
        assert_eq!(turns(&mut switch, &[(true, 1000)]), (0, 0));
        assert_eq!(turns(&mut switch, &[(false, 20), (true, 1000)]), (1, 1));
    }

    /// What a fault of the run before left is acknowledged by an operator, not by a switch that was open all the time.
    #[test]
    fn a_switch_open_at_power_up_acknowledges_nothing() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(turns(&mut switch, &[(false, 1000)]), (0, 0));
        assert_eq!(turns(&mut switch, &[(true, 1000), (false, 1)]), (1, 1));
    }

    #[test]
    fn opens_at_once_and_closes_when_settled() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(turns(&mut switch, &[(false, 11), (true, 10)]), (0, 0));
        assert_eq!(switch.look(true), Some(SwitchEvent::Enable));
        assert_eq!(switch.look(true), None);
        assert_eq!(switch.look(false), Some(SwitchEvent::Disable));
    }

    #[test]
    fn a_bounce_while_opening_does_not_enable() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(turns(&mut switch, &[(false, 20), (true, 20)]), (1, 0));
        let bounce = [(false, 3), (true, 5), (false, 2), (true, 9), (false, 30)];
        assert_eq!(turns(&mut switch, &bounce), (0, 3));
    }

    #[test]
    fn a_spike_on_an_open_line_does_not_enable() {
        let mut switch = EnableSwitch::new(10);
        assert_eq!(turns(&mut switch, &[(false, 50), (true, 9), (false, 50)]).0, 0);
    }

    /// A change is seen in one look and has settled after as many more as were declared. Open for one look less arms
    /// nothing, however long the switch is closed then; nor do several such openings together.
    #[test]
    fn open_for_less_than_the_settling_time_does_not_arm() {
        for settling in [1, 2, 10, 400] {
            let mut switch = EnableSwitch::new(settling);
            let short = [(true, 3), (false, settling), (true, 3 * settling)];
            for times in 1..4 {
                assert_eq!(turns(&mut switch, &short).0, 0, "{settling}, the {times}th time");
            }
            assert_eq!(turns(&mut switch, &[(false, settling + 1), (true, settling)]), (0, 1));
            assert_eq!(switch.look(true), Some(SwitchEvent::Enable));
        }
    }
}
