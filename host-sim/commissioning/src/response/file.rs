//! The measured frequency response as JSON.

use std::path::Path;

use files::document::read_text;
use files::error::InputError;
use nalgebra::Complex;
use serde::{Deserialize, Serialize};
use shared::config::{NOTCHES, Notch};

use super::margins::MeasuredMargins;
use super::point::{Loop, Point};
use super::resonances::{Resonance, resonances};
use crate::margins::AxisMargins;
use crate::margins::axis_margins::LoopMargins;
use crate::margins::margin::At;
use model::axis::{Feedback, Law, PerNotch, Settings};

/// Version of the file.
pub const VERSION: u32 = 1;

/// How a response was measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Conditions {
    /// What the board says it is.
    pub board: String,
    /// Name of the axis.
    pub axis: String,
    /// Position of the axis, mm.
    pub at_mm: f64,
    /// Sum of the amplitudes that act at once, N.
    pub force_n: f64,
    /// Greatest number of tones that act at once.
    pub tones_at_once: usize,
    /// Recorded periods of each tone's group.
    pub periods: usize,
    /// Length of a period, s.
    pub period_s: f64,
    /// Tick rate, Hz.
    pub tick_rate_hz: f64,
    /// The controller with which it was measured.
    pub controller: ControllerKeys,
}

/// The keys of a machine file on which the loops of an axis depend, besides its plant. A key that the file does not have is absent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerKeys {
    /// Control law of the position loop.
    #[serde(rename = "controller", default, skip_serializing_if = "Option::is_none")]
    pub law: Option<Law>,
    /// The sensor that closes the position loop.
    pub feedback: Feedback,
    /// Kp, 1/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_gain_per_s: Option<f64>,
    /// Kv, N per m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_gain_n_s_per_m: Option<f64>,
    /// Ti, s; absent: no integral part.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_integral_time_s: Option<f64>,
    /// Bandwidth of the observer of the velocity, Hz; absent: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_observer_hz: Option<f64>,
    /// Centre of each notch, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notch_frequency_hz: Option<PerNotch>,
    /// Width of each notch, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notch_width_hz: Option<PerNotch>,
    /// Depth of each notch, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub notch_depth: Option<PerNotch>,
    /// Corner of the low-pass, Hz.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low_pass_frequency_hz: Option<f64>,
    /// ζ of the low-pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low_pass_damping_ratio: Option<f64>,
}

impl From<&Settings> for ControllerKeys {
    fn from(Settings { controller, filters, sensors, .. }: &Settings) -> Self {
        Self {
            law: controller.law,
            feedback: sensors.feedback,
            position_gain_per_s: controller.position_gain_per_s,
            velocity_gain_n_s_per_m: controller.velocity_gain_n_s_per_m,
            velocity_integral_time_s: controller.velocity_integral_time_s,
            velocity_observer_hz: controller.velocity_observer_hz,
            notch_frequency_hz: filters.notch_frequency_hz.clone(),
            notch_width_hz: filters.notch_width_hz.clone(),
            notch_depth: filters.notch_depth.clone(),
            low_pass_frequency_hz: filters.low_pass_frequency_hz,
            low_pass_damping_ratio: filters.low_pass_damping_ratio,
        }
    }
}

/// A complex quotient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polar {
    /// Magnitude, in the unit of the key.
    pub magnitude: f64,
    /// Phase, degrees, −180 to 180.
    pub phase_deg: f64,
}

impl From<Polar> for Complex<f64> {
    fn from(polar: Polar) -> Self {
        Self::from_polar(polar.magnitude, polar.phase_deg.to_radians())
    }
}

impl From<Complex<f64>> for Polar {
    fn from(value: Complex<f64>) -> Self {
        Self { magnitude: value.norm(), phase_deg: value.arg().to_degrees() }
    }
}

/// A tone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tone {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Part of the power that is in phase from period to period, 0 to 1.
    pub coherence: f64,
    /// Velocity of the motor per force, m/s per N.
    pub plant_m_per_s_per_n: Polar,
    /// Open loop, cut at the force.
    pub open_loop: Polar,
    /// Closed loop, from the added force to that of the controller.
    pub closed_loop: Polar,
    /// Open velocity loop; absent: the loops cannot be told apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_loop: Option<Polar>,
    /// Open position loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_loop: Option<Polar>,
}

/// A margin and its frequency.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Margin {
    /// Its value, in the unit of the key.
    pub value: f64,
    /// Frequency, Hz.
    pub at_hz: f64,
}

impl From<At> for Margin {
    fn from(at: At) -> Self {
        Self { value: at.value, at_hz: at.hz }
    }
}

/// The margins of a loop; `null`: there is none within the frequencies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Margins {
    /// `at the force`, `velocity` or `position`.
    pub r#loop: String,
    /// Whether they are measured, or follow from the machine file.
    pub measured: bool,
    /// Highest frequency at which the gain is 1, Hz; for those of a machine file that of the phase margin.
    pub crossover_hz: Option<f64>,
    /// Phase margin, degrees.
    pub phase_margin_deg: Option<Margin>,
    /// Gain margin, dB.
    pub gain_margin_db: Option<Margin>,
}

/// Keys of a machine file for notches.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NotchKeys {
    /// Centre of each, Hz.
    pub notch_frequency_hz: PerNotch,
    /// Width of each, Hz.
    pub notch_width_hz: PerNotch,
    /// Depth of each, 0 to 1.
    pub notch_depth: PerNotch,
}

impl NotchKeys {
    /// The notches for the highest resonances, as many as an axis can have; `None`: there is no resonance.
    #[must_use]
    pub fn of(resonances: &[Resonance]) -> Option<Self> {
        let mut highest = resonances.to_vec();
        highest.sort_by(|one, other| other.height_db.total_cmp(&one.height_db));
        highest.truncate(NOTCHES);
        let notches: Vec<Notch> = highest.iter().map(Resonance::notch).collect();
        (!notches.is_empty()).then(|| Self::from(notches.as_slice()))
    }

    /// The notches.
    #[must_use]
    pub fn notches(&self) -> Vec<Notch> {
        PerNotch::notches([&self.notch_frequency_hz, &self.notch_width_hz, &self.notch_depth]).collect()
    }
}

impl From<&[Notch]> for NotchKeys {
    fn from(notches: &[Notch]) -> Self {
        let [notch_frequency_hz, notch_width_hz, notch_depth] = PerNotch::of_notches(notches);
        Self { notch_frequency_hz, notch_width_hz, notch_depth }
    }
}

/// The contents of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponseFile {
    /// [`VERSION`].
    pub version: u32,
    /// How it was measured.
    pub conditions: Conditions,
    /// Tones, ascending.
    pub tones: Vec<Tone>,
    /// Margins, measured and of the machine file.
    pub margins: Vec<Margins>,
    /// Resonances, ascending.
    pub resonances: Vec<Resonance>,
    /// Notches for the highest of them, the highest first.
    pub notch: Option<NotchKeys>,
}

impl ResponseFile {
    /// Reads the JSON of a response.
    ///
    /// # Errors
    /// If the file cannot be read, or is no response of this version.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let source = path.display().to_string();
        let text = read_text(path)?;
        let file: Self = serde_json::from_str(&text)
            .map_err(|error| InputError::expected(&source, "the JSON of `board response`", error))?;
        if file.version != VERSION {
            return Err(InputError::expected(&source, VERSION, file.version).at_key("version"));
        }
        Ok(file)
    }

    /// The result of a measurement, with the margins that a machine file gives the axis.
    #[must_use]
    pub fn new(conditions: Conditions, points: &[Point], declared: &AxisMargins) -> Self {
        let found = resonances(points);
        let notch = NotchKeys::of(&found);
        let measured = Loop::ALL
            .into_iter()
            .filter(|which| points.iter().any(|point| point.of_loop(*which).is_some()))
            .map(|which| measured(which.name(), &MeasuredMargins::of(points, which)));
        let of_file = [(Loop::Velocity, &declared.velocity), (Loop::Position, &declared.position)];
        let of_file = of_file.map(|(which, margins)| of_machine_file(which.name(), margins));
        Self {
            version: VERSION,
            conditions,
            tones: points.iter().map(tone).collect(),
            margins: measured.chain(of_file).collect(),
            resonances: found,
            notch,
        }
    }
}

fn tone(point: &Point) -> Tone {
    Tone {
        frequency_hz: point.frequency_hz,
        coherence: point.coherence,
        plant_m_per_s_per_n: point.plant_m_per_s_per_n.into(),
        open_loop: point.open_loop.into(),
        closed_loop: point.closed_loop().into(),
        velocity_loop: point.of_loop(Loop::Velocity).map(Polar::from),
        position_loop: point.of_loop(Loop::Position).map(Polar::from),
    }
}

fn measured(name: &str, margins: &MeasuredMargins) -> Margins {
    Margins {
        r#loop: name.to_owned(),
        measured: true,
        crossover_hz: margins.crossover_hz,
        phase_margin_deg: margins.phase_deg.map(Margin::from),
        gain_margin_db: margins.gain_db.map(Margin::from),
    }
}

fn of_machine_file(name: &str, margins: &LoopMargins) -> Margins {
    Margins {
        r#loop: name.to_owned(),
        measured: false,
        crossover_hz: margins.phase_deg.map(|(at, _)| at.hz),
        phase_margin_deg: margins.phase_deg.map(|(at, _)| at.into()),
        gain_margin_db: margins.gain_db.map(|(at, _)| at.into()),
    }
}
