//! The controller of [`shared`] on a chip. Everything that can be tested on a host is in [`shared`]; this crate has the
//! registers, one module per program:
//!
//! | program | chip | built by |
//! |---|---|---|
//! | `board` | STM32F405 with two drives | `cargo board` |
//! | `emulated` | QEMU's `mps2-an386`, in step with a host | `cargo emulated` |
//! | `cost` | the same, without a host: counts the instructions of each part of a tick | `cargo cost` |
#![no_std]

#[cfg(feature = "board")]
pub mod board;
#[cfg(feature = "cost")]
pub mod cost;
#[cfg(feature = "emulated")]
pub mod emulated;
pub mod setup;
