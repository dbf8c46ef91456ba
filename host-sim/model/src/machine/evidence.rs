//! What a trace knows of the effects that it found: how sure they are, and what else may be the cause.

use serde::{Deserialize, Serialize};

use crate::effects::Effect;

/// Whether an effect is a fact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// Nobody but the machine file says it.
    #[default]
    Declared,
    /// A trace found it, and nothing speaks against it.
    Certain,
    /// A trace found it, and something else may be the cause.
    Ambiguous,
}

impl Certainty {
    /// Its name in files.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Declared => "declared",
            Self::Certain => "certain",
            Self::Ambiguous => "ambiguous",
        }
    }
}

/// `[[axis.NAME.evidence]]`: the evidence for one effect. The first is for the first effect of the axis, and so on; further effects have
/// none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evidence {
    /// Name of the effect.
    pub effect: String,
    /// Whether it is a fact.
    pub certainty: Certainty,
    /// Half widths of the 95 % confidence intervals of its parameters, in the order of their values; 0: not fitted. Empty: unknown.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub half_widths: Vec<f64>,
    /// Effects that explain the logs as well.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rivals: Vec<String>,
    /// The channel, key or log that decides between the effect and a rival that no motion decides.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub decided_by: Vec<String>,
    /// The rivals that another motion may decide, as fitted in place of the effect.
    #[serde(default, rename = "alternative", skip_serializing_if = "Vec::is_empty")]
    pub alternatives: Vec<Effect>,
}
