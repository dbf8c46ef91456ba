//! `lost-motion trace --friction-map`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::{keeps, say};
use files::error::InputError;
use files::output::write_whole;
use report::friction_map::sentences::{remainder, sentences, table};
use trace::friction_map::FrictionMap;
use trace::friction_map::json::json;
use trace::friction_map::search::explain;
use trace::friction_map::unexplained::unexplained;

/// Explains a friction map.
///
/// # Errors
/// Input that cannot be used, output that cannot be written.
pub fn run(path: &Path, json_path: Option<&PathBuf>, folder: Option<&PathBuf>) -> Result<()> {
    let page = report::page::file_in(folder);
    keeps(&[path], &[("--json", json_path), ("--report", page.as_ref())])?;
    let map = FrictionMap::read(path)?;
    let explained = explain(&map).ok_or_else(|| {
        let what = "runs that tell Coulomb from viscous friction";
        InputError::expected(&map.source, what, "none")
    })?;
    let rest = unexplained(&map, &explained.searched.fitted.law);
    if let Some(path) = json_path {
        let text = serde_json::to_string_pretty(&json(&map, &explained, rest.as_ref()))?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    let mut lines = sentences(&map, &explained);
    lines.push(String::new());
    lines.extend(table(&map, &explained));
    lines.push(String::new());
    lines.extend(remainder(&map, &explained, rest.as_ref()));
    if let Some(folder) = folder {
        let path = report::friction_map::write(folder, &map, &explained, rest.as_ref())?;
        lines.push(format!("\nReport: {}", path.display()));
    }
    say(&lines.join("\n"))
}
