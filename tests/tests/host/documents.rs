//! Files that documents name in backticks exist, and so do the targets of their links and the program that they call.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the repository.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// The documents of the repository except the change log, which may name files that have been removed.
pub fn documents() -> Vec<PathBuf> {
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

/// The book of mdBook has every page, and so has the list of documents.
#[test]
fn every_page_is_in_the_summary_and_in_the_list() {
    let docs = workspace().join("docs");
    let [summary, list] =
        ["SUMMARY.md", "README.md"].map(|name| fs::read_to_string(docs.join(name)).unwrap());
    let mut pages = 0;
    for path in documents().iter().filter(|path| path.starts_with(&docs)) {
        let name = path.file_name().unwrap().to_str().unwrap();
        let is_page = name != "SUMMARY.md" && name != "README.md";
        if is_page {
            pages += 1;
            let link = format!("]({name})");
            assert!(summary.contains(&link) && list.contains(&link), "{name}");
        }
    }
    assert!(pages > 20, "{pages}");
}

fn metadata() -> serde_json::Value {
    let arguments = ["metadata", "--no-deps", "--format-version", "1", "--offline"];
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(workspace()).output().unwrap();
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The documents call the program by `cargo run`: the workspace must not leave open which program that is.
#[test]
fn cargo_runs_the_program() {
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap().iter();
    let defaults: Vec<&str> = packages.filter_map(|package| package["default_run"].as_str()).collect();
    assert_eq!(defaults, ["lost-motion"]);
}

/// Crates of the workspace that a crate is built with, by their names.
fn used_by<'a>(packages: &'a [serde_json::Value], name: &str) -> Vec<&'a str> {
    let package = packages.iter().find(|package| package["name"] == name).unwrap();
    let dependencies = package["dependencies"].as_array().unwrap().iter();
    let own =
        dependencies.filter(|dependency| dependency["kind"].is_null() && dependency["path"].is_string());
    own.map(|dependency| dependency["name"].as_str().unwrap()).collect()
}

#[test]
fn the_page_on_architecture_has_every_crate_and_its_boundaries_hold() {
    let page = fs::read_to_string(workspace().join("docs/architecture.md")).unwrap();
    let metadata = metadata();
    let packages = metadata["packages"].as_array().unwrap();
    assert!(packages.len() > 20, "{}", packages.len());
    for package in packages {
        let name = package["name"].as_str().unwrap();
        assert!(page.contains(&format!("| [`{name}`](../")), "{name}");
    }
    let of_self_test = used_by(packages, "self-test");
    assert!(of_self_test.contains(&"trace"), "{of_self_test:?}");
    assert!(!of_self_test.iter().any(|name| ["plant", "model", "shared"].contains(name)), "{of_self_test:?}");
    assert_eq!(used_by(packages, "files"), ["numerics"]);
    let mut reached = vec!["pages", "studies"];
    for index in 0.. {
        let Some(name) = reached.get(index).copied() else { break };
        let more = used_by(packages, name).into_iter().filter(|name| !reached.contains(name));
        let more: Vec<&str> = more.collect();
        reached.extend(more);
    }
    assert!(reached.contains(&"plant") && !reached.contains(&"trace"), "{reached:?}");
}

/// Source files below a folder, without examples and tests.
pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let is_source = |path: &PathBuf| {
        let is_other = || ["examples", "tests", "benches"].iter().any(|name| path.ends_with(name));
        if path.is_dir() { !is_other() } else { path.extension().is_some_and(|end| end == "rs") }
    };
    let kept = entries.filter(is_source);
    kept.flat_map(|path| if path.is_dir() { sources(&path) } else { vec![path] }).collect()
}

/// A reader sees one item at a time: its documentation does not begin with a reference to the one before.
#[test]
fn no_item_is_described_by_the_one_before() {
    let mut items = 0;
    for folder in ["shared/src", "firmware/src", "host-sim"] {
        for file in sources(&workspace().join(folder)) {
            let text = fs::read_to_string(&file).unwrap();
            let mut is_first = true;
            for line in text.lines().map(str::trim_start) {
                let Some(doc) = line.strip_prefix("/// ") else {
                    is_first = !line.starts_with("///");
                    continue;
                };
                let refers = ["The same", "Those ", "Likewise"].iter().any(|start| doc.starts_with(start));
                assert!(!is_first || !refers, "{}: {doc}", file.display());
                items += usize::from(is_first);
                is_first = false;
            }
        }
    }
    assert!(items > 5000, "{items}");
}

/// The source files of the program that contain a word, each of which a page names.
fn files_named_by(page: &str, word: &str) -> Vec<String> {
    let text = fs::read_to_string(workspace().join(page)).unwrap();
    let contains = |path: &PathBuf| fs::read_to_string(path).unwrap().contains(word);
    let files = sources(&workspace().join("host-sim")).into_iter().filter(contains);
    let files: Vec<String> =
        files.map(|file| file.strip_prefix(workspace()).unwrap().to_str().unwrap().to_owned()).collect();
    for file in &files {
        assert!(text.contains(&format!("`{file}`")), "{page}: {file}");
    }
    files
}

/// The effect, the catalogue, and two files of the simulated machine. Examples are no sources.
#[test]
fn the_page_on_adding_an_effect_names_every_file_that_names_its_example() {
    let files = files_named_by("docs/adding-an-effect.md", "QuadraticDrag");
    assert_eq!(files.len(), 4, "{files:?}");
}

/// Eight files name the channel of the example, and a ninth the word of its column.
#[test]
fn the_page_on_adding_a_channel_names_every_file_that_names_its_example() {
    let files = files_named_by("docs/adding-a-channel.md", "AddedForce");
    assert_eq!(files.len(), 8, "{files:?}");
    let page = fs::read_to_string(workspace().join("docs/adding-a-channel.md")).unwrap();
    let steps = page.lines().filter(|line| line.starts_with("| ") && line.contains("`host-sim/"));
    assert_eq!(steps.count(), 9);
}

/// The table of the declaration's items has every item that an effect may declare.
#[test]
fn the_page_on_adding_an_effect_has_every_item_of_the_declaration() {
    let page = fs::read_to_string(workspace().join("docs/adding-an-effect.md")).unwrap();
    let declaration = workspace().join("host-sim/model/src/effects/declaration/effect_model.rs");
    let declaration = fs::read_to_string(declaration).unwrap();
    let item = |line: &str| {
        let line = line.trim_start();
        let rest = line.strip_prefix("fn ").or_else(|| line.strip_prefix("const "))?;
        Some(rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()?.to_owned())
    };
    let items: Vec<String> = declaration.lines().filter_map(item).collect();
    assert!(items.len() > 20, "{items:?}");
    let rows: Vec<&str> = page.lines().filter(|line| line.starts_with("| `")).collect();
    for item in items {
        assert!(rows.iter().any(|row| row.contains(&format!("`{item}`"))), "{item}");
    }
}
