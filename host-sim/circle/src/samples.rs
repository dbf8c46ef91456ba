//! What was measured on a circle, sample by sample.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

use numerics::wrapped;

/// One sample of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Angle of the nominal point, rad.
    pub angle: f64,
    /// Cosine and sine of the angle: position of both axes relative to the radius.
    pub position: [f64; 2],
    /// +1 counter-clockwise, from + of the first axis to + of the second; −1 clockwise.
    pub direction: f64,
    /// Speed relative to [`Samples::speed_mm_s`]; 1 if the speed is not known.
    pub speed: f64,
    /// Time, s; 0 if it is not known.
    pub time_s: f64,
    /// Index of the arc.
    pub arc: usize,
}

impl Instant {
    /// A sample at an angle, rad, and in a direction, without its time.
    #[must_use]
    pub fn new(angle: f64, direction: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        Self { angle, position: [cos, sin], direction, speed: 1.0, time_s: 0.0, arc: 0 }
    }

    /// Sign of the velocity of an axis.
    #[must_use]
    pub fn velocity_sign(&self, axis: usize) -> f64 {
        let [cos, sin] = self.position;
        self.direction * if axis == 0 { -sin.signum() } else { cos.signum() }
    }

    /// Angle travelled since the last reversal of an axis, rad, 0 to π.
    #[must_use]
    pub fn since_reversal(&self, axis: usize) -> f64 {
        let offset = if axis == 0 { 0.0 } else { FRAC_PI_2 };
        (self.direction * (self.angle - offset)).rem_euclid(PI)
    }
}

/// What was measured at each sample.
#[derive(Clone, Debug, PartialEq)]
pub enum Observed {
    /// Deviation of both axes from the nominal point, µm.
    Both([Vec<f64>; 2]),
    /// Radial deviation alone, µm, positive outwards.
    Radial(Vec<f64>),
}

/// The samples of a circle that are evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Radius, mm.
    pub radius_mm: f64,
    /// Greatest speed of the arcs along the path, mm/s; `None` without times.
    pub speed_mm_s: Option<f64>,
    /// Time from one sample to the next, s; `None` without times.
    pub sample_s: Option<f64>,
    /// The samples.
    pub instants: Vec<Instant>,
    /// The samples of each arc.
    pub arcs: Vec<Range<usize>>,
    /// What was measured.
    pub observed: Observed,
}

impl Samples {
    /// A column of the equations: what a displacement of both axes adds to each measured value.
    pub fn column(&self, displacement: impl Fn(&Instant) -> [f64; 2]) -> Vec<f64> {
        match &self.observed {
            Observed::Both(_) => {
                let mut column = vec![0.0; 2 * self.instants.len()];
                let (x, y) = column.split_at_mut(self.instants.len());
                for (i, instant) in self.instants.iter().enumerate() {
                    [x[i], y[i]] = displacement(instant);
                }
                column
            }
            Observed::Radial(_) => self.instants.iter().map(|at| radial(at, displacement(at))).collect(),
        }
    }

    /// The measured values, in the order of [`Samples::column`].
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        match &self.observed {
            Observed::Both([x, y]) => x.iter().chain(y).copied().collect(),
            Observed::Radial(r) => r.clone(),
        }
    }

    /// Ranges of rows that are uninterrupted in time, grouped by the sensor that measured them.
    #[must_use]
    pub fn segments(&self) -> Vec<Vec<Range<usize>>> {
        let shifted =
            |by: usize| self.arcs.iter().map(|arc| arc.start + by..arc.end + by).collect::<Vec<_>>();
        match self.observed {
            Observed::Both(_) => vec![shifted(0), shifted(self.instants.len())],
            Observed::Radial(_) => vec![shifted(0)],
        }
    }

    /// The part of rows that a displacement of an axis is seen in: first row, and the factor of each sample.
    #[must_use]
    pub fn seen(&self, axis: usize) -> (usize, Vec<f64>) {
        match self.observed {
            Observed::Both(_) => (axis * self.instants.len(), vec![1.0; self.instants.len()]),
            Observed::Radial(_) => (0, self.instants.iter().map(|at| at.position[axis]).collect()),
        }
    }

    /// Whether both directions were measured.
    #[must_use]
    pub fn has_both_directions(&self) -> bool {
        let has = |sign: f64| self.instants.iter().any(|at| at.direction * sign > 0.0);
        has(1.0) && has(-1.0)
    }

    /// Whether the speeds of the arcs differ by more than a tenth.
    #[must_use]
    pub fn has_several_speeds(&self) -> bool {
        const MIN_RATIO: f64 = 0.9;
        numerics::min(self.instants.iter().map(|at| at.speed)) < MIN_RATIO
    }

    /// Whether both axes were measured.
    #[must_use]
    pub fn has_both_axes(&self) -> bool {
        matches!(self.observed, Observed::Both(_))
    }

    /// Angle travelled from one sample to the next, rad, mean.
    #[must_use]
    pub fn step_rad(&self) -> f64 {
        let travelled: f64 = self.arcs.iter().map(|arc| self.swept_rad(arc)).sum();
        let steps: usize = self.arcs.iter().map(|arc| arc.len().saturating_sub(1)).sum();
        travelled / steps.max(1) as f64
    }

    /// Angle that an arc sweeps, rad, positive.
    #[must_use]
    pub fn swept_rad(&self, arc: &Range<usize>) -> f64 {
        let samples = &self.instants[arc.clone()];
        samples.windows(2).map(|pair| wrapped(pair[1].angle - pair[0].angle, TAU)).sum::<f64>().abs()
    }

    /// Measured radial deviation from the nominal circle, with the angle at which it was measured, of each sample.
    #[must_use]
    pub fn polar(&self) -> Vec<(f64, f64)> {
        let radius_um = 1e3 * self.radius_mm;
        let point = |(i, at): (usize, &Instant)| match &self.observed {
            Observed::Both([x, y]) => {
                let [cos, sin] = at.position;
                let (px, py) = (radius_um * cos + x[i], radius_um * sin + y[i]);
                (libm::atan2(py, px), libm::hypot(px, py) - radius_um)
            }
            Observed::Radial(r) => (at.angle, r[i]),
        };
        self.instants.iter().enumerate().map(point).collect()
    }

    /// The samples for which a condition holds.
    #[must_use]
    pub fn filtered(&self, is_kept: impl Fn(usize) -> bool) -> Self {
        let kept: Vec<usize> = (0..self.instants.len()).filter(|&i| is_kept(i)).collect();
        let chosen = |values: &Vec<f64>| kept.iter().map(|&i| values[i]).collect::<Vec<f64>>();
        let observed = match &self.observed {
            Observed::Both([x, y]) => Observed::Both([chosen(x), chosen(y)]),
            Observed::Radial(r) => Observed::Radial(chosen(r)),
        };
        let place = |i: usize| kept.partition_point(|&sample| sample < i);
        let arcs = self.arcs.iter().map(|arc| place(arc.start)..place(arc.end)).collect();
        let instants = kept.iter().map(|&i| self.instants[i]).collect();
        Self { instants, arcs, observed, ..*self }
    }

    /// Fewer samples, of which no two are nearer than an angle, rad.
    #[must_use]
    pub fn thinned(&self, step_rad: f64) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of samples")]
        let stride = ((step_rad / self.step_rad().max(1e-9)).floor() as usize).max(1);
        self.filtered(|i| i % stride == 0)
    }

    /// These samples with the radial deviation alone.
    #[must_use]
    pub fn radial_only(&self) -> Self {
        let observed = Observed::Radial(self.polar().into_iter().map(|point| point.1).collect());
        Self { observed, instants: self.instants.clone(), arcs: self.arcs.clone(), ..*self }
    }
}

/// Radial part of a displacement of both axes.
#[must_use]
pub fn radial(at: &Instant, [x, y]: [f64; 2]) -> f64 {
    let [cos, sin] = at.position;
    x * cos + y * sin
}
