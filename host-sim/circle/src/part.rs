//! A part of the deviation, in µm of its range.

use std::f64::consts::TAU;

use contour::sectors::{SECTORS, middle_rad};

use super::samples::{Instant, radial};
use super::term::{Shape, Term};

/// The names of parts, as in `circle --json`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Name {
    /// The centre is not the nominal one.
    Centre,
    /// The radius is not the nominal one.
    Radius,
    /// The axes are not at a right angle.
    Squareness,
    /// The scales of the axes differ.
    ScaleMismatch,
    /// The delays of the axes differ.
    ServoMismatch,
    /// Both axes are late, which shrinks the circle.
    FollowingLag,
    /// A step at the reversals of an axis.
    Backlash,
    /// A peak at the reversals of an axis.
    ReversalSpike,
    /// A sideways shift at the reversals of an axis.
    LateralPlay,
    /// A wave over the position of an axis.
    Cyclic,
    /// An oscillation over time.
    Vibration,
    /// Irregular steps at low speed of an axis.
    StickSlip,
}

impl Name {
    /// The word in results.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Centre => "centre",
            Self::Radius => "radius",
            Self::Squareness => "squareness",
            Self::ScaleMismatch => "scale_mismatch",
            Self::ServoMismatch => "servo_mismatch",
            Self::FollowingLag => "following_lag",
            Self::Backlash => "backlash",
            Self::ReversalSpike => "reversal_spike",
            Self::LateralPlay => "lateral_play",
            Self::Cyclic => "cyclic",
            Self::Vibration => "vibration",
            Self::StickSlip => "stick_slip",
        }
    }
}

/// A further figure of a part, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Key in JSON, with its unit.
    pub key: &'static str,
    /// Value.
    pub value: f64,
    /// Interval; `None` if it is not estimated.
    pub ci95: Option<[f64; 2]>,
}

/// Shape of a spike whose measured height is above that of each fitted shape.
pub const OTHER_SHAPE: &str = "other";

/// A part of the radial deviation.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Name.
    pub name: Name,
    /// Name of the axis, or of both.
    pub axis: String,
    /// Range of the radial deviation of this part alone, over all angles and measured directions, zero included, µm.
    pub um: f64,
    /// Its 95 % interval, µm.
    pub ci95: [f64; 2],
    /// What it may be confused with; empty if it is certain.
    pub rivals: Vec<&'static str>,
    /// Width, pitch, frequency, signed coefficient.
    pub details: Vec<Detail>,
    /// How a spike rises and falls.
    pub shape: Option<&'static str>,
    /// Terms with their coefficients, µm, for a picture.
    pub terms: Vec<(Term, f64)>,
}

impl Part {
    /// Whether nothing else looks the same.
    #[must_use]
    pub fn is_certain(&self) -> bool {
        self.rivals.is_empty()
    }
}

/// What the range of a part depends on beside its terms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Radius, mm.
    pub radius_mm: f64,
    /// Speed along the path, mm/s, if it is known.
    pub speed_mm_s: Option<f64>,
    /// Whether counter-clockwise and clockwise were measured.
    pub directions: [bool; 2],
}

impl Frame {
    /// Radial deviation of terms over one turn in a direction: angle (rad) and µm.
    #[must_use]
    pub fn curve(&self, terms: &[(Term, f64)], is_clockwise: bool) -> Vec<(f64, f64)> {
        (0..SECTORS).map(|sector| self.point(terms, is_clockwise, middle_rad(sector))).collect()
    }

    /// An angle, rad, and the radial deviation of terms there, µm.
    fn point(&self, terms: &[(Term, f64)], is_clockwise: bool, angle: f64) -> (f64, f64) {
        let direction = if is_clockwise { -1.0 } else { 1.0 };
        let rad_per_s = self.speed_mm_s.unwrap_or(0.0) / self.radius_mm;
        // A vibration is drawn with the phase of the first arc.
        let arc = terms.iter().find_map(|(term, _)| match term {
            Term::Vibration(_, _, arc, _) => Some(*arc),
            _ => None,
        });
        let time_s = if rad_per_s > 0.0 { angle / rad_per_s } else { 0.0 };
        let at = Instant { time_s, arc: arc.unwrap_or(0), ..Instant::new(angle, direction) };
        let of = |(term, um): &(Term, f64)| um * radial(&at, term.displacement(&at, self.radius_mm));
        (angle, terms.iter().map(of).sum())
    }

    /// Angles in a sector at which terms are evaluated: 50 in a period of a wave.
    fn per_sector(&self, terms: &[(Term, f64)]) -> usize {
        const PER_PERIOD: f64 = 50.0;
        let Some((Term::Wave(_, pitch_mm, _), _)) = terms.first() else { return 1 };
        let sector_mm = TAU * self.radius_mm / SECTORS as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number")]
        let count = (PER_PERIOD * sector_mm / pitch_mm).ceil() as usize;
        count.max(1)
    }

    /// Range over both measured directions, zero included, µm.
    #[must_use]
    pub fn range_um(&self, terms: &[(Term, f64)]) -> f64 {
        if let Some((Term::Vibration(..), _)) = terms.first() {
            // Where the axis points along the radius, the whole amplitude is radial, both ways.
            return 2.0 * amplitude(terms);
        }
        if let Some((Term::Spike(_, shape, width), um)) = terms.first() {
            // The peak may be narrower than a sector.
            let peak_rad = if *shape == Shape::Rise { *width } else { 0.0 };
            return (um * libm::cos(peak_rad)).abs();
        }
        let measured = [false, true].into_iter().zip(self.directions).filter(|(_, is)| *is);
        let count = SECTORS * self.per_sector(terms);
        let angle = |i: usize| TAU * (i as f64 + 0.5) / count as f64;
        let values =
            measured.flat_map(|(way, _)| (0..count).map(move |i| self.point(terms, way, angle(i)).1));
        numerics::peak_to_peak(values.chain([0.0]))
    }
}

/// Amplitude of sines and cosines, root mean square over the arcs.
fn amplitude(terms: &[(Term, f64)]) -> f64 {
    let arcs = (terms.len() / 2).max(1) as f64;
    (terms.iter().map(|(_, um)| um * um).sum::<f64>() / arcs).sqrt()
}

/// Degrees of an angle.
#[must_use]
pub fn degrees(rad: f64) -> f64 {
    360.0 * rad / TAU
}
