//! The circles of a run: radial deviation F, circular deviation G and reversal spikes, per direction and for both.

use std::f64::consts::TAU;

use super::circular_test::{Ballbar, Lap};
use super::path_circle::PathCircle;
use super::reversal_spike;
use super::vector::Point;

/// Sectors of a turn, 0.25° each; the radial deviation is averaged over each, over all turns of a direction.
const SECTORS: usize = 1440;

/// Largest gap in a lap that still counts as full, in sectors: 10°. The start of a log is not evaluated.
const MAX_GAP: usize = SECTORS / 36;

/// One direction of a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct LapDeviation {
    /// Seen with the first axis to the right and the second up.
    pub is_clockwise: bool,
    /// Radial deviation F from the programmed circle, smallest and largest (ISO 230-4, about the programmed centre), µm.
    pub radial_um: [f64; 2],
    /// Circular deviation G, about the least-squares centre, µm.
    pub circular_um: f64,
    /// Height of the peak at the angles 0, 90, 180 and 270°, µm, positive outwards; see [`reversal_spike`].
    pub spikes_um: [f64; 4],
    /// The lap about its least-squares circle.
    pub lap: Lap,
    /// Angle (rad) and radial deviation from the programmed circle (µm), where measured.
    pub points: Vec<(f64, f64)>,
}

/// A full circle in at least one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleDeviation {
    /// Indices of the two axes.
    pub plane: [usize; 2],
    /// Programmed radius, m.
    pub radius: f64,
    /// The directions in which it is full, counter-clockwise first.
    pub laps: Vec<LapDeviation>,
    /// Bidirectional circular deviation G(b), µm, if both directions are full.
    pub bidirectional_um: Option<f64>,
    /// Circular hysteresis H, µm, likewise.
    pub hysteresis_um: Option<f64>,
}

impl CircleDeviation {
    /// The larger circular deviation G of the directions, µm.
    #[must_use]
    pub fn circular_um(&self) -> f64 {
        numerics::max(self.laps.iter().map(|lap| lap.circular_um))
    }
}

/// Running evaluation of one circle.
#[derive(Clone, Debug)]
pub(crate) struct CircleSum {
    circle: PathCircle,
    /// Sum of the radial deviations (m) and number of samples in each sector, counter-clockwise and clockwise.
    sectors: [Vec<(f64, u32)>; 2],
}

impl CircleSum {
    pub fn new(circle: &PathCircle) -> Self {
        Self { circle: circle.clone(), sectors: [vec![(0.0, 0); SECTORS], vec![(0.0, 0); SECTORS]] }
    }

    /// Adds a position of the tool whose nearest point is at a length of the path.
    pub fn add(&mut self, tool: &Point, progress_m: f64) {
        let is_on = |arc: &&super::path_circle::PathArc| progress_m > arc.from_m && progress_m < arc.to_m;
        let Some(arc) = self.circle.arcs.iter().find(is_on) else { return };
        let [x, y] = [0, 1].map(|i| tool[self.circle.plane[i]] - self.circle.centre[i]);
        let turn = y.atan2(x).rem_euclid(TAU) / TAU;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1440")]
        let sector = (turn * SECTORS as f64) as usize % SECTORS;
        let (sum, count) = &mut self.sectors[usize::from(arc.is_clockwise)][sector];
        *sum += x.hypot(y) - self.circle.radius;
        *count += 1;
    }

    /// The result; `None` if the circle is full in neither direction.
    pub fn finish(&self) -> Option<CircleDeviation> {
        let laps: Vec<LapDeviation> = [false, true].into_iter().filter_map(|way| self.lap(way)).collect();
        let ballbar = match &laps[..] {
            [positive, negative] => {
                Some(Ballbar { positive: positive.lap.clone(), negative: negative.lap.clone() })
            }
            _ => None,
        };
        (!laps.is_empty()).then(|| CircleDeviation {
            plane: self.circle.plane,
            radius: self.circle.radius,
            bidirectional_um: ballbar.as_ref().map(Ballbar::bidirectional_deviation_um),
            hysteresis_um: ballbar.as_ref().map(Ballbar::hysteresis_um),
            laps,
        })
    }

    fn lap(&self, is_clockwise: bool) -> Option<LapDeviation> {
        let sectors = &self.sectors[usize::from(is_clockwise)];
        let is_empty = |i: usize| sectors[i % SECTORS].1 == 0;
        let has_gap = (0..SECTORS).any(|from| (from..=from + MAX_GAP).all(is_empty));
        if has_gap {
            return None;
        }
        let middle = |i: usize| TAU * (i as f64 + 0.5) / SECTORS as f64;
        let filled = sectors.iter().enumerate().filter(|(_, (_, count))| *count > 0);
        let points: Vec<(f64, f64)> =
            filled.map(|(i, (sum, count))| (middle(i), 1e6 * sum / f64::from(*count))).collect();
        let lap = Lap::from_polar(points.clone())?;
        Some(LapDeviation {
            is_clockwise,
            radial_um: numerics::min_max(points.iter().map(|point| point.1)),
            circular_um: lap.circular_deviation_um(),
            spikes_um: reversal_spike::of(&lap),
            lap,
            points,
        })
    }
}
