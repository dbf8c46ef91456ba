//! Motions, and waiting for their end.

use std::time::{Duration, Instant};

use shared::interpolate::BlockOf;
use shared::interpolate::feed_hold::FeedState;
use shared::link::message::{PerAxis, Request};
use shared::link::report::{Activity, AxisStatus, Status};
use shared::safety::Power;

use crate::client::Client;
use crate::error::BoardError;
use crate::refusal;

/// Time between two requests while axes move: far less than the silence that holds them.
pub const POLL: Duration = Duration::from_millis(50);

/// Longest wait for drives that have been enabled.
const ENABLE_TIMEOUT: Duration = Duration::from_secs(5);

impl Client {
    /// Enables the drives if they are off, and waits until they are on.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn enable(&mut self) -> Result<(), BoardError> {
        self.command(&Request::Enable)?;
        let started = Instant::now();
        loop {
            let status = self.status()?;
            match status.power {
                Power::On => return Ok(()),
                Power::Off | Power::Enabling if started.elapsed() < ENABLE_TIMEOUT => self.listen(POLL)?,
                _ => return Err(stopped(&status)),
            }
        }
    }

    /// Sends a motion; the board checks each block. It does not start yet. A line leaves the second motor of a gantry where it is: it has no
    /// coordinate of its own.
    ///
    /// # Errors
    /// [`BoardError`]; a block that the board refuses with its number.
    pub fn send_motion(&mut self, blocks: &[BlockOf<PerAxis<f64>>]) -> Result<(), BoardError> {
        self.command(&Request::NewMotion)?;
        let axes = self.status()?.axes;
        for block in blocks {
            let block = block.clone().map(|to_m| left_alone(to_m, &axes));
            self.command(&Request::AddBlock(block))?;
        }
        Ok(())
    }

    /// Starts the motion that was sent.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn start_motion(&mut self, blocks: usize) -> Result<(), BoardError> {
        let blocks = u16::try_from(blocks).map_err(|_| BoardError::TooLong)?;
        self.command(&Request::StartMotion { blocks })
    }

    /// Waits until nothing moves. `each` gets the state at every request and ends the wait by returning false.
    ///
    /// # Errors
    /// [`BoardError::Stopped`] if the drives have gone off, [`BoardError::Held`] if the path is held; any other.
    pub fn wait(
        &mut self,
        mut each: impl FnMut(&mut Self, &Status) -> Result<bool, BoardError>,
    ) -> Result<Status, BoardError> {
        loop {
            let status = self.status()?;
            let goes_on = each(self, &status)?;
            if status.power != Power::On {
                return Err(stopped(&status));
            }
            if status.feed == FeedState::Held && status.activity != Activity::Idle {
                return Err(BoardError::Held { silent_s: f64::from(self.welcome().times.hold_ms) / 1e3 });
            }
            if !goes_on || status.at_rest && status.activity == Activity::Idle {
                return Ok(status);
            }
            self.listen(POLL)?;
        }
    }
}

/// The end of a line with each second motor of a gantry where it is.
fn left_alone(mut to_m: PerAxis<f64>, axes: &[AxisStatus]) -> PerAxis<f64> {
    for (to_m, axis) in to_m.iter_mut().zip(axes) {
        if axis.gantry.is_some() {
            *to_m = axis.command.to_m();
        }
    }
    to_m
}

/// The error for drives that are not on.
#[must_use]
pub fn stopped(status: &Status) -> BoardError {
    BoardError::Stopped(match status.power.fault() {
        Some(fault) => {
            format!("the drives have stopped: {}; `board clear` acknowledges it", refusal::fault(fault))
        }
        None if matches!(status.power, Power::On | Power::Enabling) => "the drives are on".to_owned(),
        None => "the drives have gone off: the enable switch was opened, or they were disabled".to_owned(),
    })
}
