//! Errors of a board and its link.

use shared::link::Refusal;
use shared::link::halt::Halt;

use crate::refusal;

/// Why a board does not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The port cannot be opened, or the emulated board not started.
    #[error("port {0}")]
    Port(String),
    /// Another program uses the port.
    #[error(
        "port {port}: in use by {holder}, which has to end first; `board stop`, `hold`, `disable`, `status` and `monitor` work meanwhile"
    )]
    InUse {
        /// Name of the port.
        port: String,
        /// The other program, in words.
        holder: String,
    },
    /// Another program uses the port, and passes nothing on: an older one, or one of another system than Linux and macOS.
    #[error(
        "port {port}: in use by {holder}, which passes nothing on to the board and has to end first{}; the enable switch and the emergency stop act at any time",
        if cfg!(unix) { "" } else { " (only on Linux and macOS can another program be stopped from here)" }
    )]
    PassesNothingOn {
        /// Name of the port.
        port: String,
        /// The other program, in words.
        holder: String,
    },
    /// The port has failed.
    #[error("link: {0}")]
    Link(#[from] std::io::Error),
    /// There is no reply.
    #[error(
        "link: no reply within {seconds} s; check that the board runs and that no other program uses the port"
    )]
    Silent {
        /// Time that was waited for.
        seconds: f64,
    },
    /// The board refuses the request.
    #[error("the board refuses it: {}", refusal::text(.0))]
    Refused(Refusal),
    /// Somebody else has held, stopped or disabled.
    #[error("{}", refusal::halted_by_other(*.0))]
    HaltedByOther(Halt),
    /// The reply is not one to this request.
    #[error("link: unexpected reply; check that board and host have the same version")]
    Unexpected,
    /// The drives have gone off.
    #[error("{0}")]
    Stopped(String),
    /// The board has held the path.
    #[error(
        "the path is held: this program was silent for {silent_s} s, or another port holds it; `board resume` continues it, `board stop` discards it"
    )]
    Held {
        /// Silence after which the board holds the path.
        silent_s: f64,
    },
    /// The message is longer than a packet.
    #[error("link: the request is too long")]
    TooLong,
}
