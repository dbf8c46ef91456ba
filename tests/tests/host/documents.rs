//! Files that documents name in backticks exist, and so do the targets of their links and the program that they call.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The documents of the repository except the change log, which may name files that have been removed.
fn documents() -> Vec<PathBuf> {
    let folder = fs::read_dir(workspace().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages = folder.filter(|path| path.extension().is_some_and(|end| end == "md"));
    pages.chain(["README.md", "CONTRIBUTING.md"].map(|name| workspace().join(name))).collect()
}

/// Texts between two marks.
fn between<'a>(text: &'a str, open: &'a str, close: char) -> impl Iterator<Item = &'a str> {
    text.split(open).skip(1).filter_map(move |rest| Some(rest.split_once(close)?.0))
}

#[test]
fn files_that_are_named_exist() {
    const FOLDERS: [&str; 5] = ["shared/", "firmware/", "host-sim/", "tests/", "docs/"];
    let mut missing = Vec::new();
    let mut named = 0;
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        // Every second part of the text, split at backticks, is code.
        for code in text.split('`').skip(1).step_by(2) {
            let is_path =
                FOLDERS.iter().any(|folder| code.starts_with(folder)) && !code.contains([' ', '{', '*', '<']);
            if is_path {
                named += 1;
                if !workspace().join(code).exists() {
                    missing.push(format!("{}: {code}", document.display()));
                }
            }
        }
    }
    assert!(named > 50, "only {named} files are named");
    assert!(missing.is_empty(), "files that do not exist:\n{}", missing.join("\n"));
}

#[test]
fn targets_of_links_exist() {
    let mut missing = Vec::new();
    for document in documents() {
        let text = fs::read_to_string(&document).unwrap();
        for target in between(&text, "](", ')').filter(|target| !target.contains("://")) {
            let file = target.split('#').next().unwrap();
            if !file.is_empty() && !document.parent().unwrap().join(file).exists() {
                missing.push(format!("{}: {target}", document.display()));
            }
        }
    }
    assert!(missing.is_empty(), "links that lead nowhere:\n{}", missing.join("\n"));
}

/// The documents call the program by `cargo run`: the workspace must not leave open which program that is.
#[test]
fn cargo_runs_the_program() {
    let arguments = ["metadata", "--no-deps", "--format-version", "1", "--offline"];
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(workspace()).output().unwrap();
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let defaults: Vec<&str> = packages.filter_map(|package| package["default_run"].as_str()).collect();
    assert_eq!(defaults, ["lost-motion"]);
}
