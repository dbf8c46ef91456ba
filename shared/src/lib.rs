#![no_std]
#![forbid(unsafe_code)]
#![doc = include_str!("front.md")]

pub mod axis;
pub mod capture;
pub mod compensate;
pub mod config;
pub mod control;
pub mod drive;
pub mod excitation;
pub mod feedback;
pub mod figures;
pub mod homing;
mod integer;
pub mod interpolate;
pub mod link;
pub mod lockstep;
pub mod machine;
pub mod monitor;
pub mod probing;
pub mod safety;
pub mod scalar;
pub mod storage;
pub mod units;

/// Identifies the sources of this crate. Messages, control laws and rounding of two programs are the same if it is.
pub const SOURCES: u64 = match u64::from_str_radix(env!("SHARED_SOURCES"), 16) {
    Ok(sources) => sources,
    Err(_) => panic!("the build script writes hexadecimal digits"),
};

/// Keeps the compiler from loading what is computed next while the registers hold what is computed now. No instruction.
#[inline(always)]
#[expect(clippy::inline_always, reason = "no instruction")]
fn one_after_the_other() {
    core::sync::atomic::compiler_fence(core::sync::atomic::Ordering::SeqCst);
}
