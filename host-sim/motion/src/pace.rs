//! Feed, acceleration, ramps and joint of blocks: defaults of the file, and values of a block.

use shared::interpolate::Ramps;

use super::block::Pace;
use super::bounds::positive;
use super::tables::{BlockTable, MotionTable, RampKind};
use files::document::Document;
use files::error::InputError;

/// The defaults of a file.
#[derive(Debug)]
pub(super) struct DefaultPace {
    feed_mm_per_min: f64,
    acceleration_m_per_s2: f64,
    ramps: RampKind,
    jerk_m_per_s3: Option<f64>,
    joint_tolerance_um: f64,
}

/// The values of a block.
#[derive(Debug, Default, PartialEq)]
pub(super) struct BlockPace {
    feed_mm_per_min: Option<f64>,
    acceleration_m_per_s2: Option<f64>,
    ramps: Option<RampKind>,
    jerk_m_per_s3: Option<f64>,
    joint_tolerance_um: Option<f64>,
}

impl BlockPace {
    pub fn of(raw: &BlockTable) -> Self {
        Self {
            feed_mm_per_min: raw.feed_mm_per_min,
            acceleration_m_per_s2: raw.acceleration_m_per_s2,
            ramps: raw.ramps,
            jerk_m_per_s3: raw.jerk_m_per_s3,
            joint_tolerance_um: raw.joint_tolerance_um,
        }
    }
}

impl DefaultPace {
    pub fn of(raw: &MotionTable, document: &Document<'_>) -> Result<Self, InputError> {
        let positive = |key, value| positive(value, key, document);
        let ramps = raw.ramps.unwrap_or_default();
        let jerk_m_per_s3 = raw.jerk_m_per_s3.map(|jerk| positive("jerk_m_per_s3", jerk)).transpose()?;
        if ramps == RampKind::SCurve && jerk_m_per_s3.is_none() {
            return Err(document.refuse("jerk_m_per_s3", NEEDS_JERK));
        }
        Ok(Self {
            feed_mm_per_min: positive("feed_mm_per_min", raw.feed_mm_per_min)?,
            acceleration_m_per_s2: positive("acceleration_m_per_s2", raw.acceleration_m_per_s2)?,
            ramps,
            jerk_m_per_s3,
            joint_tolerance_um: tolerance(
                raw.joint_tolerance_um.unwrap_or(0.0),
                "joint_tolerance_um",
                document,
            )?,
        })
    }

    /// Refuses a default jerk that no block uses.
    pub fn jerk_is_used(&self, blocks: &[BlockTable], document: &Document<'_>) -> Result<(), InputError> {
        let by_a_block = || blocks.iter().any(|block| block.ramps == Some(RampKind::SCurve));
        if self.jerk_m_per_s3.is_none() || self.ramps == RampKind::SCurve || by_a_block() {
            return Ok(());
        }
        Err(document.refuse("jerk_m_per_s3", NO_JERK))
    }

    /// The values of a block; absent values are the defaults of the file.
    pub fn with(&self, own: &BlockPace, key: &str, document: &Document<'_>) -> Result<Pace, InputError> {
        let inner = |name: &str| format!("{key}.{name}");
        let positive = |name: &str, value| positive(value, &inner(name), document);
        let feed_mm_per_min = own.feed_mm_per_min.unwrap_or(self.feed_mm_per_min);
        let acceleration_m_per_s2 = own.acceleration_m_per_s2.unwrap_or(self.acceleration_m_per_s2);
        let kind = own.ramps.unwrap_or(self.ramps);
        if own.jerk_m_per_s3.is_some() && kind != RampKind::SCurve {
            return Err(document.refuse(&inner("jerk_m_per_s3"), NO_JERK));
        }
        let ramps = match kind {
            RampKind::Trapezoid => Ramps::Trapezoid,
            RampKind::SCurve => {
                let jerk = own.jerk_m_per_s3.or(self.jerk_m_per_s3);
                let jerk = jerk.ok_or_else(|| document.refuse(&inner("jerk_m_per_s3"), NEEDS_JERK))?;
                Ramps::SCurve { jerk_m_per_s3: positive("jerk_m_per_s3", jerk)? }
            }
            RampKind::Exponential => Ramps::Exponential,
            RampKind::AfterInterpolation => Ramps::AfterInterpolation,
        };
        Ok(Pace {
            feed_mm_per_min: positive("feed_mm_per_min", feed_mm_per_min)?,
            acceleration_m_per_s2: positive("acceleration_m_per_s2", acceleration_m_per_s2)?,
            ramps,
            joint_tolerance_um: tolerance(
                own.joint_tolerance_um.unwrap_or(self.joint_tolerance_um),
                &inner("joint_tolerance_um"),
                document,
            )?,
        })
    }
}

const NEEDS_JERK: &str = "a value beside ramps = \"s-curve\"";
const NO_JERK: &str = "no jerk, as ramps is not \"s-curve\"";

/// Largest tolerance: 1 m. A larger one has a wrong unit.
const WIDEST_UM: f64 = 1e6;

fn tolerance(value_um: f64, key: &str, document: &Document<'_>) -> Result<f64, InputError> {
    if (0.0..=WIDEST_UM).contains(&value_um) {
        return Ok(value_um);
    }
    Err(document.refuse(key, &format!("a number from 0 to {WIDEST_UM}")))
}
