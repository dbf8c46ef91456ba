//! Memory of long jobs, by an allocator that counts. Its tests run one at a time.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod calibration_table;
mod long_log;
mod run_length;

use std::sync::Mutex;

use peak_alloc::PeakAlloc;

#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Held by a test while it counts: the allocator is that of the whole program.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
