//! The modules of a crate, and which module uses which.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use petgraph::algo::tarjan_scc;
use petgraph::graphmap::DiGraphMap;

use super::paths::Paths;

/// The files of a crate by module; the root is the empty path.
pub struct CrateSource {
    files: BTreeMap<Vec<String>, Paths>,
}

impl CrateSource {
    /// Reads all files of a folder.
    ///
    /// # Panics
    /// If one cannot be read.
    pub fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        collect(folder, "", &mut files);
        Self::parse(files.iter().map(|(module, text)| (module.as_str(), text.as_str())))
    }

    /// From modules, named as `a::b`, with their source texts.
    pub fn parse<'a>(files: impl Iterator<Item = (&'a str, &'a str)>) -> Self {
        let module =
            |name: &str| name.split("::").filter(|part| !part.is_empty()).map(str::to_owned).collect();
        Self { files: files.map(|(name, text)| (module(name), Paths::of(text))).collect() }
    }

    /// The paths of the modules.
    pub fn modules(&self) -> Vec<&Vec<String>> {
        self.files.keys().collect()
    }

    /// Circles among the children of each module and its own items. A child includes all modules inside it.
    pub fn circles(&self) -> Vec<Vec<String>> {
        let arrows = self.arrows();
        self.files.keys().flat_map(|parent| circles_below(parent, &arrows)).collect()
    }

    /// Pairs of modules of which the first uses the second.
    fn arrows(&self) -> BTreeSet<(Vec<String>, Vec<String>)> {
        let mut arrows = BTreeSet::new();
        for (module, paths) in &self.files {
            let targets = paths.used.iter().filter_map(|path| self.target(module, path, 0));
            arrows.extend(targets.filter(|target| target != module).map(|target| (module.clone(), target)));
        }
        arrows
    }

    /// The module of this crate that defines the item at a path; `None` for other crates.
    fn target(&self, module: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
        let mut at: Vec<String> = match path.first()?.as_str() {
            "crate" => Vec::new(),
            "super" => module.split_last()?.1.to_vec(),
            "self" => module.to_vec(),
            first if self.files.contains_key(&[module, &[first.to_owned()]].concat()) => {
                [module, &[first.to_owned()]].concat()
            }
            _ => return None,
        };
        for segment in &path[1..] {
            if segment == "super" {
                at.pop();
                continue;
            }
            let inside = [&at[..], std::slice::from_ref(segment)].concat();
            if self.files.contains_key(&inside) {
                at = inside;
                continue;
            }
            let re_export = self.files.get(&at)?.re_exports.iter().find(|(name, _)| name == segment);
            // The depth is limited because re-exports may form a ring.
            return match re_export {
                Some((_, origin)) if depth < 8 => self.target(&at, origin, depth + 1),
                _ => Some(at),
            };
        }
        Some(at)
    }
}

fn collect(folder: &Path, module: &str, files: &mut Vec<(String, String)>) {
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let inside = if module.is_empty() { name.to_owned() } else { format!("{module}::{name}") };
        if path.is_dir() {
            collect(&path, &inside, files);
        } else if path.extension().is_some_and(|end| end == "rs") && !path.ends_with("tests.rs") {
            let is_front = matches!(name, "lib" | "main" | "mod");
            let text = fs::read_to_string(&path).unwrap();
            files.push((if is_front { module.to_owned() } else { inside }, text));
        }
    }
}

/// The circles among a module's own items and its children.
fn circles_below(parent: &[String], arrows: &BTreeSet<(Vec<String>, Vec<String>)>) -> Vec<Vec<String>> {
    let child = |module: &[String]| {
        module.starts_with(parent).then(|| module.get(parent.len()).cloned().unwrap_or_default())
    };
    let between: BTreeSet<(String, String)> = arrows
        .iter()
        .filter_map(|(from, to)| Some((child(from)?, child(to)?)))
        .filter(|(from, to)| from != to)
        .collect();
    let graph: DiGraphMap<&str, ()> =
        between.iter().map(|(from, to)| (from.as_str(), to.as_str(), ())).collect();
    let name = |member: &&str| {
        let own = if member.is_empty() { "(own items)" } else { member };
        if parent.is_empty() { own.to_owned() } else { format!("{}::{own}", parent.join("::")) }
    };
    let tied = tarjan_scc(&graph).into_iter().filter(|modules| modules.len() > 1);
    tied.map(|modules| modules.iter().map(name).collect()).collect()
}
