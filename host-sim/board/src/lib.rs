//! A servo board at the end of a byte stream: the host's side of [`shared::link`].
//!
//! - [`port`]: an open serial port or socket
//! - [`port_lock`]: the lock that lets only one program use a port
//! - [`mod@share`], [`broker`]: forwarding of requests that need no session, for other programs
//! - [`mod@open`]: ports by their names
//! - [`mod@bench`]: the emulated servo board, which keeps running between commands, and the switches of its machine
//! - [`client`]: requests with their replies, repeated if they are lost
//! - [`observer`]: requests that need no session, also while another program holds the port
//! - [`transfer`]: uploads and recordings in parts
//! - [`motion`]: motions, and waiting for their end
//! - [`samples`]: samples of a stream or a recording in SI
//! - [`refusal`]: refusals in words

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod bench;
mod broker;
mod byte_stream;
pub mod client;
pub mod error;
#[cfg(test)]
mod fault_page;
pub mod motion;
pub mod observer;
pub mod open;
pub mod port;
pub mod port_lock;
pub mod refusal;
pub mod samples;
mod share;
pub mod transfer;

pub use client::Client;
pub use error::BoardError;
pub use observer::Observer;
pub use open::open;
pub use port::Port;
