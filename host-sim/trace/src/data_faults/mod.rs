//! Broken data: faults of single channels that are recognized in the logs alone, before any model is fitted.
//!
//! A fault that can be corrected is corrected, and the samples that it spoils are excluded from the residuals
//! ([`excluded`]); a channel that cannot be used is removed from its log. Either is reported as a [`DataFault`].
//!
//! Only what the channels of a log contradict among themselves is reported. Each kind of fault has its file:
//! [`repeated_rows`], [`rate`], [`dead`], [`exchanged`], [`sign`], [`mod@unit`], [`shifted`], [`stuck`], [`slip`], [`spike`],
//! [`hum`]. They are looked for in this order, as each requires that the earlier ones are corrected: repeated rows before a log is
//! thinned to the rate of the machine, the others after it. [`late_command`] requires a model of the loop and follows the filtering
//! of the signals.

pub mod agreement;
pub mod bridge;
pub mod channels;
pub mod dead;
pub mod difference;
pub mod examine;
pub mod exchanged;
pub mod excluded;
pub mod fault;
pub mod findings;
pub mod hum;
pub mod jumps;
pub mod late_command;
pub mod rate;
pub mod ratio;
pub mod repeated_rows;
pub mod shifted;
pub mod sign;
pub mod slip;
pub mod spike;
pub mod steady_line;
pub mod step;
pub mod stuck;
pub mod stuck_force;
pub mod turns;
pub mod unit;

pub use examine::{Examined, examine, exclude_interpolated, interpolate_lost_rows};
pub use fault::{DataFault, FaultHandling, FaultKind};
