//! The call graph: functions that are reachable from given ones by the calls and jumps in their code.

use std::collections::{BTreeMap, BTreeSet};

use super::image::Image;
use super::thumb::{Flow, decode};
use super::virtual_calls::VirtualCalls;

/// Results of a walk, with addresses of instructions.
#[derive(Debug, Default)]
pub struct Walk {
    /// Every reachable function, with the function from which it was reached first.
    pub reached: BTreeMap<u32, Option<u32>>,
    /// The functions that each of them calls or jumps to.
    pub calls: BTreeMap<u32, BTreeSet<u32>>,
    /// Number of instructions of these functions.
    pub instructions: usize,
    /// Calls and jumps through a register.
    pub indirect: BTreeSet<u32>,
    /// Traps.
    pub traps: BTreeSet<u32>,
    /// Calls and jumps to addresses without a function.
    pub without_function: BTreeSet<u32>,
}

/// Walks from the functions that start at `roots`. Every instruction of a function counts as reachable.
///
/// # Panics
/// Where one of the addresses is not the start of a function.
#[must_use]
pub fn walk(image: &Image, roots: &[u32]) -> Walk {
    walk_with(image, roots, &[])
}

/// The same, with the calls through registers in some functions known as calls of the methods of a trait.
///
/// # Panics
/// Where one of the addresses is not the start of a function.
#[must_use]
pub fn walk_with(image: &Image, roots: &[u32], virtual_calls: &[VirtualCalls]) -> Walk {
    let mut walk = Walk::default();
    let mut waiting: Vec<(u32, Option<u32>)> = roots.iter().map(|&root| (root, None)).collect();
    while let Some((start, from)) = waiting.pop() {
        if walk.reached.contains_key(&start) {
            continue;
        }
        walk.reached.insert(start, from);
        let calls = walk.calls.entry(start).or_default();
        let end = image.functions[&start].end;
        let targets = virtual_calls.iter().find(|calls| calls.are_in(image, start));
        let targets = targets.and_then(|calls| calls.targets(image));
        for (at, high, low) in instructions(image, start) {
            walk.instructions += 1;
            match decode(at, high, low).0 {
                Flow::To(target) if (start..end).contains(&target) => {}
                Flow::To(target) | Flow::Call(target) => match image.function_at(target) {
                    Some((function, _)) => {
                        calls.insert(function);
                        waiting.push((function, Some(start)));
                    }
                    None => _ = walk.without_function.insert(at),
                },
                Flow::Indirect => match &targets {
                    Some(targets) => {
                        calls.extend(targets);
                        waiting.extend(targets.iter().map(|target| (*target, Some(start))));
                    }
                    None => _ = walk.indirect.insert(at),
                },
                Flow::Trap => _ = walk.traps.insert(at),
                Flow::Next => {}
            }
        }
    }
    walk
}

/// The instructions of a function, each with its address and two halfwords, without the data between them.
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
    /// The chains of calls to the reachable functions of the panic machinery.
    #[must_use]
    pub fn panics(&self, image: &Image) -> Vec<String> {
        let panics = |start: &&u32| image.functions[start].names.iter().any(|name| is_panic(name));
        self.reached.keys().filter(panics).map(|&start| self.chain_to(image, start)).collect()
    }

    fn chain_to(&self, image: &Image, start: u32) -> String {
        let mut chain = vec![start];
        while let Some(&Some(from)) = chain.last().and_then(|last| self.reached.get(last)) {
            chain.push(from);
        }
        let names: Vec<_> =
            chain.iter().rev().map(|start| image.functions[start].names[0].as_str()).collect();
        names.join(" → ")
    }
}

/// Whether a function, by its mangled name, belongs to the panic machinery.
#[must_use]
pub fn is_panic(name: &str) -> bool {
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
