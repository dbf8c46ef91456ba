//! The kinds of compensation, for switching one on or off.

/// A kind of compensation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "see the table of the parent module")]
pub enum CompensationKind {
    Pitch,
    Backlash,
    Dividing,
    Reversal,
    Intalk,
    Crosstalk,
    Squareness,
    Straightness,
    Ripple,
    Screw,
    Force,
    Stretch,
    Drift,
    Products,
}

impl CompensationKind {
    /// Every kind.
    pub const ALL: [Self; 14] = [
        Self::Pitch,
        Self::Backlash,
        Self::Dividing,
        Self::Reversal,
        Self::Intalk,
        Self::Crosstalk,
        Self::Squareness,
        Self::Straightness,
        Self::Ripple,
        Self::Screw,
        Self::Force,
        Self::Stretch,
        Self::Drift,
        Self::Products,
    ];
}
