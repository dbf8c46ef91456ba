//! A servo board at the end of a byte stream: the host's side of [`shared::link`].
//!
//! - [`port`]: serial ports and sockets by their names
//! - [`bench`]: the emulated servo board, which lives on between commands, and the switches of its machine
//! - [`client`]: requests with their replies, repeated where they are lost
//! - [`transfer`]: uploads and recordings in parts
//! - [`motion`]: motions, and waiting for their end
//! - [`samples`]: samples of a stream or a recording in SI
//! - [`refusal`]: refusals in words

pub mod bench;
pub mod client;
pub mod motion;
pub mod port;
pub mod refusal;
pub mod samples;
pub mod transfer;

pub use client::{BoardError, Client};
pub use port::{Port, open};
