//! What tells two effects of one name apart, and whether an axis may have both.

use super::stage::Channel;

/// Whether an axis may have an effect more than once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occurrence {
    /// Two of them would not add up to one.
    Once,
    /// They add up.
    Repeated,
}

/// What tells an effect from another of its name on the same axis.
#[derive(Clone, Copy, Debug)]
pub enum Distinction<'a> {
    /// Nothing: it is the same effect.
    None,
    /// The axis that it comes from.
    Source(&'a str),
    /// The channel that it acts on.
    Channel(Channel),
    /// Its period, mm.
    Period(f64),
}

impl PartialEq for Distinction<'_> {
    fn eq(&self, other: &Self) -> bool {
        /// Relative difference of two periods of one order: rounding of a written number.
        const SAME_PERIOD: f64 = 1e-6;
        match (self, other) {
            (Self::None, Self::None) => true,
            (Self::Source(a), Self::Source(b)) => a == b,
            (Self::Channel(a), Self::Channel(b)) => a == b,
            (Self::Period(a), Self::Period(b)) => (a - b).abs() <= SAME_PERIOD * a.abs(),
            _ => false,
        }
    }
}

impl<'a> Distinction<'a> {
    /// The axis that the effect comes from, where that is another one.
    #[must_use]
    pub const fn source(self) -> Option<&'a str> {
        match self {
            Self::Source(source) => Some(source),
            _ => None,
        }
    }
}
