//! The paths in a source file that may lead to another module.

use syn::visit::{self, Visit};
use syn::{Attribute, Item, UseTree};

/// The paths of a file.
#[derive(Debug, Default)]
pub struct Paths {
    /// Paths of imports and of expressions, types and patterns, in segments.
    pub used: Vec<Vec<String>>,
    /// Re-exported names, with their paths.
    pub re_exports: Vec<(String, Vec<String>)>,
}

impl Paths {
    /// The paths in the text of a file, without its tests.
    ///
    /// # Panics
    /// If the text is not Rust.
    pub fn of(text: &str) -> Self {
        let mut paths = Self::default();
        paths.visit_file(&syn::parse_file(text).unwrap());
        paths
    }

    fn import(&mut self, tree: &UseTree, prefix: &[String], is_re_export: bool) {
        let with = |segment: String| [prefix, &[segment]].concat();
        match tree {
            UseTree::Path(path) => self.import(&path.tree, &with(path.ident.to_string()), is_re_export),
            UseTree::Group(group) => {
                group.items.iter().for_each(|item| self.import(item, prefix, is_re_export));
            }
            UseTree::Glob(_) => self.used.push(prefix.to_vec()),
            UseTree::Name(name) => self.named(with(name.ident.to_string()), &name.ident, is_re_export),
            UseTree::Rename(name) => self.named(with(name.ident.to_string()), &name.rename, is_re_export),
        }
    }

    fn named(&mut self, mut path: Vec<String>, name: &syn::Ident, is_re_export: bool) {
        // `self` at the end of a group is the module before it.
        if path.len() > 1 && path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        if is_re_export {
            self.re_exports.push((name.to_string(), path));
        } else {
            self.used.push(path);
        }
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let tokens = match &attribute.meta {
            syn::Meta::List(list) if list.path.is_ident("cfg") => list.tokens.to_string(),
            _ => return false,
        };
        tokens == "test"
    })
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item(&mut self, item: &'ast Item) {
        let attributes = match item {
            Item::Mod(module) => &module.attrs,
            Item::Fn(function) => &function.attrs,
            Item::Use(import) => &import.attrs,
            Item::Impl(block) => &block.attrs,
            Item::Const(constant) => &constant.attrs,
            _ => return visit::visit_item(self, item),
        };
        if !is_test(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, import: &'ast syn::ItemUse) {
        let is_re_export = !matches!(import.vis, syn::Visibility::Inherited);
        self.import(&import.tree, &[], is_re_export);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 {
            self.used.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}
