//! The last faults and warnings.

use heapless::Deque;
use serde::{Deserialize, Serialize};

use crate::safety::{Fault, Power};

/// Number of entries.
pub const HISTORY: usize = 16;

/// What has happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HistoryEvent {
    /// A fault that stops, or switches the drives off.
    Fault(Fault),
    /// A warning.
    Warning(Fault),
    /// The host was silent: the path was held.
    HostSilentHold,
    /// The host was silent while the axes stood: the drives were switched off.
    HostSilentOff,
}

/// An entry of the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HistoryEntry {
    /// Ticks since the start of the board.
    pub tick: u64,
    /// What has happened.
    pub event: HistoryEvent,
}

/// The last [`HISTORY`] faults and warnings.
#[derive(Clone, Debug, Default)]
pub struct FaultHistory {
    entries: Deque<HistoryEntry, HISTORY>,
    fault: Option<Fault>,
    warning: Option<Fault>,
}

impl FaultHistory {
    /// Without an entry.
    pub const EMPTY: Self = Self { entries: Deque::new(), fault: None, warning: None };

    /// Records what is new in a tick.
    #[inline]
    pub fn update(&mut self, tick: u64, power: Power, warning: Option<Fault>) {
        let fault = power.fault();
        if fault != self.fault {
            self.fault = fault;
            if let Some(fault) = fault {
                self.push(tick, HistoryEvent::Fault(fault));
            }
        }
        if warning != self.warning {
            self.warning = warning;
            if let Some(warning) = warning {
                self.push(tick, HistoryEvent::Warning(warning));
            }
        }
    }

    /// Records that the silence of the host has held the path.
    pub fn held(&mut self, tick: u64) {
        self.push(tick, HistoryEvent::HostSilentHold);
    }

    /// Records that the silence of the host has switched off drives whose axes stood.
    pub fn switched_off(&mut self, tick: u64) {
        self.push(tick, HistoryEvent::HostSilentOff);
    }

    /// Records a fault beside the one that the power state shows.
    pub fn fault(&mut self, tick: u64, fault: Fault) {
        self.push(tick, HistoryEvent::Fault(fault));
    }

    #[cold]
    fn push(&mut self, tick: u64, event: HistoryEvent) {
        if self.entries.is_full() {
            let _ = self.entries.pop_front();
        }
        let _ = self.entries.push_back(HistoryEntry { tick, event });
    }

    /// The entries, the newest first.
    pub fn newest_first(&self) -> impl Iterator<Item = HistoryEntry> {
        self.entries.iter().rev().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::safety::FaultKind;

    /// A fault and a warning are recorded in the tick in which they appear, once for as long as they last, and again when they come
    /// back.
    #[test]
    fn what_lasts_is_recorded_once() {
        let mut history = FaultHistory::EMPTY;
        let fault = Fault::Overrun;
        let warning = Fault::Axis { axis: 1, kind: FaultKind::ScaleLost };
        for tick in 0..40 {
            let power =
                if (10..20).contains(&tick) || tick >= 30 { Power::Faulted(fault) } else { Power::On };
            history.update(tick, power, (15..25).contains(&tick).then_some(warning));
        }
        let entry = |tick, event| HistoryEntry { tick, event };
        let expected = [
            entry(30, HistoryEvent::Fault(fault)),
            entry(15, HistoryEvent::Warning(warning)),
            entry(10, HistoryEvent::Fault(fault)),
        ];
        assert!(history.newest_first().eq(expected), "{history:?}");
    }
}
