//! What keeps an output from jumping when the law behind it is changed: an offset that fades.
//!
//! In the tick of the change the offset is what the output was less what the new law makes; then it decays as
//! e^(−t/T), T the time constant of the position loop, 1/Kp. While nothing was changed there is none, and the
//! output is the law's to the last bit.

use crate::scalar::Scalar;

/// The offset.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bump<S: Scalar> {
    state: State<S>,
}

#[derive(Clone, Copy, Debug, Default)]
enum State<S: Scalar> {
    #[default]
    None,
    /// The law has been changed: the output was this.
    Changed(S),
    Fading(S::Sum),
}

impl<S: Scalar> Bump<S> {
    /// Nothing has been changed.
    pub const NONE: Self = Self { state: State::None };

    /// Says that the law has been changed when its output was `last`.
    pub fn change(&mut self, last: S) {
        self.state = State::Changed(last);
    }

    /// The output for what the law makes. `share` of the offset fades in a tick.
    pub fn smooth(&mut self, share: S::Gain, made: S) -> S {
        let (left, output) = match self.state {
            State::None => return made,
            State::Changed(last) => ((last - made).widen(), last),
            State::Fading(left) => (left, made + S::round(left)),
        };
        let offset = S::round(left);
        self.state = if offset == S::default() { State::None } else { State::Fading(left - offset * share) };
        output
    }
}
