//! The machine file: what is declared of a machine, effects found included.
//!
//! [`declared`](Machine) is the machine, `axis` one of its axes; `read` takes a file in, `check` refuses what cannot exist.
//! [`instruments`] are its sensors, [`nominal`] is what a trace keeps beside what it fitted.

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
