//! Gain and phase margin of an open loop L with negative feedback.
//!
//! Where L is real and negative, a gain changed by the factor 1/|L| moves a pole of the closed loop onto the unit circle. The
//! gain margin is the factor nearest to 1, upwards or downwards, in dB. Where |L| = 1, the phase margin is the angle from L to
//! −1; the smallest counts. Both exist only for a stable closed loop.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::sampled::Sampled;

/// Points of the grid of frequencies per decade.
const PER_DECADE: f64 = 60.0;

/// Lowest angle ω·T of the grid.
const LOWEST_ANGLE: f64 = 1e-6;

/// A pole within this distance of 1 is the position of a velocity loop, which has no feedback.
const FREE_POSITION: f64 = 1e-7;

/// A margin and the frequency at which it is found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct At {
    /// Gain margin, dB, or phase margin, degrees.
    pub value: f64,
    /// Frequency, Hz.
    pub hz: f64,
}

/// The margins of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Whether the closed loop is stable.
    pub is_stable: bool,
    /// Gain margin, dB; `None`: no gain makes the loop unstable, or it is unstable.
    pub gain_db: Option<At>,
    /// Phase margin, degrees; `None`: the gain of the open loop is nowhere 1, or the loop is unstable.
    pub phase_deg: Option<At>,
}

impl Margins {
    /// Margins of an open loop with the tick `tick_s`. `is_velocity`: the position is not fed back, and may move freely.
    #[must_use]
    pub fn of(open: &Sampled, tick_s: f64, is_velocity: bool) -> Self {
        if !is_stable(&open.closed_loop_poles(), is_velocity) {
            return Self { is_stable: false, gain_db: None, phase_deg: None };
        }
        let hz = |angle: f64| angle / (TAU * tick_s);
        let angles = grid(&open.poles());
        let responses: Vec<(f64, Complex<f64>)> =
            angles.into_iter().filter_map(|angle| Some((angle, open.response(angle)?))).collect();
        let (mut gain_db, mut phase_deg): (Option<At>, Option<At>) = (None, None);
        let smaller = |least: &mut Option<At>, at: At| {
            if least.is_none_or(|least| at.value < least.value) {
                *least = Some(at);
            }
        };
        for pair in responses.windows(2) {
            let ends = [pair[0], pair[1]];
            if let Some((angle, response)) = crossing(open, ends, |response| response.im)
                && response.re < 0.0
                && response.im.abs() < 1e-3 * response.re.abs()
            {
                smaller(
                    &mut gain_db,
                    At { value: (20.0 * libm::log10(response.norm())).abs(), hz: hz(angle) },
                );
            }
            if let Some((angle, response)) = crossing(open, ends, |response| libm::log(response.norm())) {
                smaller(&mut phase_deg, At { value: (-response).arg().abs().to_degrees(), hz: hz(angle) });
            }
        }
        // At half the sample rate every response is real.
        if let Some(&(angle, response)) = responses.last().filter(|(_, response)| response.re < 0.0) {
            smaller(&mut gain_db, At { value: (20.0 * libm::log10(response.norm())).abs(), hz: hz(angle) });
        }
        Self { is_stable: true, gain_db, phase_deg }
    }

    /// Whether both margins are at least these, dB and degrees.
    #[must_use]
    pub fn are_at_least(&self, gain_db: f64, phase_deg: f64) -> bool {
        let reaches = |margin: Option<At>, least: f64| margin.is_none_or(|at| at.value >= least);
        self.is_stable && reaches(self.gain_db, gain_db) && reaches(self.phase_deg, phase_deg)
    }
}

/// Whether all poles are inside the unit circle, apart from a free position.
fn is_stable(poles: &[Complex<f64>], is_velocity: bool) -> bool {
    let mut outside = poles.iter().filter(|pole| pole.norm() >= 1.0 - 1e-12);
    let mut free = poles.iter().filter(|pole| (*pole - 1.0).norm() < FREE_POSITION);
    if is_velocity && free.next().is_some() {
        return free.next().is_none() && outside.all(|pole| (pole - 1.0).norm() < FREE_POSITION);
    }
    outside.next().is_none()
}

/// Angles from [`LOWEST_ANGLE`] to π, more closely about the poles of the open loop.
fn grid(poles: &[Complex<f64>]) -> Vec<f64> {
    /// Distances from a resonance, in widths.
    const WIDTHS: [f64; 8] = [0.1, 0.3, 0.6, 1.0, 1.5, 2.5, 5.0, 10.0];
    let step = libm::pow(10f64, 1.0 / PER_DECADE);
    let mut angles: Vec<f64> = std::iter::successors(Some(LOWEST_ANGLE), |angle| Some(angle * step))
        .take_while(|angle| *angle < PI)
        .collect();
    for pole in poles.iter().filter(|pole| pole.im > 0.0) {
        let (angle, width) = (pole.arg(), (1.0 - pole.norm()).abs().max(1e-6));
        angles.push(angle);
        angles.extend(WIDTHS.iter().flat_map(|widths| [angle - widths * width, angle + widths * width]));
    }
    angles.retain(|angle| (LOWEST_ANGLE..PI).contains(angle));
    angles.push(PI);
    angles.sort_by(f64::total_cmp);
    angles
}

/// The angle between two points of the grid at which a function of the response is zero, and the response there.
fn crossing(
    open: &Sampled,
    [low, high]: [(f64, Complex<f64>); 2],
    function: impl Fn(Complex<f64>) -> f64,
) -> Option<(f64, Complex<f64>)> {
    const HALVINGS: usize = 40;
    let sign = function(low.1) > 0.0;
    if sign == (function(high.1) > 0.0) {
        return None;
    }
    let (mut low, mut high) = (low, high);
    for _ in 0..HALVINGS {
        let angle = 0.5 * (low.0 + high.0);
        let Some(response) = open.response(angle) else { break };
        if (function(response) > 0.0) == sign { low = (angle, response) } else { high = (angle, response) }
    }
    Some(high)
}
