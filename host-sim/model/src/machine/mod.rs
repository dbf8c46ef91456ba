//! The machine file: the declared machine, including effects found.
//!
//! `declared` contains the [`Machine`], `axis` one of its axes. `read` reads a file, `check` refuses machines that cannot
//! exist. [`rotary`] has the keys of rotary axes. [`instruments`] contains the sensors, [`nominal`] the values that a trace writes in addition to fitted values, [`evidence`]
//! what it knows of the effects.

mod axis;
mod check;
mod declared;
pub mod evidence;
pub mod instruments;
pub mod nominal;
mod number_table;
mod read;
pub mod rotary;

pub use axis::Axis;
pub use declared::Machine;

#[cfg(test)]
mod tests;
