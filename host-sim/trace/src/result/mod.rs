//! Step 6, the result: [`identify()`] takes repaired logs and findings, and returns the [`Identification`], which nothing changes.
//!
//! [`certainty`] states what speaks against the effects found (with [`displaced_head`] and [`force_scale`]), [`distinguishing_motion`] proposes motions
//! that tell more, and [`refuting_motion`] those that would refute a law, along [`strokes`]. [`verdict`] says whether the model explains the logs; [`json`] is the result as JSON.

pub mod certainty;
pub mod displaced_head;
pub mod distinguishing_motion;
pub mod force_scale;
pub mod identification;
pub mod identify;
pub mod json;
pub mod refuting_motion;
pub mod strokes;
pub mod verdict;

pub use identification::{AxisIdentification, Identification};
pub use identify::identify;
