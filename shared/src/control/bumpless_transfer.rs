//! Bumpless transfer: a decaying offset that prevents a jump of an output when the law behind it changes.
//!
//! In the tick of the change the offset is the previous output minus the output of the new law. It then decays as
//! e^(−Kp·t), with the time constant of the position loop. Without a change the output is that of the law, bit for
//! bit.
//!
//! # Example
//!
//! The law goes from 100 to 60 while half of the offset decays per tick.
//!
//! ```
//! use shared::control::bumpless_transfer::BumplessTransfer;
//!
//! let mut transfer = BumplessTransfer::<f64>::INACTIVE;
//! assert_eq!(transfer.apply(0.5, 100.0), 100.0);
//! transfer.start(100.0);
//! let outputs = [60.0; 4].map(|law| transfer.apply(0.5, law));
//! assert_eq!(outputs, [100.0, 80.0, 70.0, 65.0]);
//! ```

use crate::scalar::Scalar;

/// The offset of one output.
#[derive(Clone, Copy, Debug, Default)]
pub struct BumplessTransfer<S: Scalar> {
    state: State<S>,
}

#[derive(Clone, Copy, Debug, Default)]
enum State<S: Scalar> {
    #[default]
    Inactive,
    /// The law has been changed; its last output.
    Changed(S),
    /// The offset that remains.
    Decaying(S::Sum),
}

impl<S: Scalar> BumplessTransfer<S> {
    /// No offset.
    pub const INACTIVE: Self = Self { state: State::Inactive };

    /// Starts a transfer: the law is about to change, and its last output was `last`.
    pub fn start(&mut self, last: S) {
        self.state = State::Changed(last);
    }

    /// The output for the output of the law. The fraction `decay` of the offset decays per tick.
    pub fn apply(&mut self, decay: S::Gain, law: S) -> S {
        let (remaining, output) = match self.state {
            State::Inactive => return law,
            State::Changed(last) => ((last - law).widen(), last),
            State::Decaying(remaining) => (remaining, law + S::round(remaining)),
        };
        let offset = S::round(remaining);
        self.state = if offset == S::default() {
            State::Inactive
        } else {
            State::Decaying(remaining - offset * decay)
        };
        output
    }
}
