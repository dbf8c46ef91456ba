//! Step 1, admission: [`admit`] takes logs as they are given, and returns them at the rate of the machine.
//!
//! [`usable`] refuses logs that cannot be traced, with [`checks`], [`copies`] and [`missing_channels`]. The faults of their data are
//! corrected before: a position in another unit is no reason to refuse its log.

pub mod admitted;
pub mod checks;
pub mod copies;
pub mod missing_channels;
pub mod sampling_rate;
pub mod usable;

pub use admitted::{Admitted, admit};
