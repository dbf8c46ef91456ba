//! A servo board at the end of a byte stream: the host's side of [`shared::link`].
//!
//! - [`port`]: an open serial port or socket
//! - [`port_lock`]: one program at a port
//! - [`mod@share`], [`broker`]: others ask it for what needs no session
//! - [`mod@open`]: ports by their names
//! - [`mod@bench`]: the emulated servo board, which lives on between commands, and the switches of its machine
//! - [`client`]: requests with their replies, repeated where they are lost
//! - [`observer`]: those that need no session, also while another program holds the port
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
