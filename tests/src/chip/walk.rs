//! The functions that can be reached from some, by the calls and jumps that their bytes hold.

use std::collections::{BTreeMap, BTreeSet};

use super::image::Image;
use super::thumb::{Flow, decode};

/// What a walk found. Places are addresses of instructions.
#[derive(Debug, Default)]
pub struct Walk {
    /// Every function that was reached, with the one that it was first reached from.
    pub reached: BTreeMap<u32, Option<u32>>,
    /// For each of them, the functions that it calls or jumps to.
    pub calls: BTreeMap<u32, BTreeSet<u32>>,
    /// How many instructions these functions have.
    pub instructions: usize,
    /// Calls and jumps through a register.
    pub indirect: BTreeSet<u32>,
    /// Instructions that are undefined on purpose.
    pub traps: BTreeSet<u32>,
    /// Jumps to where there is no function.
    pub lost: BTreeSet<u32>,
}

/// Walks from the given functions. Every instruction of a function counts as reached.
///
/// # Panics
/// Where one of the addresses is not the start of a function.
#[must_use]
pub fn walk(image: &Image, roots: &[u32]) -> Walk {
    let mut walk = Walk::default();
    let mut waiting: Vec<(u32, Option<u32>)> = roots.iter().map(|&root| (root, None)).collect();
    while let Some((start, from)) = waiting.pop() {
        if walk.reached.contains_key(&start) {
            continue;
        }
        walk.reached.insert(start, from);
        let calls = walk.calls.entry(start).or_default();
        let end = image.functions[&start].end;
        for (at, high, low) in instructions(image, start) {
            walk.instructions += 1;
            match decode(at, high, low).0 {
                Flow::To(target) if (start..end).contains(&target) => {}
                Flow::To(target) | Flow::Call(target) => match image.function_at(target) {
                    Some((function, _)) => {
                        calls.insert(function);
                        waiting.push((function, Some(start)));
                    }
                    None => _ = walk.lost.insert(at),
                },
                Flow::Indirect => _ = walk.indirect.insert(at),
                Flow::Trap => _ = walk.traps.insert(at),
                Flow::On => {}
            }
        }
    }
    walk
}

/// The instructions of a function, each with its address and its two halfwords, data left out.
///
/// # Panics
/// Where the address is not the start of a function.
pub fn instructions(image: &Image, start: u32) -> impl Iterator<Item = (u32, u16, u16)> {
    let end = image.functions[&start].end;
    let mut next = start;
    std::iter::from_fn(move || {
        while next < end && !image.is_code(next) {
            next += 2;
        }
        let at = next;
        let (high, low) = (image.half(at).unwrap_or(0), image.half(at + 2).unwrap_or(0));
        next += decode(at, high, low).1;
        (at < end).then_some((at, high, low))
    })
}

impl Walk {
    /// The reached functions of the panic machinery, each with the calls that lead there.
    #[must_use]
    pub fn panics(&self, image: &Image) -> Vec<String> {
        let is_panic = |start: &&u32| image.functions[start].names.iter().any(|name| panics(name));
        self.reached.keys().filter(is_panic).map(|&start| self.way_to(image, start)).collect()
    }

    fn way_to(&self, image: &Image, start: u32) -> String {
        let mut way = vec![start];
        while let Some(&Some(from)) = way.last().and_then(|last| self.reached.get(last)) {
            way.push(from);
        }
        let names: Vec<_> = way.iter().rev().map(|start| image.functions[start].names[0].as_str()).collect();
        names.join(" → ")
    }
}

/// Whether a function is one that only a panic runs, mangled either way.
#[must_use]
pub fn panics(name: &str) -> bool {
    [
        "panicking",
        "panic_fmt",
        "rust_begin_unwind",
        "unwrap_failed",
        "expect_failed",
        "slice_index_fail",
        "slice_error_fail",
    ]
    .iter()
    .any(|part| name.contains(part))
}
