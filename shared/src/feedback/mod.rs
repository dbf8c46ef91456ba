//! From sensors to the position that the loop closes on.

pub mod dual;
pub mod encoder;
pub mod fade;
pub mod phase;
pub mod transducer;
