//! x
use std::path::{Path, PathBuf};
use crate::compare::Comparison;
use crate::output::OutputError;
/// x
pub fn write(folder: &Path, _c: &Comparison, _l: &[String]) -> Result<PathBuf, OutputError> { Ok(folder.to_owned()) }
