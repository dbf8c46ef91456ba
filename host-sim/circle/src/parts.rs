//! From coefficients to parts.

use super::builder::{self, Builder, Estimate};
use super::lag;
use super::measured::Measured;
use super::part::{Detail, Frame, Name, Part, degrees};
use super::rivals;
use super::samples::Samples;
use super::selection::Fitted;
use super::spike_profile;
use super::stick_slip;
use super::term::{Shape, Term};

/// Smallest part that is reported, relative to the largest. Below, the small angles and the sampling of the equations count.
const MIN_FRACTION: f64 = 1e-3;

/// All parts that the samples show, largest first.
#[must_use]
pub fn parts(measured: &Measured, samples: &Samples, fitted: &Fitted) -> Vec<Part> {
    let builder = Builder { measured, samples, fitted, frame: frame(samples) };
    let mut parts: Vec<Part> = Vec::new();
    parts.extend(centre(&builder));
    parts.extend(lag::radius_and_lag(&builder));
    let both = builder.both_axes();
    for (name, term) in [
        (Name::Squareness, Term::Square),
        (Name::ScaleMismatch, Term::Scale),
        (Name::ServoMismatch, Term::Servo),
    ] {
        parts.extend(single(&builder, name, &both, term));
    }
    for (index, axis) in measured.axes.iter().enumerate() {
        parts.extend(single(&builder, Name::Backlash, axis, Term::Backlash(index)));
        parts.extend(single(&builder, Name::LateralPlay, axis, Term::Play(index)));
    }
    parts.extend((0..fitted.model.groups.len()).filter_map(|group| added(&builder, group)));
    parts.extend(stick_slip::parts(&builder));
    rivals::without_remains(&mut parts);
    let greatest = numerics::max_abs(parts.iter().map(|part| part.um));
    parts.retain(|part| part.um >= MIN_FRACTION * greatest);
    parts.sort_by(|a, b| b.um.total_cmp(&a.um));
    rivals::assign(&mut parts, samples, fitted);
    parts
}

/// Radius, speed and directions of samples.
#[must_use]
pub fn frame(samples: &Samples) -> Frame {
    let has = |sign: f64| samples.instants.iter().any(|at| at.direction * sign > 0.0);
    Frame { radius_mm: samples.radius_mm, speed_mm_s: samples.speed_mm_s, directions: [has(1.0), has(-1.0)] }
}

/// A part of one coefficient, if it is clear of zero.
fn single(builder: &Builder<'_>, name: Name, axis: &str, term: Term) -> Option<Part> {
    let coefficient = builder.coefficient(term).filter(|coefficient| coefficient.is_found())?;
    let range = coefficient.times(builder.frame.range_um(&[(term, 1.0)]));
    let mut part = builder::part(name, axis.to_owned(), vec![(term, coefficient.value)], range);
    part.details.push(coefficient.detail("signed_um"));
    Some(part)
}

/// Shift of the centre: both coordinates together.
fn centre(builder: &Builder<'_>) -> Option<Part> {
    let terms = [0, 1].map(Term::Centre);
    let [x, y] = terms.map(|term| builder.coefficient(term));
    let (x, y) = (x?, y?);
    let [i, j] = terms.map(|term| builder.fitted.index(term));
    let value = libm::hypot(x.value, y.value);
    let weights = [(i?, x.value / value.max(1e-12)), (j?, y.value / value.max(1e-12))];
    let shift = Estimate { value, error: builder.fitted.covariance.variance(&weights).sqrt() };
    if !x.is_found() && !y.is_found() {
        return None;
    }
    let terms = vec![(terms[0], x.value), (terms[1], y.value)];
    let mut part = builder::part(Name::Centre, builder.both_axes(), terms, shift.times(2.0));
    part.details = vec![x.detail("first_um"), y.detail("second_um")];
    Some(part)
}

/// A spike, wave or vibration.
fn added(builder: &Builder<'_>, group: usize) -> Option<Part> {
    let Fitted { model, fit, .. } = builder.fitted;
    let range = &model.groups[group];
    let (value, error) = builder.fitted.amplitude(range);
    let amplitude = Estimate { value, error };
    if !amplitude.is_found() {
        return None;
    }
    let terms: Vec<(Term, f64)> = range.clone().map(|i| (model.terms[i], fit.coefficients[i])).collect();
    let um = amplitude.times(builder.frame.range_um(&terms) / amplitude.value);
    let value = model.parameter(group);
    let parameter = Estimate { value, error: builder.fitted.parameter_error(group) * value };
    let first = terms[0];
    let (name, axis) = match first.0 {
        Term::Spike(axis, ..) => (Name::ReversalSpike, axis),
        Term::Wave(axis, ..) => (Name::Cyclic, axis),
        Term::Vibration(axis, ..) => (Name::Vibration, axis),
        _ => return None,
    };
    let mut part = builder::part(name, builder.measured.axes[axis].clone(), terms, um);
    match first.0 {
        Term::Spike(_, shape, _) => describe_spike(builder, &mut part, shape, parameter),
        Term::Wave(..) => part.details.push(parameter.detail("pitch_mm")),
        _ => part.details.push(parameter.detail("frequency_hz")),
    }
    Some(part)
}

/// Height, width in degrees and, at a known speed, in milliseconds.
fn describe_spike(builder: &Builder<'_>, part: &mut Part, shape: Shape, width: Estimate) {
    part.shape = Some(shape.word());
    part.details.push(Detail { key: "signed_um", value: part.terms[0].1, ci95: None });
    part.details.push(width.times(degrees(1.0)).detail("width_deg"));
    if let Some(speed_mm_s) = builder.samples.speed_mm_s {
        part.details.push(width.times(1e3 * builder.samples.radius_mm / speed_mm_s).detail("width_ms"));
    }
    spike_profile::correct(builder, part);
}
