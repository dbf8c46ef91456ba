//! No two modules of a crate depend on each other.
//!
//! A module uses another one if a path in its source, outside of tests, leads there. A parent that only declares and
//! re-exports its children does not use them; a name that it re-exports leads to the child that defines it.

mod crate_source;
pub mod paths;

use std::path::Path;

use crate_source::CrateSource;

/// The crates of the workspace, by folder, without the integration tests, which are programs of their own.
fn crates(workspace: &Path) -> Vec<String> {
    let manifest = std::fs::read_to_string(workspace.join("Cargo.toml")).unwrap();
    let members = manifest.split_once("\nmembers = [").unwrap().1.split_once(']').unwrap().0;
    let names = members.split(',').map(|member| member.trim().trim_matches('"'));
    let names: Vec<String> =
        names.filter(|name| !name.is_empty() && *name != "tests").map(str::to_owned).collect();
    assert!(names.iter().any(|name| name == "shared"), "{names:?}");
    names
}

#[test]
fn modules_of_a_crate_do_not_depend_on_each_other() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut found = Vec::new();
    for folder in crates(workspace) {
        let source = CrateSource::read(&workspace.join(&folder).join("src"));
        assert!(source.modules().len() > 1, "{folder}: no modules were read");
        found.extend(source.circles().into_iter().map(|circle| format!("{folder}: {}", circle.join(" -> "))));
    }
    assert!(found.is_empty(), "modules that depend on each other:\n{}", found.join("\n"));
}

/// Each of these sources has one circle, except the last, whose second path is in a test.
#[test]
fn a_circle_is_found_through_every_kind_of_path() {
    let circles = |files: &[(&str, &str)]| CrateSource::parse(files.iter().copied()).circles().len();
    let root = ("", "mod a; mod b;");
    assert_eq!(circles(&[root, ("a", "use crate::b::B; pub struct A;"), ("b", "use super::a::A;")]), 1);
    assert_eq!(circles(&[root, ("a", "use crate::b; fn f() {}"), ("b", "fn g() { crate::a::f() }")]), 1);
    // Through names that the parent re-exports.
    let parent = ("", "mod a; mod b; pub use a::A; pub use b::B;");
    assert_eq!(
        circles(&[parent, ("a", "use crate::B; pub struct A;"), ("b", "use crate::A; pub struct B;")]),
        1
    );
    // A parent's own item, used by a child that the parent uses.
    assert_eq!(circles(&[("", "mod a; struct Own; fn f() { a::g() }"), ("a", "use super::Own;")]), 1);
    // Between modules inside two folders.
    let deep = [root, ("a", "mod c;"), ("a::c", "use crate::b::B;"), ("b", "use crate::a::c::C;")];
    assert_eq!(circles(&deep), 1);
    assert_eq!(
        circles(&[root, ("a", "use crate::b::B;"), ("b", "#[cfg(test)] mod tests { use crate::a; }")]),
        0
    );
}
