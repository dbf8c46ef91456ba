//! The vector table of a program, and how deep the stack gets with every exception on top of another.

use std::collections::BTreeSet;
use std::ops::Range;

use super::depth::{Depth, Depths, Obstacle, SelfCall};
use super::image::Image;

/// What the core pushes when an exception begins, bytes: 8 words, 18 of the floating-point unit, and one
/// more where the stack was not aligned to 8 (ARMv7-M reference manual, B1.5.6 and B1.5.7).
pub const EXCEPTION_FRAME: u32 = 4 * (8 + 18 + 1);

/// Positions in the table.
const RESET: usize = 1;
const NON_MASKABLE: usize = 2;
const HARD_FAULT: usize = 3;

/// The vector table.
pub struct Vectors {
    /// The stack pointer at reset.
    pub initial_sp: u32,
    /// Starts of the handlers by their position: 1 is reset, 16 the first interrupt. 0: none.
    handlers: Vec<u32>,
}

/// The deepest stack of a program.
#[derive(Debug)]
pub struct WorstCase {
    /// From reset on, outside of exceptions.
    pub thread: Depth,
    /// Of every exception that can stand on top of another, without the frame that the core pushes.
    pub exceptions: Vec<Depth>,
}

impl Vectors {
    /// The table at an address, as long as its section.
    ///
    /// # Panics
    /// Where no section of the file begins there, or it holds no reset and no faults.
    #[must_use]
    pub fn read(image: &Image, address: u32) -> Self {
        let section = image.sections.iter().find(|section| section.address == address);
        let bytes = &section.expect("the vector table begins a section").bytes;
        let words: Vec<u32> =
            bytes.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().expect("four"))).collect();
        assert!(words.len() > HARD_FAULT, "{} words are no vector table", words.len());
        // The lowest bit says Thumb.
        Self { initial_sp: words[0], handlers: words.iter().map(|word| word & !1).collect() }
    }

    /// The handler of an exception by its number, 16 for the first interrupt.
    ///
    /// # Panics
    /// Where the table is shorter.
    #[must_use]
    pub fn handler(&self, number: usize) -> u32 {
        self.handlers[number]
    }

    /// Where the stack would grow into the static data: the end of what lies below it, or the start of the RAM.
    #[must_use]
    pub fn stack_floor(&self, image: &Image, ram: &Range<u32>) -> u32 {
        let ends = image.data.iter().map(|range| range.end);
        ends.filter(|&end| end <= self.initial_sp).max().unwrap_or(ram.start)
    }

    /// Every handler but that of reset, once.
    #[must_use]
    pub fn exceptions(&self) -> BTreeSet<u32> {
        self.handlers[NON_MASKABLE..].iter().copied().filter(|&handler| handler != 0).collect()
    }

    /// The deepest stack, whatever the priorities: each handler interrupts another one, deepest in it, and
    /// the deepest place of what runs from reset on. A handler does not interrupt itself, but the hard fault
    /// and the non-maskable interrupt come on top of a handler that they may share with others.
    ///
    /// # Errors
    /// All that makes a depth unknown.
    pub fn worst_case(&self, image: &Image, self_calls: &[SelfCall]) -> Result<WorstCase, Vec<Obstacle>> {
        let configurable: BTreeSet<u32> =
            self.handlers[HARD_FAULT + 1..].iter().copied().filter(|&handler| handler != 0).collect();
        let above = [self.handlers[HARD_FAULT], self.handlers[NON_MASKABLE]];
        let exceptions: Vec<u32> = configurable.into_iter().chain(above).collect();
        let mut roots = exceptions.clone();
        roots.push(self.handlers[RESET]);
        let depths = Depths::new(image, &roots, self_calls)?;
        let below = |root: u32| depths.below(root);
        Ok(WorstCase {
            thread: below(self.handlers[RESET]),
            exceptions: exceptions.into_iter().map(below).collect(),
        })
    }
}

impl WorstCase {
    /// All on top of each other, bytes.
    #[must_use]
    pub fn bytes(&self) -> u32 {
        self.thread.bytes() + self.exceptions.iter().map(|depth| depth.bytes() + EXCEPTION_FRAME).sum::<u32>()
    }

    /// One line for reset and for each exception: bytes, and the calls with their frames.
    #[must_use]
    pub fn report(&self, image: &Image) -> String {
        let exceptions = self.exceptions.iter().map(|depth| (EXCEPTION_FRAME, depth));
        std::iter::once((0, &self.thread))
            .chain(exceptions)
            .map(|(pushed, depth)| format!("{:6} + {pushed:3} B: {}\n", depth.bytes(), depth.calls(image)))
            .collect()
    }
}
