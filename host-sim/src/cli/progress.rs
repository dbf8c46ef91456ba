//! Progress on stderr: a status line with a spinner or a bar, or nothing if stderr is not a terminal.

use std::time::Duration;

use files::error::printable;
use indicatif::{ProgressBar, ProgressStyle};

/// The status line; dropping it clears it.
pub struct Progress(ProgressBar);

impl Progress {
    /// Starts a line with a spinner.
    #[must_use]
    pub fn start() -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Starts a line with a bar for a number of parts.
    #[must_use]
    pub fn with_bar(parts: u64) -> Self {
        let bar = ProgressBar::new(parts);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {elapsed}\n{msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Sets the number of finished parts.
    pub fn set_done(&self, parts: usize) {
        self.0.set_position(parts as u64);
    }

    /// Shows the time of the simulated machine, in steps of half a second of machine time.
    pub fn machine_time(&self, time_s: f64) {
        if (2.0 * time_s).fract() == 0.0 {
            self.show(&format!("{time_s:.1} s of machine time"));
        }
    }

    /// Shows a message.
    pub fn show(&self, what: &str) {
        self.0.set_message(printable(what));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
