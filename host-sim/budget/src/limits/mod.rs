//! Limits of the figures at the tool, and whether they are kept.
//!
//! A figure is judged where it was measured at the tool, in any log; else as the error budget predicts it. What can be judged by neither is
//! unknown, which is never a pass.

mod judge;
mod judgement;
mod limit;
mod limited;

#[cfg(test)]
mod tests;

pub use judge::{Circular, Judged, Trust, judged, judged_by_logs, of_circle};
pub use judgement::{Basis, Judgement, Outcome, summary};
pub use limit::{Figure, Limit};
pub use limited::Limited;
