//! Whether the reading of a linear scale can be used, by the input that tells whether the scale has a signal.
//!
//! An incremental scale without a signal counts no edges. When the signal returns, its reading is wrong by an unknown distance, and a
//! loop on it would move the axis there. A scale that has lost its signal is therefore not read again until the next start.
//!
//! # Example
//!
//! ```
//! use shared::feedback::ScaleSignal;
//!
//! let mut signal = ScaleSignal::NEW;
//! // The supply of the scale may come after that of the board.
//! let usable = [false, true, true, false, true].map(|present| signal.update(present));
//! assert_eq!(usable, [false, true, true, false, false]);
//! ```

/// The signal of a linear scale since the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleSignal {
    /// There was none yet.
    Waiting,
    /// It has been there without an interruption.
    Present,
    /// It was there, and was interrupted.
    Lost,
}

impl ScaleSignal {
    /// At the start.
    pub const NEW: Self = Self::Waiting;

    /// Takes whether there is a signal, once in a tick. Returns whether the scale can be read.
    pub const fn update(&mut self, is_present: bool) -> bool {
        *self = match (*self, is_present) {
            (Self::Waiting | Self::Present, true) => Self::Present,
            (Self::Waiting, false) => Self::Waiting,
            (Self::Present | Self::Lost, false) | (Self::Lost, true) => Self::Lost,
        };
        matches!(self, Self::Present)
    }
}
