//! Evaluation of a single circle without a machine file: the figures of ISO 230-4, and the parts of the radial deviation, in
//! µm and ranked, with their intervals and what they may be confused with.
//!
//! - [`measured`], [`of_files`], [`of_log`], [`radius_table`]: a circle from a log, or from the radius of a ballbar
//! - [`samples`]: the measurement, sample by sample
//! - [`iso`]: the figures of ISO 230-4
//! - [`term`]: the terms of the deviation, with their equations
//! - [`fit`], [`covariance`]: least squares, and intervals under correlated noise
//! - [`search`], [`selection`]: spikes, waves and vibrations, and how many of them the samples support
//! - [`part`], `builder`, [`parts`], `lag`, `stick_slip`, `spike_profile`, [`rivals`]: from coefficients to parts
//! - [`json`], [`text`]: the result for a file, and for a terminal

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod builder;
pub mod covariance;
pub mod fit;
pub mod iso;
pub mod json;
mod lag;
pub mod measured;
pub mod of_files;
pub mod of_log;
pub mod part;
pub mod parts;
pub mod radius_table;
pub mod rivals;
pub mod samples;
pub mod search;
pub mod selection;
mod spike_profile;
mod stick_slip;
pub mod term;
pub mod text;

use files::error::InputError;

use iso::Figures;
use measured::Measured;
use part::{Frame, Part};
use samples::{Observed, Samples, radial};

/// Smallest angle of a circle, degrees.
const MIN_COVERED_DEG: f64 = 270.0;

/// The tangential deviation is taken for none below this fraction of the radial one.
const MIN_TANGENTIAL: f64 = 0.2;

/// Sine of the smallest angle from the axes, 25°, at which both are compared.
const MIN_FROM_AXES: f64 = 0.42;

/// The figures and parts of a circle.
#[derive(Clone, Debug, PartialEq)]
pub struct Analysis {
    /// The measured circle.
    pub measured: Measured,
    /// The figures of ISO 230-4.
    pub figures: Figures,
    /// The parts, largest first.
    pub parts: Vec<Part>,
    /// The remaining residual, rms, µm: of each axis, or of the radius.
    pub residual_um: f64,
    /// Radius, speed and directions, for pictures.
    pub frame: Frame,
}

/// Evaluates a measured circle.
///
/// # Errors
/// Less than three quarters of a turn in each direction.
pub fn analyse(measured: Measured) -> Result<Analysis, InputError> {
    let mut measured = with_enough(measured)?;
    let figures = Figures::of(&measured.samples);
    let mut samples = measured.after_known_reversals();
    if is_radial_only(&samples) {
        samples = samples.radial_only();
        measured.delay_s = None;
        measured.notes.push(
            "The positions have no deviation along the circle: they were computed from a radius, and only the radius is used."
                .to_owned(),
        );
    }
    let fitted = selection::fitted(&samples);
    let parts = parts::parts(&measured, &samples, &fitted);
    let (residual_um, frame) = (fitted.fit.rms_um(), parts::frame(&samples));
    Ok(Analysis { measured, figures, parts, residual_um, frame })
}

/// The directions of which three quarters of a turn were measured.
fn with_enough(measured: Measured) -> Result<Measured, InputError> {
    let samples = &measured.samples;
    let covered_deg = [false, true].map(|is_clockwise| {
        let mut sectors = contour::sectors::Sectors::new();
        let of_way = samples.instants.iter().filter(|at| (at.direction < 0.0) == is_clockwise);
        of_way.for_each(|at| sectors.add(at.angle, 0.0));
        let step = samples.step_rad().max(std::f64::consts::TAU / contour::sectors::SECTORS as f64);
        part::degrees(step * sectors.points().len() as f64).min(360.0)
    });
    let enough = covered_deg.map(|deg| deg >= MIN_COVERED_DEG - 1.0);
    if enough == [false, false] {
        let expected = "three quarters of a turn or more at a steady speed in one direction";
        let found = format!("{:.0}°", numerics::max(covered_deg));
        return Err(InputError::expected(&measured.source, expected, found));
    }
    let is_kept = |i: usize| enough[usize::from(measured.samples.instants[i].direction < 0.0)];
    let samples = measured.samples.filtered(is_kept);
    let mut notes = measured.notes;
    for (word, is_left_out) in [("counter-clockwise", 0), ("clockwise", 1)] {
        let is_measured =
            measured.samples.instants.iter().any(|at| usize::from(at.direction < 0.0) == is_left_out);
        if is_measured && !enough[is_left_out] {
            notes.push(format!("Less than three quarters of a turn {word}: left out."));
        }
    }
    Ok(Measured { samples, notes, ..measured })
}

/// Whether positions of both axes contain no more than a radius: nothing along the circle but noise and a constant.
fn is_radial_only(samples: &Samples) -> bool {
    let Observed::Both([x, y]) = &samples.observed else { return false };
    // Peaks at the reversals are radial by themselves, on either kind of position.
    let is_between = |at: &samples::Instant| at.position[0].abs().min(at.position[1].abs()) > MIN_FROM_AXES;
    let each = || samples.instants.iter().zip(x.iter().zip(y)).filter(|(at, _)| is_between(at));
    let radial_um: Vec<f64> = each().map(|(at, (x, y))| radial(at, [*x, *y])).collect();
    let along = |sign: f64| -> Vec<f64> {
        let of_way = each().filter(|(at, _)| at.direction * sign > 0.0);
        of_way.map(|(at, (x, y))| y * libm::cos(at.angle) - x * libm::sin(at.angle)).collect()
    };
    let deviation = |values: &[f64]| numerics::mean_and_deviation(values).1;
    let tangential = numerics::max_abs(
        [1.0, -1.0].map(|sign| deviation(&along(sign))).into_iter().filter(|v| v.is_finite()),
    );
    tangential < MIN_TANGENTIAL * deviation(&radial_um)
}
