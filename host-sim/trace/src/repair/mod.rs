//! Step 2, repair: [`repair()`] takes admitted logs, and returns their signals without the faults that can be corrected.
//!
//! The faults are found by [`crate::data_faults`], late commands last, as they require the signals of [`preparation`].

pub mod preparation;
pub mod repaired;

pub use repaired::{Repaired, repair};
