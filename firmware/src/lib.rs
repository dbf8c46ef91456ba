//! The controller of [`shared`] on a chip. Everything that can be tested on a host is in [`shared`]; this crate has the
//! registers, one module per program:
//!
//! | program | chip | built by |
//! |---|---|---|
//! | `board` | STM32F405 with two drives | `cargo board` |
//! | `board-g474` | STM32G474 with two drives, which has never run | `cargo board-g474` |
//! | `emulated` | QEMU's `mps2-an386`, in step with a host | `cargo emulated` |
//! | `servo`, `servo-four` | the same, as a servo board of two or four axes with its own ticks, a link, and a simulated machine | `cargo servo` |
//! | `cost`, `cost-four` | the same, without a host: counts the instructions of each part of a tick | `cargo cost`, `cargo cost-four` |
#![no_std]

pub mod bench;
#[cfg(feature = "board")]
pub mod board;
#[cfg(feature = "cost")]
pub mod cost;
#[cfg(feature = "emulated")]
pub mod emulated;
#[cfg(any(feature = "emulated", feature = "servo"))]
pub mod emulator;
pub mod f405;
pub mod flash;
pub mod g474;
#[cfg(feature = "servo")]
pub mod servo;
pub mod setup;
pub mod two_drives;
#[cfg(feature = "usb")]
pub mod usb_port;
