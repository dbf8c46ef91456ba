//! The shortest motion that decides between effects that a trace could not tell apart.
//!
//! A plan does not predict from sensitivities what a trace will tell: it simulates the log of a motion under each rival, traces it, and
//! looks at the answer. The tracer evaluates stage by stage and requires more of an effect than a difference in the logs.
//!
//! | step | module |
//! |---|---|
//! | what the model leaves open, and the machine as it was declared | [`questions`] |
//! | the travel, speeds and accelerations that a motion may use | [`limits`] |
//! | the motions that are tried | [`family`] |
//! | what the log of a motion answers | [`trial`] |
//! | the shortest motion that answers everything | [`search`] |
//! | the plan as text and JSON | [`outcome`] |

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod family;
pub mod limits;
pub mod outcome;
pub mod questions;
pub mod search;
pub mod trial;

pub use limits::{AxisLimits, MotionLimits};
pub use outcome::Plan;
pub use search::{Planning, plan};
