//! The identity of effects of the same name on one axis.

use super::stage::Channel;

/// Whether an axis may have an effect more than once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occurrence {
    /// At most once: two of them would not add up.
    Once,
    /// Any number of times: their contributions add up.
    Repeated,
}

/// The property that distinguishes effects of the same name on one axis.
#[derive(Clone, Copy, Debug)]
pub enum Distinction<'a> {
    /// None: it is the same effect.
    None,
    /// Name of the axis that causes the effect.
    Source(&'a str),
    /// The channel on which the effect acts.
    Channel(Channel),
    /// Period, mm.
    Period(f64),
    /// Frequency, Hz.
    Frequency(f64),
    /// Time constant, s.
    TimeConstant(f64),
}

impl PartialEq for Distinction<'_> {
    fn eq(&self, other: &Self) -> bool {
        /// Largest relative difference of equal periods, caused by the rounding of a written number.
        const SAME_PERIOD: f64 = 1e-6;
        /// Factor within which modes are the same: two closer ones are not told apart from one with more damping.
        const SAME_FREQUENCY: f64 = 1.2;
        /// Factor within which time constants are the same: a sum of two closer exponentials is hardly told from one.
        const SAME_TIME: f64 = 3.0;
        let is_within = |a: &f64, b: &f64, factor: f64| a.max(*b) < factor * a.min(*b);
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Source(a), Self::Source(b)) => a == b,
            (Self::Channel(a), Self::Channel(b)) => a == b,
            (Self::Frequency(a), Self::Frequency(b)) => is_within(a, b, SAME_FREQUENCY),
            (Self::TimeConstant(a), Self::TimeConstant(b)) => is_within(a, b, SAME_TIME),
            (Self::Period(a), Self::Period(b)) => (a - b).abs() <= SAME_PERIOD * a.abs(),
            _ => false,
        }
    }
}

impl<'a> Distinction<'a> {
    /// Name of the axis that causes the effect, if it is another axis.
    #[must_use]
    pub const fn source(self) -> Option<&'a str> {
        match self {
            Self::Source(source) => Some(source),
            _ => None,
        }
    }
}
