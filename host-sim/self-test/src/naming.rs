//! The names of things that are outside the textbook catalogue.

/// How a thing from outside the textbook catalogue is to be named.
pub(super) struct Naming {
    /// Name of the thing in `truth.json`.
    pub(super) extra: &'static str,
    /// Effects that may be reported for it without being false.
    pub(super) accepted: &'static [&'static str],
    /// Effects among the accepted ones that name it.
    pub(super) names: &'static [&'static str],
    /// Kind of data fault that names it.
    pub(super) fault: Option<&'static str>,
    /// The effect whose parameters are its own, with the names of the parameters that are compared.
    pub(super) estimated: Option<(&'static str, &'static [&'static str])>,
}

/// A thing that is named by any effect that is accepted for it.
pub(super) const fn named(extra: &'static str, accepted: &'static [&'static str]) -> Naming {
    Naming { extra, accepted, names: accepted, fault: None, estimated: None }
}

/// A thing that is named by a data fault.
pub(super) const fn fault(extra: &'static str, kind: &'static str) -> Naming {
    Naming { extra, accepted: &[], names: &[], fault: Some(kind), estimated: None }
}
