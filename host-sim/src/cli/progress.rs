//! Progress on stderr: a line that says what is being done, nothing where stderr is not a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// A line that is gone when the work is done.
pub struct Progress(ProgressBar);

impl Progress {
    /// Starts the line.
    #[must_use]
    pub fn start() -> Self {
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed:>4}  {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Starts the line of a job of so many parts.
    #[must_use]
    pub fn of(parts: u64) -> Self {
        let bar = ProgressBar::new(parts);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len} {elapsed}\n{msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self(bar)
    }

    /// Says that so many parts are done.
    pub fn done(&self, parts: usize) {
        self.0.set_position(parts as u64);
    }

    /// Says how far the simulated machine has come, twice a second of its time.
    pub fn machine_time(&self, time_s: f64) {
        if (2.0 * time_s).fract() == 0.0 {
            self.show(&format!("{time_s:.1} s of machine time"));
        }
    }

    /// Says what is being done.
    pub fn show(&self, what: &str) {
        self.0.set_message(what.to_owned());
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
