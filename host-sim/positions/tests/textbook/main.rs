//! Positioning tests from textbook formulas, which are written here and share no code with the crate, with known parts and noise.

#![expect(clippy::unwrap_used, reason = "in a test, a value that is not there is the failure")]

mod drift;
mod generator;
mod properties;
mod quiet;
mod recovered;
mod waves;
