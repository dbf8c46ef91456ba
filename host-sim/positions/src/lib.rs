//! Positioning tests: the figures of ISO 230-2, and what the deviations are made of.
//!
//! A test is a table of readings of a laser at targets that were approached from both sides, run by run. The deviation is a sum of
//! parts over position, direction and time; how many of them there are is chosen by leaving runs out.
//!
//! - [`rows`], [`columns`], [`readings`], [`plausible`]: from a text to readings, with what was assumed
//! - [`measured`]: the test
//! - [`iso`]: the figures of ISO 230-2
//! - [`course`], [`variant`], [`fit`]: the forms of the deviation, and their least squares
//! - [`wave`], [`drift`], [`selection`]: the search for the form
//! - [`effect`], [`effects`], [`drifts`]: from coefficients to effects with intervals and rivals
//! - [`analysis`]: all of it
//! - [`json`], [`text`], [`machine_file`]: the result for a file, for a terminal, and as a machine file

pub mod analysis;
pub mod columns;
pub mod course;
pub mod drift;
mod drifts;
pub mod effect;
pub mod effects;
pub mod fit;
pub mod iso;
pub mod json;
pub mod machine_file;
pub mod measured;
mod plausible;
pub mod readings;
pub mod rows;
pub mod selection;
pub mod text;
pub mod variant;
pub mod wave;

pub use analysis::{Analysis, Options, analyse};
