//! Supervision of the host: what happens when it is silent.
//!
//! # Example
//!
//! ```
//! use shared::link::watch::{HostWatch, Silence};
//!
//! let mut watch = HostWatch::new(2, 4);
//! let seen = [true; 6].map(|drives_on| watch.tick(drives_on));
//! assert_eq!(seen, [None, Some(Silence::Hold), None, Some(Silence::Off), None, None]);
//! ```

/// What the silence of a host requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Silence {
    /// Hold the path.
    Hold,
    /// Disable the drives.
    Off,
}

/// Counts the ticks since the last packet of the host.
#[derive(Clone, Copy, Debug)]
pub struct HostWatch {
    hold_after: u32,
    off_after: u32,
    silent: u32,
}

impl HostWatch {
    /// The silences after which the path is held and the drives are disabled, ticks.
    #[must_use]
    pub const fn new(hold_after: u32, off_after: u32) -> Self {
        Self { hold_after, off_after, silent: 0 }
    }

    /// A packet of the present session has been received.
    pub const fn heard(&mut self) {
        self.silent = 0;
    }

    /// Once per tick. Drives that are off are not supervised.
    pub const fn tick(&mut self, drives_on: bool) -> Option<Silence> {
        if !drives_on {
            self.silent = 0;
            return None;
        }
        self.silent = self.silent.saturating_add(1);
        if self.silent == self.off_after {
            Some(Silence::Off)
        } else if self.silent == self.hold_after {
            Some(Silence::Hold)
        } else {
            None
        }
    }
}
