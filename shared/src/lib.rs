#![no_std]
#![forbid(unsafe_code)]
#![doc = include_str!("front.md")]

pub mod axis;
pub mod capture;
pub mod compensate;
pub mod config;
pub mod control;
pub mod drive;
pub mod feedback;
pub mod homing;
mod integer;
pub mod interpolate;
pub mod link;
pub mod machine;
pub mod monitor;
pub mod protocol;
pub mod safety;
pub mod scalar;
pub mod session;
pub mod storage;
pub mod units;

/// Keeps the compiler from loading what is computed next while the registers hold what is computed now. No instruction.
#[inline(always)]
#[expect(clippy::inline_always, reason = "no instruction")]
fn one_after_the_other() {
    core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
}
