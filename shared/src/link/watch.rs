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
    /// Ticks since a host was last there, with the drives on or off.
    unheard: u32,
}

impl HostWatch {
    /// The silences after which the path is held and the drives are disabled, ticks.
    #[must_use]
    pub const fn new(hold_after: u32, off_after: u32) -> Self {
        Self { hold_after, off_after, silent: 0, unheard: u32::MAX }
    }

    /// A packet of the present session has been received.
    pub const fn heard(&mut self) {
        (self.silent, self.unheard) = (0, 0);
    }

    /// A session was opened. This is no sign of life for the supervision: a request has to follow.
    pub const fn greeted(&mut self) {
        self.unheard = 0;
    }

    /// Whether no host has opened a session or sent a request for the time after which the path is held, with the drives on or
    /// off.
    #[must_use]
    pub const fn is_silent(&self) -> bool {
        self.unheard >= self.hold_after
    }

    /// Whether no host has opened a session or sent a request for the time after which the drives are disabled, with the drives on
    /// or off.
    #[must_use]
    pub const fn is_gone(&self) -> bool {
        self.unheard >= self.off_after
    }

    /// Lets ticks pass with the drives off.
    pub const fn skip(&mut self, ticks: u32) {
        self.unheard = self.unheard.saturating_add(ticks);
    }

    /// Once per tick. Drives that are off are not supervised.
    pub const fn tick(&mut self, drives_on: bool) -> Option<Silence> {
        self.unheard = self.unheard.saturating_add(1);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks after which a watch becomes silent.
    fn ticks_until_silent(watch: &mut HostWatch) -> u32 {
        (0..100).find(|_| watch.is_silent() || watch.tick(false).is_some()).expect("it becomes silent")
    }

    #[test]
    fn a_host_is_silent_before_the_first_and_after_the_time_since_the_last_packet() {
        let mut watch = HostWatch::new(20, 40);
        assert!(watch.is_silent());
        watch.heard();
        assert_eq!(ticks_until_silent(&mut watch), 20);
        watch.greeted();
        assert_eq!(ticks_until_silent(&mut watch), 20);
        // As in a week of ticks: it stays silent.
        watch.unheard = u32::MAX;
        watch.tick(false);
        assert!(watch.is_silent());
    }

    /// Sessions that are opened repeatedly do not replace requests.
    #[test]
    fn an_opened_session_is_no_sign_of_life() {
        let mut watch = HostWatch::new(3, 5);
        let seen = [true; 5].map(|on| {
            watch.greeted();
            watch.tick(on)
        });
        assert_eq!(seen, [None, None, Some(Silence::Hold), None, Some(Silence::Off)]);
    }
}
