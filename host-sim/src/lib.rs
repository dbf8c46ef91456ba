//! Lost Motion: closes the loop against a simulated machine, and traces what a measured log holds
//! and its declared model lacks.

pub mod controller;
pub mod effects;
pub mod error;
pub mod log;
pub mod machine;
