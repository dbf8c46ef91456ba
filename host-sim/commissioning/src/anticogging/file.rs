//! What was learned as JSON.

use serde::{Deserialize, Serialize};

use super::learned::{Learned, Measured, Summary};
use super::plan::Plan;

/// Version of the file.
pub const VERSION: u32 = 1;

/// How it was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// What the board says it is.
    pub board: String,
    /// Name of the axis.
    pub axis: String,
    /// Ends of the travel, mm.
    pub travel_mm: [f64; 2],
    /// Ends of the part at constant speed that is evaluated, mm.
    pub evaluated_mm: [f64; 2],
    /// Speed, mm/min.
    pub speed_mm_per_min: f64,
    /// Periods whose harmonics were looked for, mm.
    pub periods_mm: Vec<f64>,
}

/// A wave: amplitude·sin(2π·motor/period + phase) in addition to the force of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WaveEntry {
    /// Its period, mm.
    pub period_mm: f64,
    /// Half of the peak-to-peak value, N.
    pub amplitude_n: f64,
    /// Phase at motor position zero, −π to π.
    pub phase_rad: f64,
    /// Standard error of the amplitude, N.
    pub standard_error_n: f64,
    /// Amplitude from which it is significant, N.
    pub least_n: f64,
    /// Amplitude in the passes that the fit does not use, N.
    pub held_out_n: f64,
    /// Whether it is significant, and these passes confirm it: it is in the table.
    pub found: bool,
}

impl From<&Measured> for WaveEntry {
    fn from(wave: &Measured) -> Self {
        Self {
            period_mm: wave.candidate.period_mm,
            amplitude_n: wave.wave_n.norm(),
            phase_rad: wave.wave_n.arg(),
            standard_error_n: wave.standard_error_n,
            least_n: wave.least_n,
            held_out_n: wave.held_out_n.norm(),
            found: wave.is_found(),
        }
    }
}

/// The contents of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnticoggingFile {
    /// [`VERSION`].
    pub version: u32,
    /// How it was measured.
    pub conditions: Conditions,
    /// The waves that were looked for, by period and order.
    pub waves: Vec<WaveEntry>,
    /// Amplitude above which any of the others would have been found, N; 0: all were found.
    pub limit_n: f64,
    /// Forces, following error and numbers of passes, as keys of the file itself.
    #[serde(flatten)]
    pub summary: Summary,
}

impl AnticoggingFile {
    /// The result of a measurement.
    #[must_use]
    pub fn new(board: &str, axis: &str, plan: &Plan, learned: &Learned) -> Self {
        let grid = &plan.grid;
        Self {
            version: VERSION,
            conditions: Conditions {
                board: board.to_owned(),
                axis: axis.to_owned(),
                travel_mm: plan.travel_mm,
                evaluated_mm: [grid.from_mm, grid.from_mm + grid.length_mm()],
                speed_mm_per_min: 60.0 * plan.speed_mm_per_s,
                periods_mm: plan.periods_mm.clone(),
            },
            waves: learned.waves.iter().map(WaveEntry::from).collect(),
            limit_n: learned.limit_n(),
            summary: learned.summary,
        }
    }
}
