//! A servo board of two axes on an emulated Cortex-M4F: its system timer runs the tick 20,000 times a second, its idle loop serves the
//! link. The machine is simulated ([`firmware::bench`]).
//!
//! `docs/board.md` describes how it is used, `docs/firmware.md` how it is started.
#![no_std]
#![no_main]

#[path = "../servo/program.rs"]
mod program;

/// Axes of the board, 1 to 4.
const AXES: usize = 2;
