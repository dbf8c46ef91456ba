//! The machine file: the declared machine, including effects found.
//!
//! `declared` contains the [`Machine`], `axis` one of its axes. `read` reads a file, `check` refuses machines that cannot
//! exist. [`instruments`] contains the sensors, [`nominal`] the values that a trace writes in addition to fitted values.

mod axis;
mod check;
mod declared;
pub mod instruments;
pub mod nominal;
mod number_table;
mod read;

pub use axis::Axis;
pub use declared::Machine;

#[cfg(test)]
mod tests;
