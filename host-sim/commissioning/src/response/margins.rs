//! Crossover and margins between measured points, as [`crate::margins::margin`] defines them.

use nalgebra::Complex;

use super::point::{Loop, Point};
use crate::margins::margin::At;

/// Coherence below which a point is not used: its amplitude is then uncertain by a half.
pub const LEAST_COHERENCE: f64 = 0.8;

/// The margins of a measured loop, within the frequencies that were measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeasuredMargins {
    /// Highest frequency at which the gain is 1, Hz.
    pub crossover_hz: Option<f64>,
    /// Least phase margin, degrees, negative where the phase is beyond −180°.
    pub phase_deg: Option<At>,
    /// Gain margin nearest to 0 dB.
    pub gain_db: Option<At>,
}

/// Frequency, logarithm of the gain and phase in radians, which goes on beyond ±π.
type Polar = (f64, f64, f64);

impl MeasuredMargins {
    /// The margins of a loop; points with a coherence below [`LEAST_COHERENCE`] are left out.
    #[must_use]
    pub fn of(points: &[Point], which: Loop) -> Self {
        let used = points.iter().filter(|point| point.coherence >= LEAST_COHERENCE);
        Self::of_responses(used.filter_map(|point| Some((point.frequency_hz, point.of_loop(which)?))))
    }

    /// The margins of an open loop from its responses at ascending frequencies (Hz).
    #[must_use]
    pub fn of_responses(responses: impl Iterator<Item = (f64, Complex<f64>)>) -> Self {
        let polar = unwrapped(responses);
        let mut margins = Self::default();
        for pair in polar.windows(2) {
            let [low, high] = [pair[0], pair[1]];
            if let Some(part) = part(low.1, high.1) {
                let at = between(low, high, part);
                margins.crossover_hz = Some(at.0);
                let phase = beyond_minus_one(at.2).to_degrees();
                if margins.phase_deg.is_none_or(|least| phase < least.value) {
                    margins.phase_deg = Some(At { value: phase, hz: at.0 });
                }
            }
            let turn =
                std::f64::consts::TAU * ((0.5 * (low.2 + high.2) / std::f64::consts::TAU).floor() + 0.5);
            if let Some(part) = part(low.2 - turn, high.2 - turn) {
                let at = between(low, high, part);
                let gain = (20.0 / std::f64::consts::LN_10 * at.1).abs();
                if margins.gain_db.is_none_or(|least| gain < least.value) {
                    margins.gain_db = Some(At { value: gain, hz: at.0 });
                }
            }
        }
        margins
    }
}

/// Gain and phase of points in ascending order, the phase without jumps.
fn unwrapped(points: impl Iterator<Item = (f64, Complex<f64>)>) -> Vec<Polar> {
    let mut last = 0.0;
    points
        .filter(|(_, response)| response.norm() > 0.0)
        .map(|(hz, response)| {
            let turns = ((last - response.arg()) / std::f64::consts::TAU).round();
            last = response.arg() + turns * std::f64::consts::TAU;
            (hz, libm::log(response.norm()), last)
        })
        .collect()
}

/// Where between two values a line through them is zero, 0 to 1.
fn part(low: f64, high: f64) -> Option<f64> {
    ((low > 0.0) != (high > 0.0)).then(|| low / (low - high))
}

/// Interpolated over the logarithm of the frequency.
fn between(low: Polar, high: Polar, part: f64) -> Polar {
    let line = |low: f64, high: f64| low + part * (high - low);
    (libm::exp(line(libm::log(low.0), libm::log(high.0))), line(low.1, high.1), line(low.2, high.2))
}

/// The angle from −1 to a phase, −π to π.
fn beyond_minus_one(phase: f64) -> f64 {
    let turned = phase + std::f64::consts::PI;
    turned - std::f64::consts::TAU * (turned / std::f64::consts::TAU).round()
}
