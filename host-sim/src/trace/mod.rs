//! From a log to the effect that its machine has and its model lacks.

pub mod fit;
pub mod model;
pub mod predict;
pub mod residual;
pub mod scope;
pub mod signals;
