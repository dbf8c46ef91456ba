//! Interpolation: from blocks in SI to a command position per axis and position tick, in integers.
//!
//! | step | module | computes |
//! |---|---|---|
//! | 1 | [`block`] | what a program gives: a line, an arc or a dwell, with feed, acceleration, ramps and joint |
//! | 2 | [`mod@line`], [`arc`] | axis positions over path length; [`sincos`] is the sine and cosine of an arc |
//! | 3 | [`limits`] | speed, acceleration and jerk of the block per tick, lowered on an arc |
//! | 4 | [`joint`] | how fast the path may pass from one block to the next |
//! | 5 | [`ramp`], [`profile`], [`exponential`] | path length over time, with limited jerk or as a first-order lag |
//! | 6 | [`planned`], [`path`] | a block ready to run; the queue, look-ahead and the stop along the path |
//! | 7 | [`smooth`] | a filter per axis behind the path (acceleration after interpolation) |
//!
//! Steps 1 to 5 run when a block is queued ([`Path::push`]), 6 and 7 with every command ([`Path::advance`]).
//!
//! # Example
//!
//! 10 mm at 0.1 m/s and 2 m/s² with a command every millisecond: v/a = 50 ms for each ramp, which cover 2.5 mm
//! each, and 50 ms at constant speed: 150 ms.
//!
//! ```
//! use shared::interpolate::{Block, Path};
//! use shared::units::Position;
//!
//! let mut path = Path::new([Position(0)], 1000.0);
//! path.push(&Block::line([0.01], 0.1, 2.0))?;
//! let mut ticks = 0;
//! while !path.is_done() {
//!     path.advance();
//!     ticks += 1;
//! }
//! assert!((150..=152).contains(&ticks));
//! assert_eq!(path.command(), [Position::from_m(0.01).unwrap()]);
//! # Ok::<(), shared::interpolate::PathError>(())
//! ```

pub mod arc;
pub mod block;
pub mod error;
pub mod exponential;
pub mod feed_hold;
pub mod following;
mod fraction;
pub mod joint;
pub mod limits;
pub mod line;
pub mod path;
pub mod planned;
pub mod profile;
pub mod ramp;
pub mod sincos;
pub mod smooth;

pub use block::{Block, BlockOf, Joint, Ramps};
pub use error::{Field, PathError};
pub use path::Path;
pub use smooth::Smoothing;
