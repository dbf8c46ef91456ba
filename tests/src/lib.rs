//! Parts that several integration tests share.
//!
//! [`program`] builds `lost-motion`, [`cases`] finds the blind cases in the folder of [`data`]; [`firmware`] builds the
//! programs of the chip, [`chip`] analyses them, and [`board`] runs them on an emulated chip through [`gdb`]; [`listed`] is
//! for tests that are compared with a catalogue, [`tables`] for those that are compared with a document.

pub mod board;
pub mod cases;
pub mod chip;
pub mod data;
pub mod firmware;
pub mod gdb;
pub mod listed;
pub mod program;
pub mod tables;
