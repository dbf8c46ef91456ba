//! One loop of the study: its margins and contour errors.

use contour::ContourError;
use serde::Serialize;

use commissioning::margins::AxisMargins;
use commissioning::margins::axis_margins::LoopMargins;
use model::axis::{Feedback, Law};
use model::machine::Machine;

/// Contour errors of the two motions, µm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Contour {
    /// Rms on the circle.
    pub circle_rms_um: f64,
    /// Circular deviation G of ISO 230-4, the larger of both directions.
    pub circular_um: f64,
    /// Rms on the corners.
    pub corner_rms_um: f64,
    /// Greatest distance on the corners.
    pub corner_max_um: f64,
}

impl Contour {
    fn of(errors: &[ContourError]) -> Self {
        let [circle, corner] = [0, 1].map(|motion| errors.get(motion));
        let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            circle_rms_um: or_nan(circle.map(|error| error.rms_um)),
            circular_um: or_nan(circle.and_then(ContourError::circular_um)),
            corner_rms_um: or_nan(corner.map(|error| error.rms_um)),
            corner_max_um: or_nan(corner.map(|error| error.max_um)),
        }
    }
}

/// Contour error at a position gain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GainPoint {
    /// Kp, 1/s.
    pub position_gain_per_s: f64,
    /// Rms on the circle without compensation, µm.
    pub circle_rms_um: f64,
}

/// Dual feedback with a time constant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CrossoverPoint {
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Rms on the circle without compensation, µm.
    pub circle_rms_um: f64,
    /// Highest Kp with the margins of the study, 1/s; absent: none.
    pub highest_position_gain_per_s: Option<f64>,
}

/// One loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// `motor`, `table` or `dual`.
    pub feedback: &'static str,
    /// `p` or `hpc`.
    pub controller: &'static str,
    /// Smallest gain margin of the position loops, dB; absent: the loop is unstable, or no gain makes it so.
    pub gain_margin_db: Option<f64>,
    /// Smallest phase margin of the position loops, degrees; absent: the loop is unstable.
    pub phase_margin_deg: Option<f64>,
    /// Highest Kp with the margins of the study, 1/s; absent: none.
    pub highest_position_gain_per_s: Option<f64>,
    /// Contour error without compensation.
    pub uncompensated: Contour,
    /// Contour error with compensation.
    pub compensated: Contour,
    /// Contour error over Kp, without compensation.
    pub over_gain: Vec<GainPoint>,
}

impl Row {
    /// The row of a machine from the margins of its axes, and its contour errors before and after compensation.
    #[must_use]
    pub fn new(
        machine: &Machine,
        axes: &[AxisMargins],
        highest_position_gain_per_s: Option<f64>,
        [before, after]: [&[ContourError]; 2],
    ) -> Self {
        let settings = machine.axis.values().next().map(|axis| &axis.settings);
        let least = |margin: fn(&LoopMargins) -> Option<f64>| {
            let values = axes.iter().filter(|axis| axis.position.unstable.is_none());
            values.filter_map(|axis| margin(&axis.position)).reduce(f64::min)
        };
        Self {
            feedback: settings.map_or("", |settings| feedback_name(settings.sensors.feedback)),
            controller: settings.and_then(|settings| settings.controller.law).map_or("", law_name),
            gain_margin_db: least(|margins| margins.gain_db.map(|(at, _)| at.value)),
            phase_margin_deg: least(|margins| margins.phase_deg.map(|(at, _)| at.value)),
            highest_position_gain_per_s,
            uncompensated: Contour::of(before),
            compensated: Contour::of(after),
            over_gain: Vec::new(),
        }
    }

    /// This row with contour errors over the position gain.
    #[must_use]
    pub fn with_curve(self, over_gain: Vec<GainPoint>) -> Self {
        Self { over_gain, ..self }
    }
}

/// Name of the sensors in a machine file.
#[must_use]
pub const fn feedback_name(feedback: Feedback) -> &'static str {
    match feedback {
        Feedback::Motor => "motor",
        Feedback::Table => "table",
        Feedback::Dual => "dual",
    }
}

/// Name of the law in a machine file.
#[must_use]
pub const fn law_name(law: Law) -> &'static str {
    match law {
        Law::P => "p",
        Law::Hpc => "hpc",
    }
}
