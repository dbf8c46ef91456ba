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
        let fault = match power {
            Power::Stopping(fault) | Power::Faulted(fault) => Some(fault),
            Power::Off | Power::On => None,
        };
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
