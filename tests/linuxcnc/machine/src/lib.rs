//! The simulated machine for a HAL component of LinuxCNC: once a servo period commands in, readings of its sensors out.
//!
//! | | |
//! |---|---|
//! | [`machine`] | the machine of a machine file over one servo period |
//! | [`drive`] | what an axis makes of its command: a force, or a force by loops of its own |
//! | [`interface`] | the functions that the component `lost_motion.comp` calls |
//!
//! LinuxCNC plans, compensates and closes the position loop. The machine file has the truth: its mechanics, its effects, and the
//! loops of a drive that has its own.

pub mod drive;
pub mod interface;
pub mod machine;
