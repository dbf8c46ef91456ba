//! Recording of all channels of an axis: command, motor, table and force.
//!
//! A recorded value is a whole number of steps of its channel ([`quantiser`]): of an encoder count, of 1/16 nm for the command.
//! A sample is stored as the difference from what the previous samples predict ([`prediction`]), in groups of four bits
//! ([`nibbles`]). Nothing is lost: [`Decoder`] returns the numbers that [`Encoder`] was given. A motion takes about four bytes
//! per axis and sample, so that the RAM of a small chip holds half a second at 20 kHz ([`memory`]).
//!
//! # Example
//!
//! ```
//! use shared::capture::{Decoder, Encoder};
//!
//! let samples = [[[0, 10, 20, -5]], [[160, 11, 22, 3]], [[160, 12, 24, 900]]];
//! let mut bytes = [0; 64];
//! let mut encoder = Encoder::<1>::new(1);
//! for sample in &samples {
//!     assert!(encoder.append(sample, &mut bytes));
//! }
//! assert_eq!(encoder.length(), 13);
//! let mut decoder = Decoder::<1>::new(1, &bytes[..13]);
//! for sample in &samples {
//!     assert_eq!(decoder.next_sample(), Some(*sample));
//! }
//! ```

pub mod memory;
pub mod nibbles;
pub mod prediction;
pub mod quantiser;

mod codec;

pub use codec::{Decoder, Encoder, LONGEST_SAMPLE_NIBBLES};
pub use memory::{CaptureMemory, CaptureState, Trigger};
pub use quantiser::{ChannelSteps, Quantisers};

/// Channels of an axis.
pub const CHANNELS: usize = 4;

/// Index of the position command in a sample.
pub const COMMAND: usize = 0;
/// Index of the motor reading.
pub const MOTOR: usize = 1;
/// Index of the reading of the linear scale.
pub const TABLE: usize = 2;
/// Index of the force that acted during the tick that ends at the sample.
pub const FORCE: usize = 3;

/// The value of a channel that has no reading, such as a lost scale. No position is as large.
pub const NO_READING: i64 = i64::MIN;

/// The values of every channel of N axes at one tick, in steps.
pub type Sample<const N: usize> = [[i64; CHANNELS]; N];
