//! The vector table of a program, and its deepest stack with nested exceptions.

use std::collections::BTreeSet;
use std::ops::Range;

use super::depth::{Declared, Depth, Depths, Obstacle};
use super::image::Image;

/// Frame that the core pushes at an exception, bytes: 8 words, 18 of the floating-point unit, and one more where the
/// stack was not aligned to 8 (ARMv7-M reference manual, B1.5.6 and B1.5.7).
pub const EXCEPTION_FRAME: u32 = 4 * (8 + 18 + 1);

/// Exception numbers.
const RESET: usize = 1;
const NON_MASKABLE: usize = 2;
const HARD_FAULT: usize = 3;

/// The vector table.
pub struct Vectors {
    /// The stack pointer at reset.
    pub initial_sp: u32,
    /// Starts of the handlers by exception number: 1 is reset, 16 the first interrupt. 0: no handler.
    handlers: Vec<u32>,
}

/// The deepest stack of a program.
#[derive(Debug)]
pub struct WorstCase {
    /// Below the reset handler, without exceptions.
    pub thread: Depth,
    /// Below each handler that can be nested, without the frame that the core pushes.
    pub exceptions: Vec<Depth>,
}

impl Vectors {
    /// The table at an address, which is a whole section.
    ///
    /// # Panics
    /// Where no section begins there, or it is too short for reset and faults.
    #[must_use]
    pub fn read(image: &Image, address: u32) -> Self {
        let section = image.sections.iter().find(|section| section.address == address);
        let bytes = &section.expect("the vector table is a section").bytes;
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().expect("four"))).collect();
        assert!(words.len() > HARD_FAULT, "{} words are no vector table", words.len());
        // The lowest bit marks Thumb code.
        Self { initial_sp: words[0], handlers: words.iter().map(|word| word & !1).collect() }
    }

    /// Start of the handler of an exception by its number; 16 is the first interrupt.
    ///
    /// # Panics
    /// Where the table is shorter.
    #[must_use]
    pub fn handler(&self, number: usize) -> u32 {
        self.handlers[number]
    }

    /// Lowest address of the stack: the end of the static data below it, or the start of the RAM.
    #[must_use]
    pub fn stack_floor(&self, image: &Image, ram: &Range<u32>) -> u32 {
        let ends = image.data.iter().map(|range| range.end);
        ends.filter(|&end| end <= self.initial_sp).max().unwrap_or(ram.start)
    }

    /// The handlers except reset, each once.
    #[must_use]
    pub fn exceptions(&self) -> BTreeSet<u32> {
        self.handlers[NON_MASKABLE..].iter().copied().filter(|&handler| handler != 0).collect()
    }

    /// The deepest stack for any priorities: every handler interrupts another one at its deepest point, the first one
    /// the thread. A handler does not interrupt itself; hard fault and non-maskable interrupt may share their handler
    /// with others and are added.
    ///
    /// # Errors
    /// Everything that makes a depth unknown.
    pub fn worst_case(&self, image: &Image, declared: &Declared<'_>) -> Result<WorstCase, Vec<Obstacle>> {
        let configurable: BTreeSet<u32> =
            self.handlers[HARD_FAULT + 1..].iter().copied().filter(|&handler| handler != 0).collect();
        let above = [self.handlers[HARD_FAULT], self.handlers[NON_MASKABLE]];
        let exceptions: Vec<u32> = configurable.into_iter().chain(above).collect();
        let mut roots = exceptions.clone();
        roots.push(self.handlers[RESET]);
        let depths = Depths::new(image, &roots, declared)?;
        let below = |root: u32| depths.below(root);
        Ok(WorstCase {
            thread: below(self.handlers[RESET]),
            exceptions: exceptions.into_iter().map(below).collect(),
        })
    }
}

impl WorstCase {
    /// Bytes of thread and exceptions, all nested.
    #[must_use]
    pub fn bytes(&self) -> u32 {
        self.thread.bytes() + self.exceptions.iter().map(|depth| depth.bytes() + EXCEPTION_FRAME).sum::<u32>()
    }

    /// One line for the thread and for each exception: bytes, and the chain of calls with their frames.
    #[must_use]
    pub fn report(&self, image: &Image) -> String {
        let exceptions = self.exceptions.iter().map(|depth| (EXCEPTION_FRAME, depth));
        std::iter::once((0, &self.thread))
            .chain(exceptions)
            .map(|(pushed, depth)| format!("{:6} + {pushed:3} B: {}\n", depth.bytes(), depth.describe(image)))
            .collect()
    }
}
