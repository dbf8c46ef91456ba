//! From sensor signals to the position that closes the position loop.
//!
//! | module | from | to |
//! |---|---|---|
//! | [`phase`] | sine and cosine samples, or a counter | a phase: the position within a cycle |
//! | [`transducer`] | phases of a resolver or a linear scale | a position |
//! | [`resolver`] | samples of a converter | a position, and whether the signals are good |
//! | [`counter`] | a 32-bit quadrature counter | a position |
//! | [`encoder`] | a 16-bit quadrature counter | a position |
//! | [`dual`] | motor and table positions | the feedback of the position loop |
//! | [`ScaleSignal`] | whether the scale has a signal | whether it can be read |
//! | [`exponential_decay`] | the offset of a scale that has returned | the same, decaying to zero |

pub mod counter;
pub mod dual;
pub mod encoder;
pub mod exponential_decay;
pub mod long_count;
pub mod phase;
mod reading;
pub mod resolver;
mod scale_signal;
pub mod transducer;

pub use reading::{OriginShift, Reading};
pub use scale_signal::ScaleSignal;
