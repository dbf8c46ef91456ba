//! Calls through the table of a trait object: which functions they may reach.
//!
//! A call through a register says nothing about its target. Where the trait is known, the target is in the table of a type that
//! implements it: three words (drop, size, alignment), then the addresses of all methods. The tables are found in the constants of
//! the linked program; every function in one of them counts as called.

use std::collections::BTreeSet;

use super::image::{Image, Section};

/// Functions whose calls through registers are calls of the methods of a trait.
#[derive(Clone, Copy, Debug)]
pub struct VirtualCalls {
    /// Parts of the mangled names of the functions.
    pub callers: &'static [&'static str],
    /// Part of the mangled name of a method of each type, which no other function has.
    pub method: &'static str,
    /// Number of methods of the trait.
    pub methods: usize,
}

impl VirtualCalls {
    /// Whether the calls of a function are such calls.
    #[must_use]
    pub fn are_in(&self, image: &Image, function: u32) -> bool {
        let has = |name: &String| self.callers.iter().any(|part| name.contains(part));
        image.functions[&function].names.iter().any(has)
    }

    /// The functions in the tables of all types. `None` if there is no table, or one with too few functions.
    #[must_use]
    pub fn targets(&self, image: &Image) -> Option<BTreeSet<u32>> {
        let with_method = |table: &Vec<u32>| {
            table
                .iter()
                .any(|start| image.functions[start].names.iter().any(|name| name.contains(self.method)))
        };
        let tables: Vec<_> = tables(image).into_iter().filter(with_method).collect();
        let complete = !tables.is_empty() && tables.iter().all(|table| table.len() >= self.methods);
        complete.then(|| tables.into_iter().flatten().collect())
    }
}

/// Stretches of addresses of functions, word by word, in the sections without code.
fn tables(image: &Image) -> Vec<Vec<u32>> {
    let has_code = |section: &&Section| {
        let end = section.address + u32::try_from(section.bytes.len()).expect("32 bit");
        image.functions.range(section.address..end).next().is_some()
    };
    let mut tables = Vec::new();
    for section in image.sections.iter().filter(|section| !has_code(section)) {
        let mut table = Vec::new();
        for word in section.bytes.chunks_exact(4) {
            let word = u32::from_le_bytes(word.try_into().expect("four"));
            // The lowest bit marks Thumb code.
            if word & 1 == 1 && image.functions.contains_key(&(word & !1)) {
                table.push(word & !1);
            } else if !table.is_empty() {
                tables.push(std::mem::take(&mut table));
            }
        }
        tables.extend((!table.is_empty()).then_some(table));
    }
    tables
}
