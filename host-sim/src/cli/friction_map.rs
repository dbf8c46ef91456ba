//! `lost-motion trace --friction-map`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{check_json_and_page, print, write_json};
use files::error::InputError;
use friction_map::json::json;
use friction_map::residual_analysis::analyse;
use friction_map::{FrictionMap, explain};
use report::friction_map::sentences::{error_table, sentences, unexplained};

/// Analyses a friction map: summary on stdout, JSON and page if requested.
///
/// # Errors
/// Input that cannot be used, output that cannot be written.
pub fn run(path: &Path, json_path: Option<&PathBuf>, folder: Option<&PathBuf>) -> Result<()> {
    let page = pages::file_in(folder);
    check_json_and_page(&[path], json_path, page.as_ref())?;
    let map = FrictionMap::read(path)?;
    let explanation = explain(&map).ok_or_else(|| {
        let expected = "runs that distinguish Coulomb from viscous friction";
        InputError::expected(&map.source, expected, "none")
    })?;
    let residual = analyse(&map, &explanation.selection.fitted.law);
    write_json(json_path, &json(&map, &explanation, residual.as_ref()))?;
    let mut lines = sentences(&map, &explanation);
    lines.push(String::new());
    lines.extend(error_table(&map, &explanation));
    lines.push(String::new());
    lines.extend(unexplained(&map, &explanation, residual.as_ref()));
    if let Some(folder) = folder {
        let path = report::friction_map::write(folder, &map, &explanation, residual.as_ref())?;
        lines.push(format!("\nReport: {}", path.display()));
    }
    print(&lines.join("\n"))
}
