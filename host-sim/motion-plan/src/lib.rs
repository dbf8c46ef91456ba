//! The motion that decides: within travel, speed, acceleration and time, the one that distinguishes the rivals of a model and narrows its
//! widest intervals.
//!
//! [`unknowns`] lists what a model leaves open. A family of short [`candidates`] is simulated with each unknown moved and each rival in
//! place ([`response`]); their [`information`] adds up, so that a [`choice`] takes the one that gains most in its time, again and again.
//! [`program`] writes the motion as G-code, [`text`] and [`json`] tell what is expected of it before it is run.

pub mod candidates;
pub mod choice;
pub mod information;
pub mod json;
pub mod program;
pub mod response;
pub mod text;
pub mod unknowns;

use motion::Motion;

/// What limits the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Linear axes with the ends of their travel.
    pub travels: Vec<budget::motions::Travel>,
    /// Greatest path speed, mm/s.
    pub speed_mm_s: f64,
    /// Greatest path acceleration, m/s².
    pub acceleration_m_per_s2: f64,
    /// Longest time of the whole motion, s.
    pub seconds: f64,
}

/// What is expected of a pair of rivals.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedPair {
    /// The axis.
    pub axis: String,
    /// The effect in the model, and its rival.
    pub effects: [&'static str; 2],
    /// Root of the squared difference that no other unknown can take up, in standard deviations of the noise.
    pub distance: f64,
    /// Whether that is enough.
    pub is_decided: bool,
}

/// What is expected of a value.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpectedValue {
    /// `AXIS.EFFECT.KEY`.
    pub name: String,
    /// Its value in the model.
    pub value: f64,
    /// Half width of its 95 % interval in the model, if it has one.
    pub half_width_before: Option<f64>,
    /// Half width that a trace of the motion alone should have; `None`: the motion tells nothing of it.
    pub half_width: Option<f64>,
    /// Whether it is to be narrowed, and the half width that is wanted.
    pub wanted: Option<f64>,
}

/// A motion with what is expected of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The motion; `None`: nothing is open, or nothing that moves within the limits tells of it.
    pub motion: Option<Motion>,
    /// What its parts are, in their order.
    pub parts: Vec<String>,
    /// How long it takes, s.
    pub seconds: f64,
    /// Each pair of rivals.
    pub pairs: Vec<ExpectedPair>,
    /// Each value of an effect.
    pub values: Vec<ExpectedValue>,
    /// Rivals that no motion decides, as a sentence each.
    pub not_by_motion: Vec<String>,
    /// What was assumed, a sentence each.
    pub notes: Vec<String>,
}
