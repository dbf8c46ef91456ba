//! Static analysis of a program of the chip: its functions, the effects of its instructions, its call graph.
//!
//! [`image`] reads the ELF file, [`thumb`], [`mod@pointer`] and [`memory`] decode instructions; [`walk`] follows all calls,
//! [`virtual_calls`] finds the targets of calls through a trait object, [`depth`] sums stack frames over them, and [`vectors`] adds the exceptions.

pub mod depth;
pub mod image;
pub mod memory;
pub mod pointer;
pub mod thumb;
pub mod vectors;
pub mod virtual_calls;
pub mod walk;
