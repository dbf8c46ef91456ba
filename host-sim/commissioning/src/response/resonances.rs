//! Resonances: maxima of the acceleration of the motor per force, and a notch for one.

use std::f64::consts::TAU;

use numerics::saddle;
use serde::{Deserialize, Serialize};
use shared::config::Notch;

use super::margins::LEAST_COHERENCE;
use super::point::Point;

/// Height above both sides from which a maximum is a resonance, dB.
const LEAST_HEIGHT_DB: f64 = 3.0;

/// A resonance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Resonance {
    /// Frequency, Hz, between the points by a parabola.
    pub frequency_hz: f64,
    /// Height above the higher of the two minima beside it, dB.
    pub height_db: f64,
    /// Width at 3 dB below the maximum, Hz; `None`: one side is not measured as far down.
    pub width_hz: Option<f64>,
}

impl Resonance {
    /// A notch that takes this height off: width of the resonance, or a third of its frequency, and the depth that leaves the level of its sides.
    #[must_use]
    pub fn notch(&self) -> Notch {
        let depth = 1.0 - libm::pow(10.0, -self.height_db / 20.0);
        Notch {
            frequency_hz: self.frequency_hz,
            width_hz: self.width_hz.unwrap_or(self.frequency_hz / 3.0),
            depth,
        }
    }
}

/// The resonances of the plant, ascending. Points with a low coherence are left out.
#[must_use]
pub fn resonances(points: &[Point]) -> Vec<Resonance> {
    let used = points.iter().filter(|point| point.coherence >= LEAST_COHERENCE);
    let levels: Vec<(f64, f64)> = used
        .map(|point| {
            let acceleration = TAU * point.frequency_hz * point.plant_m_per_s_per_n.norm();
            (libm::log(point.frequency_hz), 20.0 * libm::log10(acceleration))
        })
        .collect();
    (1..levels.len().saturating_sub(1)).filter_map(|at| resonance(&levels, at)).collect()
}

/// The resonance whose highest point is this one, of (logarithm of the frequency, level in dB).
fn resonance(levels: &[(f64, f64)], at: usize) -> Option<Resonance> {
    let (before, rest) = levels.split_at_checked(at)?;
    let ((position, level), after) = rest.split_first()?;
    let sides = [before.iter().rev().copied().collect::<Vec<_>>(), after.to_vec()];
    let heights: Vec<f64> = levels.iter().map(|(_, level)| *level).collect();
    let height_db = level - saddle(&heights, at)?;
    if height_db < LEAST_HEIGHT_DB {
        return None;
    }
    let edge = |side: &[(f64, f64)]| {
        let mut last = (*position, *level);
        side.iter().find_map(|next| {
            let part = (last.1 - (level - 3.0)) / (last.1 - next.1);
            let edge = (next.1 <= level - 3.0).then(|| libm::exp(last.0 + part * (next.0 - last.0)));
            last = *next;
            edge
        })
    };
    let width_hz = edge(&sides[0]).zip(edge(&sides[1])).map(|(low, high)| high - low);
    let (low, high) = (sides[0].first()?, sides[1].first()?);
    Some(Resonance { frequency_hz: libm::exp(vertex(*low, (*position, *level), *high)), height_db, width_hz })
}

/// Where the parabola through three points has its vertex.
fn vertex(low: (f64, f64), middle: (f64, f64), high: (f64, f64)) -> f64 {
    let (left, right) = (middle.0 - low.0, high.0 - middle.0);
    let (rising, falling) = ((middle.1 - low.1) / left, (high.1 - middle.1) / right);
    let curvature = falling - rising;
    if curvature < 0.0 {
        0.5 * (low.0 + middle.0) - 0.5 * rising * (left + right) / curvature
    } else {
        middle.0
    }
}
