//! What needs no session: to hold, stop and disable, to set the feed override, and to look.
//!
//! If another program holds the port, the request goes through that program, whose own motion it may end.

use std::thread::sleep;
use std::time::{Duration, Instant};

use files::error::quoted;
use shared::link::halt::Halt;
use shared::link::history::HistoryEntry;
use shared::link::message::{Reply, Request};
use shared::link::{Status, Welcome};

use crate::client::Client;
use crate::error::BoardError;
use crate::open;

/// Longest wait for the port after the program that has held it has ended.
const CHANGE_TIMEOUT: Duration = Duration::from_secs(3);

/// Longest wait for a reply through another program of this computer.
const PASSED_ON_TIMEOUT: Duration = Duration::from_millis(500);

/// Time between two attempts.
const RETRY: Duration = Duration::from_millis(20);

/// A board without a session.
#[derive(Debug)]
pub struct Observer {
    name: String,
    timeout: Duration,
    client: Client,
    /// The program that passes its requests on, if it is not this one.
    holder: Option<String>,
}

impl Observer {
    /// Opens a port by its name, or a connection to the program that holds it. `timeout` is the longest wait for a reply.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn open(name: &str, timeout: Duration) -> Result<Self, BoardError> {
        let (port, holder) = open::observe(name)?;
        let timeout_there = if holder.is_some() { timeout.min(PASSED_ON_TIMEOUT) } else { timeout };
        let client = Client::without_session(port, timeout_there)?;
        Ok(Self { name: name.to_owned(), timeout, client, holder })
    }

    /// Holds, stops or disables.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn halt(&mut self, halt: Halt) -> Result<(), BoardError> {
        match self.ask(&Request::from(halt))? {
            Reply::Done => Ok(()),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// Sets the feed override, 0 to 200 %.
    ///
    /// # Errors
    /// [`BoardError`]; [`BoardError::Refused`] if nothing moves.
    pub fn set_override(&mut self, percent: u8) -> Result<(), BoardError> {
        match self.ask(&Request::Override { percent })? {
            Reply::Done => Ok(()),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// What the board is.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn identify(&mut self) -> Result<Welcome, BoardError> {
        match self.ask(&Request::Identify)? {
            Reply::Welcome(welcome) => Ok(welcome),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// The state of the board.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn status(&mut self) -> Result<Status, BoardError> {
        match self.ask(&Request::Status)? {
            Reply::Status(status) => Ok(status),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// The last faults and warnings, the newest first.
    ///
    /// # Errors
    /// [`BoardError`].
    pub fn history(&mut self) -> Result<Vec<HistoryEntry>, BoardError> {
        match self.ask(&Request::FaultHistory)? {
            Reply::FaultHistory(entries) => Ok(entries.iter().copied().collect()),
            _ => Err(BoardError::Unexpected),
        }
    }

    /// A request and its reply. The program that holds the port may end meanwhile, not least because of this request: it is repeated
    /// then, which each of these may be.
    fn ask(&mut self, request: &Request) -> Result<Reply, BoardError> {
        let started = Instant::now();
        loop {
            let error = match (self.client.request(request), &self.holder) {
                (Err(error @ BoardError::Link(_)), _) => error,
                (Err(BoardError::Silent { .. }), Some(holder)) => {
                    let (port, holder) = (quoted(&self.name), holder.clone());
                    return Err(BoardError::PassesNothingOn { port, holder });
                }
                (other, _) => return other,
            };
            if started.elapsed() > CHANGE_TIMEOUT {
                return Err(error);
            }
            sleep(RETRY);
            if let Ok(again) = Self::open(&self.name, self.timeout) {
                *self = again;
            }
        }
    }
}
