//! Checks of the compensation settings of an axis, and their conversion to what a tick computes with.

use super::axis::{AxisCompensation, SlowTerm};
use super::backlash::Backlash;
use super::cycles::Cycles;
use super::drift::Drift;
use super::force::Force;
use super::geometry::{Squareness, Straightness};
use super::pitch::Pitch;
use super::reversal::Reversal;
use super::settings::{CompensationSettings, Points};
use super::slew::Slew;
use super::table::{Table, ValueRange};
use super::talk::Talk;
use crate::config::check::{gain, positive, ranged};
use crate::config::{ConfigError, Rates};
use crate::scalar::Scalar;
use crate::units::LENGTH_M;

/// Bounds of the corrections in SI, and the rates of their ticks.
struct Limits {
    bound_m: f64,
    bound_n: f64,
    /// Of the position loop, Hz.
    rate_hz: f64,
    /// Of the velocity loop, Hz.
    tick_hz: f64,
}

impl Limits {
    fn new<S: Scalar>(settings: &CompensationSettings, rates: Rates) -> Result<Self, ConfigError> {
        let bound_m = positive("position_bound_m", settings.position_bound_m)?;
        let bound_n = positive("force_bound_n", settings.force_bound_n)?;
        Ok(Self {
            bound_m: ranged("position_bound_m", bound_m, 0.0, 0.01)?,
            bound_n: ranged("force_bound_n", bound_n, 0.0, S::SIGNAL_LIMIT)?,
            rate_hz: rates.position_loop_hz(),
            tick_hz: rates.velocity_loop_hz,
        })
    }

    fn position<S: Scalar>(&self, m_per_s: f64, per_s: f64) -> Result<Slew<S>, ConfigError> {
        let name = "position_rate_m_per_s";
        let per_tick = Slew::per_tick(name, positive(name, m_per_s)?, per_s * LENGTH_M)?;
        Ok(Slew { bound: S::signal(self.bound_m / LENGTH_M), per_tick })
    }

    fn force<S: Scalar>(&self, n_per_s: f64) -> Result<Slew<S>, ConfigError> {
        let name = "force_rate_n_per_s";
        let per_tick = Slew::per_tick(name, positive(name, n_per_s)?, self.tick_hz)?;
        Ok(Slew { bound: S::signal(self.bound_n), per_tick })
    }
}

/// Another axis of a machine with `axes` axes.
fn source(name: &'static str, axis: u8, axes: usize) -> Result<u8, ConfigError> {
    if usize::from(axis) < axes {
        Ok(axis)
    } else {
        Err(ConfigError::OutOfRange { name, min: 0.0, max: axes as f64 - 1.0 })
    }
}

impl<S: Scalar> AxisCompensation<S> {
    /// Checks and converts the settings of an axis of a machine with `axes` axes.
    ///
    /// # Errors
    /// [`ConfigError`] for the first setting that is not finite, exceeds its bound or the range of the number format `S`, or
    /// requires another one.
    pub fn new(settings: &CompensationSettings, rates: Rates, axes: usize) -> Result<Self, ConfigError> {
        let limits = Limits::new::<S>(settings, rates)?;
        let &Limits { bound_m, bound_n, rate_hz, tick_hz } = &limits;
        let (lengths, forces) =
            (ValueRange { unit: LENGTH_M, bound: bound_m }, ValueRange { unit: 1.0, bound: bound_n });
        let model = settings.force.as_ref();
        let table =
            |name, points: Option<&Points>| points.map(|points| Table::new(name, points, forces)).transpose();
        let mut converted = Self {
            pitch: settings.pitch.as_ref().map(|pitch| Pitch::new(pitch, bound_m)).transpose()?,
            backlash: settings.backlash_width_m.map(|width| Backlash::new(width, bound_m)).transpose()?,
            screw: Cycles::new("screw", &settings.screw, lengths)?,
            dividing: Cycles::new("dividing", &settings.dividing, lengths)?,
            reversal: settings.reversal.as_ref().map(|r| Reversal::new(r, rate_hz, bound_n)).transpose()?,
            intalk: settings.intalk.as_ref().map(|talk| Talk::new("intalk", talk, rate_hz)).transpose()?,
            crosstalk: match &settings.crosstalk {
                Some((axis, talk)) => {
                    Some((source("crosstalk", *axis, axes)?, Talk::new("crosstalk", talk, rate_hz)?))
                }
                None => None,
            },
            squareness: match settings.squareness {
                Some((axis, k)) => Some((source("squareness", axis, axes)?, Squareness::new(k)?)),
                None => None,
            },
            straightness: match &settings.straightness {
                Some((axis, shape)) => {
                    Some((source("straightness", *axis, axes)?, Straightness::new(shape, bound_m)?))
                }
                None => None,
            },
            ripple: Cycles::new("ripple", &settings.ripple, forces)?,
            model: model.map(|model| Force::new(model, [rate_hz, tick_hz], bound_n)).transpose()?,
            load: table("load", model.and_then(|model| model.load.as_ref()))?,
            friction_map: table("friction_map", model.and_then(|model| model.friction.map.as_ref()))?,
            stretch: match (settings.stretch_m_per_n, model) {
                (Some(_), None) => {
                    return Err(ConfigError::Requires { name: "stretch_m_per_n", other: "force" });
                }
                (Some(m_per_n), Some(_)) => Some(gain::<S>("stretch_m_per_n", m_per_n, 1.0 / LENGTH_M)?),
                (None, _) => None,
            },
            drift: settings.drift.as_ref().map(|drift| Drift::new(drift, tick_hz, bound_m)).transpose()?,
            slow: heapless::Vec::new(),
            command: limits.position(settings.position_rate_m_per_s, rate_hz)?,
            reading: limits.position(settings.position_rate_m_per_s, tick_hz)?,
            force: limits.force(settings.force_rate_n_per_s)?,
        };
        converted.list_slow_terms();
        Ok(converted)
    }

    fn list_slow_terms(&mut self) {
        let warms_up = self.model.as_ref().is_some_and(Force::warms_up);
        let present = [
            (SlowTerm::Pitch, self.pitch.is_some()),
            (SlowTerm::Straightness, self.straightness.is_some()),
            (SlowTerm::Intalk, self.intalk.is_some()),
            (SlowTerm::Crosstalk, self.crosstalk.is_some()),
            (SlowTerm::Drift, self.drift.is_some()),
            (SlowTerm::Load, self.load.is_some()),
            (SlowTerm::AdditionalFriction, self.friction_map.is_some() || warms_up),
        ];
        // The capacity is the number of terms.
        self.slow = present.into_iter().filter(|(_, is)| *is).map(|(term, _)| term).collect();
    }
}
