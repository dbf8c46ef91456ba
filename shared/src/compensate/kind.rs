//! Names of the compensations, for switching one on or off.

/// One of the compensations of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "see the table of the parent module")]
pub enum Item {
    Pitch,
    Backlash,
    Dividing,
    Reversal,
    Intalk,
    Crosstalk,
    Squareness,
    Straightness,
    Ripple,
}

impl Item {
    /// All there are.
    pub const ALL: [Self; 9] = [
        Self::Pitch,
        Self::Backlash,
        Self::Dividing,
        Self::Reversal,
        Self::Intalk,
        Self::Crosstalk,
        Self::Squareness,
        Self::Straightness,
        Self::Ripple,
    ];
}
