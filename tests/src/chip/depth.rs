//! Stack depth below a function: frames, summed over the chain of calls that needs most.
//!
//! A frame is the sum of all decrements of the stack pointer in the instructions of a function, whether they run or
//! not. A tail call therefore counts with the whole frame of its caller, which may have been released before: the sum
//! is an upper bound.

use std::collections::BTreeMap;

use super::image::Image;
use super::pointer::{Pointer, constant, pointer, upper_half};
use super::thumb::{Flow, decode};
use super::virtual_calls::VirtualCalls;
use super::walk::{instructions, walk_with};

/// Why a depth is unknown, with addresses of instructions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A call or jump through a register.
    Indirect(u32),
    /// A call or jump to an address without a function.
    NoFunction(u32),
    /// The stack pointer is set, or lowered by an unknown number of bytes.
    Unknown(u32),
    /// The stack pointer is lowered inside a loop.
    Looped(u32),
    /// Functions in or above a recursion, by their starts.
    Recursion(Vec<u32>),
}

/// A function that calls itself with a known limit.
#[derive(Clone, Copy, Debug)]
pub struct SelfCall {
    /// Part of its mangled name.
    pub name: &'static str,
    /// Most frames of it at a time.
    pub frames: u32,
}

/// What is known of a program beside its instructions.
#[derive(Clone, Copy, Debug)]
pub struct Declared<'a> {
    /// Functions that call themselves.
    pub self_calls: &'a [SelfCall],
    /// Functions that call the methods of a trait.
    pub virtual_calls: &'a [VirtualCalls],
}

impl Declared<'_> {
    /// Nothing.
    pub const NONE: Self = Self { self_calls: &[], virtual_calls: &[] };
}

/// The deepest chain of calls below a function.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Depth {
    /// Start and frame, in bytes, of each function of the chain.
    pub chain: Vec<(u32, u32)>,
}

/// Stack of a function, bytes.
struct Known {
    frame: u32,
    /// Frame and deepest callee.
    total: u32,
    /// Start of the deepest callee.
    deepest: Option<u32>,
}

/// The stack of each reachable function, with that of its callees.
pub struct Depths(BTreeMap<u32, Known>);

impl Depths {
    /// Sums the frames of all functions that are reachable from `roots` (starts), the frames of functions that call
    /// themselves as often as they may.
    ///
    /// # Errors
    /// Everything that makes a depth unknown.
    ///
    /// # Panics
    /// Where one of the addresses is not the start of a function.
    pub fn new(image: &Image, roots: &[u32], declared: &Declared<'_>) -> Result<Self, Vec<Obstacle>> {
        let mut walk = walk_with(image, roots, declared.virtual_calls);
        let mut obstacles: Vec<_> = walk.indirect.iter().copied().map(Obstacle::Indirect).collect();
        obstacles.extend(walk.without_function.iter().copied().map(Obstacle::NoFunction));
        let mut frames = BTreeMap::new();
        for &start in walk.reached.keys() {
            match frame(image, start) {
                Ok(bytes) => _ = frames.insert(start, bytes),
                Err(obstacle) => obstacles.push(obstacle),
            }
        }
        if !obstacles.is_empty() {
            return Err(obstacles);
        }
        for (&start, bytes) in &mut frames {
            let of = |call: &&SelfCall| name(image, start).contains(call.name);
            if let (Some(call), Some(calls)) =
                (declared.self_calls.iter().find(of), walk.calls.get_mut(&start))
            {
                calls.remove(&start);
                *bytes *= call.frames;
            }
        }
        let mut depths = Self(BTreeMap::new());
        // Callees first: a function is added when all its callees are known, which a recursion never is.
        while depths.0.len() < frames.len() {
            let known = depths.0.len();
            for (&start, &frame) in &frames {
                let calls = &walk.calls[&start];
                if !depths.0.contains_key(&start) && calls.iter().all(|call| depths.0.contains_key(call)) {
                    let deepest = calls.iter().copied().max_by_key(|call| depths.0[call].total);
                    let below = deepest.map_or(0, |call| depths.0[&call].total);
                    depths.0.insert(start, Known { frame, total: frame + below, deepest });
                }
            }
            if depths.0.len() == known {
                let unknown = |start: &&u32| !depths.0.contains_key(start);
                return Err(vec![Obstacle::Recursion(frames.keys().filter(unknown).copied().collect())]);
            }
        }
        Ok(depths)
    }

    /// The deepest chain of calls below a function.
    ///
    /// # Panics
    /// Where the function is not reachable from the roots.
    #[must_use]
    pub fn below(&self, start: u32) -> Depth {
        let mut chain = Vec::new();
        let mut next = Some(start);
        while let Some(at) = next {
            chain.push((at, self.0[&at].frame));
            next = self.0[&at].deepest;
        }
        Depth { chain }
    }
}

impl Depth {
    /// Sum of all frames, bytes.
    #[must_use]
    pub fn bytes(&self) -> u32 {
        self.chain.iter().map(|(_, frame)| frame).sum()
    }

    /// The functions of the chain with their frames in bytes.
    #[must_use]
    pub fn describe(&self, image: &Image) -> String {
        let names: Vec<_> =
            self.chain.iter().map(|(start, frame)| format!("{} {frame}", name(image, *start))).collect();
        names.join(" → ")
    }
}

impl Obstacle {
    /// The obstacle and the name of its function.
    #[must_use]
    pub fn describe(&self, image: &Image) -> String {
        let location = |at: &u32| format!("{at:#x} in {}", name(image, *at));
        match self {
            Self::Indirect(at) => format!("a call through a register at {}", location(at)),
            Self::NoFunction(at) => format!("a jump to an address without a function at {}", location(at)),
            Self::Unknown(at) => format!("an unknown stack pointer at {}", location(at)),
            Self::Looped(at) => format!("a stack pointer lowered in a loop at {}", location(at)),
            Self::Recursion(starts) => {
                let names: Vec<_> = starts.iter().map(|start| name(image, *start)).collect();
                format!("a recursion in or above {}", names.join(", "))
            }
        }
    }
}

fn name(image: &Image, at: u32) -> &str {
    image.function_at(at).and_then(|(_, function)| function.names.first()).map_or("?", String::as_str)
}

/// Sum of all decrements of the stack pointer in a function, bytes.
fn frame(image: &Image, start: u32) -> Result<u32, Obstacle> {
    let (mut total, mut lowered, mut jumps_back) = (0, Vec::new(), Vec::new());
    let mut before: [(u16, u16); 2] = Default::default();
    for (at, high, low) in instructions(image, start) {
        let bytes = match pointer(high, low) {
            Pointer::Kept | Pointer::Raised => 0,
            Pointer::Lowered(bytes) => bytes,
            Pointer::LoweredBy(register) => value(before, register).ok_or(Obstacle::Unknown(at))?,
            Pointer::Set => return Err(Obstacle::Unknown(at)),
        };
        if bytes > 0 {
            total += bytes;
            lowered.push(at);
        }
        if let Flow::To(target) = decode(at, high, low).0
            && (start..at).contains(&target)
        {
            jumps_back.push((target, at));
        }
        before = [before[1], (high, low)];
    }
    let looped = |at: &&u32| jumps_back.iter().any(|(target, from)| (*target..*from).contains(*at));
    lowered.iter().find(looped).map_or(Ok(total), |&at| Err(Obstacle::Looped(at)))
}

/// The constant that the two preceding instructions have loaded into a register.
fn value([first, last]: [(u16, u16); 2], register: u32) -> Option<u32> {
    match upper_half(last.0, last.1, register) {
        Some(upper) => Some(upper << 16 | constant(first.0, first.1, register)?),
        None => constant(last.0, last.1, register),
    }
}
