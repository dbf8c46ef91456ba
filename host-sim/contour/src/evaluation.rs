//! The contour error of a run, sample by sample, in constant memory.

use super::across::{Across, AcrossSum};
use super::circle::{CircleDeviation, CircleSum};
use super::corner::{self, Corner, CornerDeviation, CornerSum};
use super::path::{Nearest, NominalPath};
use super::sums::{Magnitude, Noise};
use super::vector::{Point, distance, dot, length, minus};

/// Time at the start of a log that is not evaluated, s, as in a trace.
pub const SETTLING_S: f64 = 0.3;

/// The command moves along the path by at most this multiple of its step: corners of up to 150° that are rounded within
/// their tolerance are followed.
const MAX_PROGRESS_PER_STEP: f64 = 4.0;

/// The point of the path nearest to the tool lies within this multiple of the distance f between tool and command. By the
/// triangle inequality it is at most 2f from the command, and along the path at most twice as far on an arc below half a
/// turn and at a corner of up to 120°.
const WINDOW_PER_DISTANCE: f64 = 4.0;

/// Added to both, m.
const MARGIN_M: f64 = 1e-6;

/// The contour error of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourError {
    /// Largest distance, µm.
    pub max_um: f64,
    /// Root mean square over time, µm.
    pub rms_um: f64,
    /// Samples evaluated.
    pub samples: u64,
    /// Standard deviation of the sensors' noise across the path, µm, from third differences of tool minus command.
    pub noise_um: f64,
    /// What a displacement of the tool adds.
    pub across: Across,
    /// Blocks in which the tool was, in the order of the path.
    pub blocks: Vec<BlockError>,
    /// The corners.
    pub corners: Vec<CornerDeviation>,
    /// The full circles.
    pub circles: Vec<CircleDeviation>,
    /// Whether there is only one axis: the error is then along it, the following error at the tool.
    pub is_along_axis: bool,
}

impl ContourError {
    /// Mean square without that of the noise, µm²; below zero if chance makes the estimate of the noise larger.
    #[must_use]
    pub fn mean_square_um2(&self) -> f64 {
        self.rms_um.powi(2) - self.noise_um.powi(2)
    }

    /// Root mean square without the noise, µm; zero if the noise is larger.
    #[must_use]
    pub fn rms_without_noise_um(&self) -> f64 {
        self.mean_square_um2().max(0.0).sqrt()
    }

    /// Circular deviation G of the largest full circle, the larger of its directions, µm.
    #[must_use]
    pub fn circular_um(&self) -> Option<f64> {
        self.largest_circle().map(CircleDeviation::circular_um)
    }

    /// Circular hysteresis H of the largest circle that is full in both directions, µm.
    #[must_use]
    pub fn hysteresis_um(&self) -> Option<f64> {
        self.largest_circle()?.hysteresis_um
    }

    /// Peak at a reversal of the largest full circle, the largest of all in magnitude, µm.
    #[must_use]
    pub fn reversal_peak_um(&self) -> Option<f64> {
        let spikes_um = self.largest_circle()?.laps.iter().flat_map(|lap| lap.spikes_um);
        spikes_um.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// The largest full circle.
    #[must_use]
    pub fn largest_circle(&self) -> Option<&CircleDeviation> {
        self.circles.iter().max_by(|a, b| a.radius.total_cmp(&b.radius))
    }

    /// Largest overshoot of a corner, µm.
    #[must_use]
    pub fn overshoot_um(&self) -> Option<f64> {
        self.corners.iter().map(|corner| corner.overshoot_um).reduce(f64::max)
    }
}

/// The contour error of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockError {
    /// Index of the block.
    pub block: usize,
    /// Largest distance, µm.
    pub max_um: f64,
    /// Root mean square, µm.
    pub rms_um: f64,
}

/// Evaluates the samples of a run one after the other.
#[derive(Clone, Debug)]
pub struct Evaluation<'a> {
    path: &'a NominalPath,
    settling: u64,
    taken: u64,
    /// Samples in which the command moved.
    moved: u64,
    last_command: Option<Point>,
    command_progress_m: f64,
    total: Magnitude,
    noise: Vec<Noise>,
    across: AcrossSum,
    blocks: Vec<Magnitude>,
    corners: Vec<CornerSum>,
    circles: Vec<CircleSum>,
}

impl<'a> Evaluation<'a> {
    /// An evaluation on a path; `sample_s` is the time from one sample to the next, s.
    #[must_use]
    pub fn new(path: &'a NominalPath, sample_s: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred samples")]
        let settling = (SETTLING_S / sample_s).round() as u64;
        let corners = if path.axes() > 1 { Corner::all(path) } else { Vec::new() };
        Self {
            path,
            settling,
            taken: 0,
            moved: 0,
            last_command: None,
            command_progress_m: 0.0,
            total: Magnitude::default(),
            noise: vec![Noise::new(); path.axes()],
            across: AcrossSum::default(),
            blocks: vec![Magnitude::default(); path.blocks()],
            corners: corners.into_iter().map(CornerSum::new).collect(),
            circles: path.circles().iter().map(CircleSum::new).collect(),
        }
    }

    /// Counts from the first sample on, for a run that continues one whose settling has passed.
    #[must_use]
    pub fn without_settling(self) -> Self {
        Self { settling: 0, ..self }
    }

    /// Takes the next sample, m, and gives its error, m; `None` during settling.
    ///
    /// The error of two axes is positive to the left of the direction of travel. That of three axes has no sign.
    pub fn add(&mut self, command: &Point, tool: &Point) -> Option<f64> {
        let step_m = self.last_command.replace(*command).map_or(0.0, |last| distance(&last, command));
        let ahead_m = self.command_progress_m + MAX_PROGRESS_PER_STEP * step_m + MARGIN_M;
        let on_path = self.path.nearest(command, self.command_progress_m, ahead_m);
        self.command_progress_m = on_path.progress_m;
        self.taken += 1;
        self.moved += u64::from(step_m > 0.0);
        // From the same point of the path on in each log of a motion, however long it stands before.
        let travel_m = if self.moved > self.settling { step_m } else { 0.0 };
        if self.taken <= self.settling {
            return None;
        }
        let difference = minus(tool, command);
        self.noise.iter_mut().zip(difference).for_each(|(noise, difference_m)| noise.add(difference_m));
        if self.path.axes() == 1 {
            let error_m = tool[0] - command[0];
            self.count(error_m, &on_path);
            self.across.add(tool, &Nearest { point: *command, ..on_path }, (1, travel_m));
            return Some(error_m);
        }
        let reach_m = WINDOW_PER_DISTANCE * distance(tool, command) + MARGIN_M;
        let nearest =
            self.path.nearest(tool, self.command_progress_m - reach_m, self.command_progress_m + reach_m);
        let error_m = signed_m(tool, &nearest, self.path.axes());
        self.count(error_m, &nearest);
        self.across.add(tool, &nearest, (self.path.axes(), travel_m));
        corner::near(&mut self.corners, nearest.progress_m).for_each(|corner| corner.add(tool, &nearest));
        if step_m > 0.0 {
            self.circles.iter_mut().for_each(|circle| circle.add(tool, nearest.progress_m));
        }
        Some(error_m)
    }

    fn count(&mut self, error_m: f64, nearest: &Nearest) {
        self.total.add(error_m);
        if let Some(block) = self.blocks.get_mut(nearest.block) {
            block.add(error_m);
        }
    }

    /// Deviation of the noise along each axis, m.
    fn noise_m(&self) -> [f64; 3] {
        let mut deviations = [0.0; 3];
        deviations.iter_mut().zip(&self.noise).for_each(|(deviation, noise)| *deviation = noise.deviation());
        deviations
    }

    /// The figures of all samples taken; `None` if all were settling.
    #[must_use]
    pub fn finish(&self) -> Option<ContourError> {
        let blocks = self.blocks.iter().enumerate().filter(|(_, sum)| sum.samples() > 0);
        let across = self.across.finish();
        (self.total.samples() > 0).then(|| ContourError {
            max_um: 1e6 * self.total.max(),
            rms_um: 1e6 * self.total.rms(),
            samples: self.total.samples(),
            noise_um: 1e6 * across.deviation(self.noise_m()),
            across,
            blocks: blocks
                .map(|(block, sum)| BlockError { block, max_um: 1e6 * sum.max(), rms_um: 1e6 * sum.rms() })
                .collect(),
            corners: self.corners.iter().filter_map(CornerSum::finish).collect(),
            circles: self.circles.iter().filter_map(CircleSum::finish).collect(),
            is_along_axis: self.path.axes() == 1,
        })
    }
}

/// Distance from the path, m, with the sign of its side in the plane of two axes.
fn signed_m(tool: &Point, nearest: &Nearest, axes: usize) -> f64 {
    let offset = minus(tool, &nearest.point);
    let left = [-nearest.tangent[1], nearest.tangent[0], 0.0];
    if axes == 2 && dot(&offset, &left) < 0.0 { -length(&offset) } else { length(&offset) }
}
