//! Positioning tests: the figures of ISO 230-2, and the parts of the deviations.
//!
//! A test is a table of readings of a laser at targets that were approached from both sides, run by run. The deviation is a sum of
//! parts over position, direction and time; their number is chosen by leaving runs out.
//!
//! - [`rows`], [`columns`], [`readings`], `raw`, `plausible`: from a text to readings, with the assumptions
//! - [`rtl`]: the file of Renishaw's laser software
//! - [`measured`]: the test
//! - [`iso`]: the figures of ISO 230-2
//! - [`course`], [`variant`], [`fit`]: the forms of the deviation, and their least squares
//! - [`wave`], [`drift`], `evidence`, [`selection`]: the search for the form
//! - [`effect`], [`source`], [`effects`], `drifts`: from coefficients to effects with intervals and rivals
//! - [`analysis`]: the complete evaluation
//! - [`json`], [`text`], [`machine_file`]: the result for a file, for a terminal, and as a machine file

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod analysis;
pub mod columns;
pub mod course;
pub mod drift;
mod drifts;
pub mod effect;
pub mod effects;
mod evidence;
pub mod fit;
pub mod iso;
pub mod json;
pub mod machine_file;
pub mod measured;
mod plausible;
mod raw;
pub mod readings;
pub mod rows;
pub mod rtl;
pub mod selection;
pub mod source;
pub mod text;
pub mod variant;
pub mod wave;

pub use analysis::{Analysis, Options, analyse};

use std::path::Path;

use files::axis_name::is_axis_name;
use files::error::InputError;

use columns::Request;
use measured::Test;

/// The test in the bytes of a file; `source` is its name for messages.
///
/// # Errors
/// As [`readings::of_text`], and a text that cannot be decoded.
pub fn read(bytes: &[u8], source: &str, request: &Request) -> Result<Test, InputError> {
    let mut notes = Vec::new();
    let text = import::text::decode(bytes, source, &mut notes)?;
    if rtl::is(&text) {
        return rtl::of_text(&text, source, notes);
    }
    readings::of_text(&text, source, request, notes)
}

/// The name of an axis from that of a file: its last letter in `x.csv`, otherwise `x`.
#[must_use]
pub fn files_axis(path: &Path) -> String {
    let name = path.file_name().and_then(std::ffi::OsStr::to_str).unwrap_or_default();
    let stem = name.split('.').next().unwrap_or_default().to_lowercase();
    if stem.len() == 1 && is_axis_name(&stem) { stem } else { "x".to_owned() }
}
