//! The terms whose sum is the deviation of a circle: displacements of both axes, each linear in one coefficient in µm.
//!
//! θ is the angle of the nominal point, d = ±1 the direction, v the velocity of an axis. In µm per unit of the coefficient, first axis
//! x, second axis y:
//!
//! | term | x | y | radial |
//! |---|---|---|---|
//! | centre | 1 or 0 | 0 or 1 | cos θ or sin θ |
//! | radius | cos θ | sin θ | 1 |
//! | scale | cos θ | −sin θ | cos 2θ |
//! | square | sin θ | cos θ | sin 2θ |
//! | rotation | −sin θ | cos θ | 0 |
//! | servo: the delays of the axes differ | d·sin θ | d·cos θ | d·sin 2θ |
//! | lag: both axes are late | d·sin θ | −d·cos θ | 0 |
//! | backlash of x | −sign(vx)/2 | 0 | d·sign(sin θ)·cos θ/2 |
//! | play of x | 0 | −sign(vx)/2 | d·abs(sin θ)/2 |
//! | spike of x | sign(cos θ)·shape | 0 | abs(cos θ)·shape |
//! | wave of x | sin, cos of 2π·x/pitch | 0 | times cos θ |
//! | vibration of x | sin, cos of 2π·f·t | 0 | times cos θ |
//!
//! Servo and lag are proportional to the speed; the shrinkage of the radius by lag, to its square.

use std::f64::consts::{PI, TAU};

use super::samples::Instant;

/// How a spike at a reversal rises and falls over the angle s since the reversal, with its width w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// exp(−s/w).
    Decay,
    /// (s/w)·exp(1 − s/w).
    Rise,
    /// exp(−s²/2w²) after the reversal.
    HalfBell,
    /// exp(−s²/2w²) before and after the reversal.
    Bell,
}

impl Shape {
    /// All shapes.
    pub const ALL: [Self; 4] = [Self::Decay, Self::Rise, Self::HalfBell, Self::Bell];

    /// The word in results.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Decay => "decay",
            Self::Rise => "rise",
            Self::HalfBell => "half_bell",
            Self::Bell => "bell",
        }
    }

    /// Value at an angle since the reversal, rad, 0 to 1.
    fn at(self, since: f64, width: f64) -> f64 {
        let s = since / width;
        match self {
            Self::Decay => libm::exp(-s),
            Self::Rise => s * libm::exp(1.0 - s),
            Self::HalfBell => libm::exp(-0.5 * s * s),
            Self::Bell => libm::exp(-0.5 * s.min((PI - since) / width).powi(2)),
        }
    }
}

/// A term with what is not linear in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// Shift of the centre along an axis.
    Centre(usize),
    /// Change of the radius.
    Radius,
    /// Half of the first axis longer, the second shorter.
    Scale,
    /// Axes not at a right angle.
    Square,
    /// Both axes rotated.
    Rotation,
    /// Delays of the axes that differ.
    Servo,
    /// Delay of both axes.
    Lag,
    /// Change of the radius with the square of the speed.
    SpeedRadius,
    /// Backlash of an axis.
    Backlash(usize),
    /// Sideways shift when an axis reverses.
    Play(usize),
    /// Peak after the reversals of an axis; width in rad.
    Spike(usize, Shape, f64),
    /// Cyclic error of an axis: pitch in mm, whether it is the cosine.
    Wave(usize, f64, bool),
    /// Vibration of an axis: frequency in Hz, arc, whether it is the cosine.
    Vibration(usize, f64, usize, bool),
}

impl Term {
    /// Displacement of both axes at a sample, µm per µm of the coefficient.
    #[must_use]
    pub fn displacement(&self, at: &Instant, radius_mm: f64) -> [f64; 2] {
        let [cos, sin] = at.position;
        let d = at.direction * at.speed;
        match *self {
            Self::Centre(axis) => along(axis, 1.0),
            Self::Radius => [cos, sin],
            Self::Scale => [cos, -sin],
            Self::Square => [sin, cos],
            Self::Rotation => [-sin, cos],
            Self::Servo => [d * sin, d * cos],
            Self::Lag => [d * sin, -d * cos],
            Self::SpeedRadius => [cos, sin].map(|value| at.speed * at.speed * value),
            Self::Backlash(axis) => along(axis, -0.5 * at.velocity_sign(axis)),
            Self::Play(axis) => along(1 - axis, -0.5 * at.velocity_sign(axis)),
            Self::Spike(axis, shape, width) => {
                along(axis, at.position[axis].signum() * shape.at(at.since_reversal(axis), width))
            }
            Self::Wave(axis, pitch_mm, is_cosine) => {
                along(axis, wave(radius_mm * at.position[axis] / pitch_mm, is_cosine))
            }
            Self::Vibration(axis, hz, arc, is_cosine) => {
                along(axis, if at.arc == arc { wave(hz * at.time_s, is_cosine) } else { 0.0 })
            }
        }
    }

    /// The parameter that the term is not linear in: width (rad), pitch (mm) or frequency (Hz).
    #[must_use]
    pub fn parameter(&self) -> Option<f64> {
        match *self {
            Self::Spike(_, _, value) | Self::Wave(_, value, _) | Self::Vibration(_, value, ..) => Some(value),
            _ => None,
        }
    }

    /// The term with another parameter.
    #[must_use]
    pub fn with_parameter(self, value: f64) -> Self {
        match self {
            Self::Spike(axis, shape, _) => Self::Spike(axis, shape, value),
            Self::Wave(axis, _, is_cosine) => Self::Wave(axis, value, is_cosine),
            Self::Vibration(axis, _, arc, is_cosine) => Self::Vibration(axis, value, arc, is_cosine),
            other => other,
        }
    }
}

/// A displacement along one axis.
fn along(axis: usize, value: f64) -> [f64; 2] {
    if axis == 0 { [value, 0.0] } else { [0.0, value] }
}

fn wave(turns: f64, is_cosine: bool) -> f64 {
    let angle = TAU * turns;
    if is_cosine { libm::cos(angle) } else { libm::sin(angle) }
}
