//! The circles of a run: radial deviation F, circular deviation G and reversal spikes, per direction and for both.

use super::circular_test::{Ballbar, Lap};
use super::path_circle::PathCircle;
use super::reversal_spike;
use super::sectors::Sectors;
use super::vector::Point;

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
    /// Circular hysteresis H, µm; `None` as for G.
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
    /// Radial deviations, counter-clockwise and clockwise.
    sectors: [Sectors; 2],
}

impl CircleSum {
    pub fn new(circle: &PathCircle) -> Self {
        Self { circle: circle.clone(), sectors: [Sectors::new(), Sectors::new()] }
    }

    /// Adds a position of the tool whose nearest point is at a length of the path.
    pub fn add(&mut self, tool: &Point, progress_m: f64) {
        let is_on = |arc: &&super::path_circle::PathArc| progress_m > arc.from_m && progress_m < arc.to_m;
        let Some(arc) = self.circle.arcs.iter().find(is_on) else { return };
        let [x, y] = [0, 1].map(|i| tool[self.circle.plane[i]] - self.circle.centre[i]);
        let deviation_um = 1e6 * (libm::hypot(x, y) - self.circle.radius);
        self.sectors[usize::from(arc.is_clockwise)].add(libm::atan2(y, x), deviation_um);
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
        if !sectors.is_full() {
            return None;
        }
        let points = sectors.points();
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
