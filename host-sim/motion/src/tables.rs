//! The tables of a motion file; `docs/files.md` explains the keys.

use indexmap::IndexMap;
use serde::Deserialize;

use super::block::Direction;

/// A motion file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MotionTable {
    pub name: String,
    pub feed_mm_per_min: f64,
    pub acceleration_m_per_s2: f64,
    pub ramps: Option<RampKind>,
    pub jerk_m_per_s3: Option<f64>,
    pub joint_tolerance_um: Option<f64>,
    pub start_mm: IndexMap<String, f64>,
    #[serde(default)]
    pub block: Vec<BlockTable>,
}

/// A `[[block]]` of a motion file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockTable {
    pub dwell_s: Option<f64>,
    pub line_to_mm: Option<IndexMap<String, f64>>,
    pub arc: Option<ArcTable>,
    pub feed_mm_per_min: Option<f64>,
    pub acceleration_m_per_s2: Option<f64>,
    pub ramps: Option<RampKind>,
    pub jerk_m_per_s3: Option<f64>,
    pub joint_tolerance_um: Option<f64>,
}

/// The `arc` of a block.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArcTable {
    pub plane: [String; 2],
    pub centre_mm: IndexMap<String, f64>,
    pub turns: Option<f64>,
    pub to_mm: Option<IndexMap<String, f64>>,
    pub direction: Option<Direction>,
}

/// The names of the ramps in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RampKind {
    /// See `Ramps::Trapezoid` of `shared`.
    #[default]
    Trapezoid,
    /// See `Ramps::SCurve`.
    SCurve,
    /// See `Ramps::Exponential`.
    Exponential,
    /// See `Ramps::AfterInterpolation`.
    AfterInterpolation,
}
