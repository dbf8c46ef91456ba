//! Radius and following lag.
//!
//! An axis that follows as a first-order system with the gain K is late by T = 1/K, and its amplitude on a circle at the angular speed ω is
//! 1/√(1 + (ω·T)²), about 1 − (ω·T)²/2: the radius shrinks by R·(ω·T)²/2. The delay T is measured where command and position are; the
//! shrinkage then follows for a first-order lag. Feed-forward shortens the delay more than it reduces the shrinkage: with the share k of
//! it, T = (1 − k)/K, and the shrinkage is (1 + k)/(1 − k) times as large as this. At several speeds the shrinkage itself is measured, as
//! it grows with the square of the speed. In a radius at one speed, both are one quantity.

use super::builder::{self, Builder, Estimate};
use super::part::{Name, Part};
use super::term::Term;

/// The other part is negligible below this fraction of a part.
const NEGLIGIBLE: f64 = 0.05;

/// Largest ratio of the shrinkage by lag to that of a first-order lag of the same delay: a feed-forward of 90 %.
const MAX_RATIO: f64 = 19.0;

/// Radius and following lag, as far as they are there.
pub(crate) fn radius_and_lag(builder: &Builder<'_>) -> Vec<Part> {
    let Some(radius) = builder.coefficient(Term::Radius) else { return Vec::new() };
    if let Some(lag) = builder.coefficient(Term::SpeedRadius) {
        let parts = [part(builder, Name::FollowingLag, lag), radius_part(builder, radius)];
        return parts.into_iter().flatten().collect();
    }
    let Some(shrinkage) = first_order(builder) else {
        let mut parts: Vec<Part> = radius_part(builder, radius).into_iter().collect();
        // Measured and found to be none, the lag is no rival.
        if delay_s(builder).is_none() {
            for part in &mut parts {
                part.rivals = vec![Name::FollowingLag.word()];
            }
        }
        return parts;
    };
    let rest =
        Estimate { value: radius.value - shrinkage.value, error: libm::hypot(radius.error, shrinkage.error) };
    let mut parts = Vec::new();
    if let Some(mut lag) = part(builder, Name::FollowingLag, shrinkage) {
        lag.details.extend(delay_s(builder).map(|delay| delay.times(1e3).detail("delay_ms")));
        if rest.value.abs() > NEGLIGIBLE * shrinkage.value.abs() {
            lag.rivals = vec![Name::Radius.word()];
        }
        parts.push(lag);
    }
    if let Some(mut radius) = radius_part(builder, rest) {
        if MAX_RATIO * shrinkage.value.abs() > NEGLIGIBLE * rest.value.abs() {
            radius.rivals = vec![Name::FollowingLag.word()];
        }
        parts.push(radius);
    }
    parts
}

fn part(builder: &Builder<'_>, name: Name, um: Estimate) -> Option<Part> {
    if !um.is_found() {
        return None;
    }
    let mut part = builder::part(name, builder.both_axes(), vec![(Term::Radius, um.value)], um);
    part.details.push(um.detail("signed_um"));
    Some(part)
}

/// The radius, if the nominal one is known.
fn radius_part(builder: &Builder<'_>, um: Estimate) -> Option<Part> {
    builder.measured.has_nominal_radius.then(|| part(builder, Name::Radius, um)).flatten()
}

/// Delay of both axes, s, if it is measured.
fn delay_s(builder: &Builder<'_>) -> Option<Estimate> {
    let per_um = (1e3 * builder.samples.speed_mm_s?).recip();
    let remaining = builder.coefficient(Term::Lag)?.times(per_um);
    Some(Estimate { value: builder.measured.delay_s? + remaining.value, ..remaining })
}

/// The change of the radius by a first-order lag of the measured delay, µm, negative; `None` if no delay is measured.
fn first_order(builder: &Builder<'_>) -> Option<Estimate> {
    let delay = delay_s(builder).filter(|delay| delay.is_found() && delay.value > 0.0)?;
    let per_s = builder.samples.speed_mm_s? / builder.samples.radius_mm;
    let radius_um = 1e3 * builder.samples.radius_mm;
    let angle = per_s * delay.value;
    let value = radius_um * ((1.0 + angle * angle).sqrt().recip() - 1.0);
    Some(Estimate { value, error: radius_um * angle * per_s * delay.error })
}
