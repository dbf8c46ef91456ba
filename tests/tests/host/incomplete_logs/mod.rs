//! Traces of logs and machine files of which parts are missing.
//!
//! Logs lack channels, axes or most of their samples, machine files lack keys. Whatever is left: a trace gives a result or one line
//! that says what it needs, and no effect is certain that the machine does not have.

mod case;
mod channels;
mod rows;
mod sweep;
